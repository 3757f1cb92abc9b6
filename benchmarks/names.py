"""What names, captions and tags do to a search by meaning: names are found by them, and sentences lose nothing.

    python -m benchmarks.names data/mocap captions.jsonl

The gallery is one file of each trial. Each is called by what CMU says of it, in a folder of its subject
("05/dance_expressive_arms_05_02"), and half of them have their first caption. Sentences are the other captions that
people wrote. Each line adds so much to the cosine of the clips that have all words of a sentence; 0 is what is used.
`others` counts only the text of clips that are not asked for: the worst that text can do.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from collections import defaultdict
from itertools import islice
from pathlib import Path

import numpy as np

from encoders.errors import MotionSeekError
from indexer.datasets.archive_tables import load_row, read_manifest
from indexer.ingest.arrays import NewClip
from search.library import Library
from search.query.question import Question
from search.ranking.clip_scores import best_clips, rank_clips
from search.ranking.text_matches import fused, text_matches

_WEIGHTS = (0.0, 0.01, 0.03, 0.1)
_USED = 0.0
#: Ranks that are looked at, and sentences of each split, at most.
_DEPTH, _MOST = 30, 200


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", type=Path)
    parser.add_argument("captions", type=Path)
    arguments = parser.parse_args()
    written = captions(arguments.captions)
    with tempfile.TemporaryDirectory() as scratch, Library.open(scratch, create=True) as library:
        clips = gallery(arguments.archive, written)
        ids = dict(zip(clips, library.add_many(clip for clip, _ in clips.values()), strict=True))
        splits = {ids[trial]: split for trial, (_, split) in clips.items()}
        asked = [(ids[trial], text) for trial in clips for text in written.get(trial, [])[1:]]
        for split in ("train", "val"):
            questions = [(clip_id, text) for clip_id, text in asked if splits[clip_id] == split]
            questions = questions[:: -(-len(questions) // _MOST)]
            print(f"{split}: {len(questions)} sentences among {len(ids)} clips; R@1, R@5, R@10, median rank")
            for weight in _WEIGHTS:
                own, others = ranks(library, questions, weight)
                print(f"  {weight:.2f}{' *' if weight == _USED else '  '} {shown(own)};  others {shown(others)}")
        print("by name: first", share(library, {clip.path: clip.id for clip in library.clips()}))
        print("by the number at a name's end: first", share(library, ids))


def captions(path: Path) -> dict[str, list[str]]:
    """The captions of each whole trial that may be used."""
    found: dict[str, list[str]] = defaultdict(list)
    for line in path.read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        if row["split"] in ("train", "val"):
            found[row["trial"]] += [text for text in row["captions"] if text not in found[row["trial"]]]
    return found


def gallery(archive: Path, written: dict[str, list[str]]) -> dict[str, tuple[NewClip, str]]:
    """One clip of each trial, by trial, with its split."""
    found: dict[str, tuple[NewClip, str]] = {}
    for row in read_manifest(archive, ("use", "split", "description")):
        if row["kind"] != "take" or row["use"] == "evaluation only" or row["trial"] in found:
            continue
        try:
            motion = load_row(archive, row)
        except MotionSeekError as error:
            print(error, file=sys.stderr)
            continue
        said = re.sub(r"\W+", "_", row["description"].lower()).strip("_")[:80]
        name = f"{row['trial'][:2]}/{said}_{row['trial']}".replace("/_", "/")
        has_caption = len(found) % 2 == 0
        clip = NewClip(name, motion, written.get(row["trial"], [])[:1] if has_caption else ())
        found[row["trial"]] = clip, row["split"]
    return found


def ranks(library: Library, questions: list[tuple[int, str]], weight: float) -> tuple[np.ndarray, np.ndarray]:
    """The rank of the clip that each question asks for; with all text, and with that of other clips alone."""
    own, others = [], []
    for clip_id, text in questions:
        query = library.encode(Question.of(text, split_steps=False)).vectors[0]
        matches = text_matches(library, library.bundle, text, evidence=weight)
        for ranks_of, left_out in ((own, -1), (others, clip_id)):
            counted = {i: match for i, match in matches.items() if i != left_out}
            by_text = best_clips(library, query, len(counted), allowed=np.array(sorted(counted), np.int64))
            order = [s.clip_id for s in islice(fused(rank_clips(library, query), by_text, counted), _DEPTH)]
            ranks_of.append(order.index(clip_id) + 1 if clip_id in order else _DEPTH + 1)
    return np.array(own), np.array(others)


def shown(ranks: np.ndarray) -> str:
    """Recalls in percent, and the median rank."""
    recalls = " ".join(f"{100 * np.mean(ranks <= k):5.1f}" for k in (1, 5, 10))
    return f"{recalls} {np.median(ranks):3.0f}"


def share(library: Library, names: dict[str, int]) -> str:
    """The share of names whose clip is the first hit."""
    first = [library.search(name, 1)[0].clip_id == clip_id for name, clip_id in names.items()]
    return f"{100 * np.mean(first):.1f} % of {len(first)}"


if __name__ == "__main__":
    main()
