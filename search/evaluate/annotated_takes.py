"""Takes with annotated events: synthetic takes, takes joined from real clips, and takes that people annotated."""

from __future__ import annotations

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
from indexer.datasets.archive_tables import load_row, read_manifest
from indexer.datasets.captioned_dataset import CaptionedDataset
from indexer.datasets.labelled_clips import LabelledClips

#: Seconds of a synthetic or joined take.
_SHORTEST, _LONGEST = 30.0, 120.0
#: An annotated span is a moment if it covers less than this share of its take.
_MOMENT_SHARE = 0.8
#: Labels of BABEL that say nothing of what is done.
_NO_ACTIONS = frozenset({"transition", "unknown"})
_CAMEL_CASE = re.compile(r"(?<=[a-z])(?=[A-Z])")


def synthetic_takes(count: int, seed: int = TEST) -> Iterator[AnnotatedTake]:
    """Synthetic takes of 30 to 120 s with exact boundaries; actions, styles, joins and seeds are held out."""
    rng = np.random.default_rng(seed)
    return (heldout_take(rng, least=_SHORTEST, most=_LONGEST) for _ in range(count))


def labelled_motions(archive: LabelledClips) -> list[tuple[Motion, str]]:
    """The clips of a labelled archive, each with the first query of its label."""
    labelled = zip(archive.motions, archive.labels, strict=True)
    return [(motion, archive.queries[label][0]) for motion, label in labelled if label in archive.queries]


def described_motions(takes: Sequence[CaptionedTake], longest: float = 15.0) -> list[tuple[Motion, str]]:
    """Takes of up to `longest` seconds, each with its description."""
    return [
        (t.motion, t.description) for t in takes if t.motion.duration <= longest and t.description.lower() != "unknown"
    ]


def joined_takes(clips: Sequence[tuple[Motion, str]], count: int, seed: int = 0) -> Iterator[AnnotatedTake]:
    """Takes of 30 to 120 s joined from clips drawn at random; a repeated sentence is right at any of its places."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        wanted, chosen, seconds = rng.uniform(_SHORTEST, _LONGEST), [], 0.0
        while seconds < wanted:
            chosen.append(clips[int(rng.integers(len(clips)))])
            seconds += chosen[-1][0].duration
        yield joined_take(chosen)


def captioned_moments(takes: Sequence[CaptionedTake]) -> Iterator[AnnotatedTake]:
    """Takes with the captions of parts of them; of a trial in several rigs, the first take."""
    for take in {take.trial: take for take in reversed(takes)}.values():
        events = [
            Event(caption, (span.start, min(span.end, take.motion.duration)), frozenset({caption}))
            for span in take.spans
            for caption in span.captions
            if min(span.end, take.motion.duration) - span.start < _MOMENT_SHARE * take.motion.duration
        ]
        if events:
            yield annotated_take(take.motion, events)


def dataset_moments(dataset: CaptionedDataset, split: str) -> Iterator[AnnotatedTake]:
    """Motions of a split of a captioned data set, such as BABEL, with the captions of parts of them.

    Captions of all durations count; those that name no action ("transition") do not.

    Raises
    ------
    DatasetError
        If the split or a motion of it cannot be used; the subclasses name the cause.
    """
    entries = dataset.split(split, all_durations=True)
    dataset.motions.check_rate(entries)
    for entry in entries:
        motion = dataset.motions.motion(entry)
        spans = [(c.text, (c.start, min(c.end, motion.duration))) for c in entry.captions if c.text not in _NO_ACTIONS]
        moments = [(text, span) for text, span in spans if 0 < span[1] - span[0] < _MOMENT_SHARE * motion.duration]
        if moments:
            yield annotated_take(motion, [Event(text, span, frozenset({text})) for text, span in moments])


def timed_segments(folder: Path, segments: Path) -> Iterator[AnnotatedTake]:
    """Takes of a folder with a manifest, of any split, with the segments that people labelled in them.

    `segments` is JSON, {trial: [{"start", "end", "label"}]}, in seconds. A label in camel case ("KneeRaise") becomes
    a sentence of separate words. Each trial is read in the first rig that can be read.

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
        events = [(_CAMEL_CASE.sub(" ", row["label"]).lower(), (row["start"], row["end"])) for row in rows]
        if events:
            yield annotated_take(motion, [Event(text, span, frozenset({text})) for text, span in events])


def _trials(folder: Path, names: set[str]) -> Iterator[tuple[str, Motion]]:
    """The named trials of a folder with a manifest, each in the first rig that can be read."""
    for row in read_manifest(folder):
        if row["trial"] in names and row["kind"] == "take":
            try:
                motion = load_row(folder, row)
            except MotionSeekError:
                continue
            names.remove(row["trial"])
            yield row["trial"], motion
