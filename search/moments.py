"""Where in a take it happens: coarse windows propose, dense ones decide."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from indexer import windows
from search.dense import Encoder, Scored, Vectors, join, score_windows
from search.refine import fitness, refine
from search.spans import suppress

#: Answers overlap by at most this intersection over union.
OVERLAP = 0.3

#: Regions looked at closely for each answer asked for.
PROPOSALS = 3

#: (start, end) in seconds -> features of a part of the take with room around that span, and the second it begins at.
Region = Callable[[float, float], tuple[Vectors, float]]


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


def propose(windows: Scored, count: int) -> list[Moment]:
    """The best windows that overlap no better one, best first; scores are those of the worst query."""
    kept = suppress(windows.starts, windows.ends, fitness(windows).min(axis=0), count, overlap=OVERLAP)
    scores = windows.scores.min(axis=0)
    return [Moment(float(windows.starts[i]), float(windows.ends[i]), float(scores[i])) for i in kept]


def sharpen(
    encoder: Encoder, region: Region, fps: float, queries: Vectors, guesses: Sequence[Moment], k: int
) -> list[Moment]:
    """The best moments near first guesses, by encoding densely around them.

    Parameters
    ----------
    region : callable
        See `Region`.
    fps : float
        Feature frames a second.
    queries : float32 array (Q, D)
        Unit vectors.
    """
    if not guesses:
        return []
    found = []
    for guess in guesses:
        features, offset = region(guess.start, guess.end)
        first = min(max(round((guess.start - offset) * fps), 0), len(features) - 1)
        last = max(min(round((guess.end - offset) * fps), len(features)), first + 1)
        near = refine(encoder, features, fps, queries, first, last)
        found.append(Scored(near.starts + offset, near.ends + offset, near.scores))
    return propose(join(found), k)


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
    guesses = propose(join(list(coarse) or score_take(encoder, features, fps, queries)), PROPOSALS * k)
    return sharpen(encoder, lambda start, end: (features, 0.0), fps, queries, guesses, k)
