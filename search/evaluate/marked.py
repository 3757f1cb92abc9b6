"""Takes whose moments are known: made, joined from real clips, or marked by people."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from encoders.corpus.real import CaptionedTake
from encoders.corpus.seeds import TEST
from encoders.corpus.takes import Marked, MarkedTake, joined_take, made_take
from encoders.errors import MotionSeekError, QueryError
from encoders.motion import Motion
from indexer import load_motion
from search.evaluate.labels import read_table

#: A marked part of a take shorter than this share of it lies inside a longer take.
_INSIDE = 0.8
_LEAST, _MOST = 30.0, 120.0


def composed(count: int, seed: int = TEST) -> Iterator[MarkedTake]:
    """Made takes of 30 to 120 s with exact boundaries, from seeds no training used."""
    rng = np.random.default_rng(seed)
    return (made_take(rng, least=_LEAST, most=_MOST) for _ in range(count))


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


def joined(clips: Sequence[tuple[Motion, str]], count: int, seed: int = 0) -> Iterator[MarkedTake]:
    """Takes of 30 to 120 s joined from clips drawn at random; a repeated sentence is right at any of its places."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        wanted, chosen, seconds = rng.uniform(_LEAST, _MOST), [], 0.0
        while seconds < wanted:
            chosen.append(clips[int(rng.integers(len(clips)))])
            seconds += chosen[-1][0].duration
        yield joined_take(chosen)


def marked_by_people(takes: Sequence[CaptionedTake], segments: Path | None = None) -> Iterator[MarkedTake]:
    """Takes with sentences whose spans lie inside them, and with the labels of `segments`.

    `segments` is JSON, {trial: [{"start", "end", "label"}]}, in seconds.

    Of a trial that lies there in several rigs, the first is asked.

    Raises
    ------
    QueryError
        If `segments` cannot be read.
    """
    try:
        labels = json.loads(segments.read_text(encoding="utf-8")) if segments else {}
    except (OSError, ValueError) as error:
        raise QueryError(f"{segments}: no segments that can be read ({error})") from error
    seen: set[str] = set()
    for take in takes:
        if take.trial in seen:
            continue
        seen.add(take.trial)
        spans: dict[str, list[tuple[float, float]]] = {}
        for span in take.spans:
            end = min(span.end, take.motion.duration)
            if end - span.start < _INSIDE * take.motion.duration:
                for caption in span.captions:
                    spans.setdefault(caption, []).append((span.start, end))
        for row in labels.get(take.trial, ()):
            if row["end"] <= take.motion.duration + 0.5:
                spans.setdefault(row["label"], []).append((row["start"], row["end"]))
        if spans:
            yield MarkedTake(take.motion, tuple(Marked(text, tuple(where)) for text, where in spans.items()))
