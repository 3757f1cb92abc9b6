"""Takes whose moments are known: made, joined from real clips, or marked by people."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from encoders.corpus.composition.captioned_motion import CaptionedTake
from encoders.corpus.composition.long_takes import AnnotatedTake, Event, annotated_take, heldout_take, joined_take
from encoders.corpus.composition.seeds import TEST
from encoders.errors import MotionSeekError, QueryError
from encoders.motion import Motion
from indexer.ingest.load import load_motion
from search.evaluate.labelled_archive import read_table

#: A marked part of a take shorter than this share of it lies inside a longer take.
_INSIDE = 0.8
_LEAST, _MOST = 30.0, 120.0
_JOINED = re.compile(r"(?<=[a-z])(?=[A-Z])")


def composed(count: int, seed: int = TEST) -> Iterator[AnnotatedTake]:
    """Made takes of 30 to 120 s with exact boundaries; actions, manners, joins and seeds are held out of training."""
    rng = np.random.default_rng(seed)
    return (heldout_take(rng, least=_LEAST, most=_MOST) for _ in range(count))


def labelled_clips(folder: Path) -> list[tuple[Motion, str]]:
    """The clips of a folder with labels.tsv and queries.tsv, each under the first query of its label."""
    queries: dict[str, str] = {}
    for row in read_table(folder / "queries.tsv", ("label", "query")):
        queries.setdefault(row["label"], row["query"])
    clips = []
    for row in read_table(folder / "labels.tsv", ("path", "label")):
        if row["label"] in queries:
            try:
                clips.append((load_motion(folder / row["path"]), queries[row["label"]]))
            except MotionSeekError:
                continue
    return clips


def described_clips(takes: Sequence[CaptionedTake], longest: float = 15.0) -> list[tuple[Motion, str]]:
    """Short takes under their descriptions."""
    return [
        (t.motion, t.description) for t in takes if t.motion.duration <= longest and t.description.lower() != "unknown"
    ]


def joined(clips: Sequence[tuple[Motion, str]], count: int, seed: int = 0) -> Iterator[AnnotatedTake]:
    """Takes of 30 to 120 s joined from clips drawn at random; a repeated sentence is right at any of its places."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        wanted, chosen, seconds = rng.uniform(_LEAST, _MOST), [], 0.0
        while seconds < wanted:
            chosen.append(clips[int(rng.integers(len(clips)))])
            seconds += chosen[-1][0].duration
        yield joined_take(chosen)


def captioned_moments(takes: Sequence[CaptionedTake]) -> Iterator[AnnotatedTake]:
    """Takes with sentences whose spans lie inside them; of a trial that lies there in several rigs, the first."""
    for take in {take.trial: take for take in reversed(takes)}.values():
        said = [
            Event(caption, (span.start, min(span.end, take.motion.duration)), frozenset({caption}))
            for span in take.spans
            for caption in span.captions
            if min(span.end, take.motion.duration) - span.start < _INSIDE * take.motion.duration
        ]
        if said:
            yield annotated_take(take.motion, said)


def timed_segments(folder: Path, segments: Path) -> Iterator[AnnotatedTake]:
    """Takes of a folder with a manifest, of any split, with the labels people timed in them.

    `segments` is JSON, {trial: [{"start", "end", "label"}]}, in seconds. Words written together ("KneeRaise") are
    asked as words.

    Raises
    ------
    QueryError
        If `segments` or the manifest cannot be read.
    """
    try:
        labels = json.loads(segments.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise QueryError(f"{segments}: no segments that can be read ({error})") from error
    for trial, motion in _trials(folder, set(labels)):
        rows = [row for row in labels[trial] if row["end"] <= motion.duration + 0.5]
        said = [(_JOINED.sub(" ", row["label"]).lower(), (row["start"], row["end"])) for row in rows]
        if said:
            yield annotated_take(motion, [Event(text, span, frozenset({text})) for text, span in said])


def _trials(folder: Path, names: set[str]) -> Iterator[tuple[str, Motion]]:
    """The named trials of a folder with a manifest, each in the first rig that can be read."""
    left = set(names)
    try:
        with (folder / "manifest.tsv").open(encoding="utf-8", newline="") as table:
            rows = list(csv.DictReader(table, delimiter="\t"))
    except (OSError, ValueError) as error:
        raise QueryError(f"{folder}: no manifest.tsv that can be read ({error})") from error
    for row in rows:
        if row["trial"] in left and row["kind"] == "take":
            rate = row["fps_true"] or row["fps_in_file"]
            try:
                motion = load_motion(folder / row["path"], fps=float(rate) if rate else None)
            except MotionSeekError:
                continue
            left.remove(row["trial"])
            yield row["trial"], motion
