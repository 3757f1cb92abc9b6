"""Where in a take it happens: coarse windows propose, dense ones decide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from indexer import windows
from search.dense import Encoder, Scored, Vectors, join, score_windows
from search.refine import fitness, refine
from search.spans import suppress

#: Answers overlap by at most this intersection over union.
OVERLAP = 0.3

#: Regions looked at closely for each answer asked for.
_PROPOSALS = 3


@dataclass(frozen=True)
class Moment:
    """A span of a take, in seconds, and its similarity to the query."""

    start: float
    end: float
    score: float


def score_take(encoder: Encoder, features: Vectors, fps: float, queries: Vectors) -> list[Scored]:
    """The coarse windows of a take that no library holds, compared with queries (Q, D)."""
    coarse = windows.grid(len(features), fps).values()
    return [score_windows(encoder, features, fps, starts, size, queries) for starts, size in coarse]


def score_stored(stored: Sequence[windows.Windows], queries: Vectors) -> list[Scored]:
    """The stored windows of a clip compared with queries (Q, D)."""
    return [
        Scored(w.starts.astype(np.float64), w.ends.astype(np.float64), queries @ w.vectors.astype(np.float32).T)
        for w in stored
    ]


def localise(
    encoder: Encoder,
    features: Vectors,
    fps: float,
    queries: Vectors,
    k: int,
    *,
    coarse: Sequence[Scored] = (),
) -> list[Moment]:
    """The best moments of a take, best first.

    Parameters
    ----------
    features : float32 array (T', F)
        Of the whole take.
    fps : float
        Feature frames a second.
    queries : float32 array (Q, D)
        Unit vectors; where there are several, a span must fit them all and counts as much as its worst.
    k : int
        At most so many.
    coarse : sequence of Scored
        The take's coarse windows compared with the queries, where a library has them.
    """
    guesses = join(list(coarse) or score_take(encoder, features, fps, queries))
    looked_at = [
        refine(encoder, features, fps, queries, *_frames(guesses, i, fps, len(features)))
        for i in _best(guesses, _PROPOSALS * k)
    ]
    found = join(looked_at)
    scores = found.scores.min(axis=0)
    return [Moment(float(found.starts[i]), float(found.ends[i]), float(scores[i])) for i in _best(found, k)]


def _best(windows: Scored, k: int) -> NDArray[np.int64]:
    return suppress(windows.starts, windows.ends, fitness(windows).min(axis=0), k, overlap=OVERLAP)


def _frames(guesses: Scored, i: int, fps: float, frames: int) -> tuple[int, int]:
    first = min(round(guesses.starts[i] * fps), frames - 1)
    return first, max(min(round(guesses.ends[i] * fps), frames), first + 1)
