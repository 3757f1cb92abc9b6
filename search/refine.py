"""Boundaries of a moment: the window whose start and end fit the query best, found by encoding around a first guess."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from search.dense import Encoder, Frames, Scored, Vectors, join, score_windows

#: Window lengths tried, in seconds, from a gesture to the longest motion the model takes in whole.
LENGTHS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0)

#: What doubling a window's length is worth in cosine: a window inside a long action scores like the whole of it.
LENGTH_PRIOR = 0.02


def length_bonus(seconds: NDArray[np.floating]) -> NDArray[np.float64]:
    """What is added to a window's similarity for its length."""
    return np.asarray(LENGTH_PRIOR * np.log2(np.maximum(seconds, 0.1)), np.float64)


def fitness(windows: Scored) -> NDArray[np.float64]:
    """How well windows answer (Q, N): their similarity, and a little for their length."""
    return np.asarray(windows.scores + length_bonus(windows.lengths), np.float64)


def around(frames: int, fps: float, start: int, end: int) -> dict[int, Frames]:
    """Windows near a first guess: lengths from half to twice its own, moved by up to half of it.

    Parameters
    ----------
    frames : int
        Feature frames of the take.
    fps : float
        Feature frames a second.
    start, end : int
        The guess, in feature frames.

    Returns
    -------
    dict
        Length -> starts (N,), both in feature frames.
    """
    length = end - start
    reach = max(length // 2, 1)
    sizes = {round(seconds * fps) for seconds in LENGTHS} | {length}
    fitting = sorted(size for size in sizes if length <= 2 * size and size <= min(2 * length, frames))
    first, last = max(start - reach, 0), min(end + reach, frames)
    found = {size: np.arange(first, last - size + 1, dtype=np.int64) for size in fitting}
    return {size: starts for size, starts in found.items() if len(starts)}


def refine(encoder: Encoder, features: Vectors, fps: float, queries: Vectors, start: int, end: int) -> Scored:
    """All windows near a first guess (feature frames), compared with queries (Q, D)."""
    candidates = around(len(features), fps, start, end)
    return join([score_windows(encoder, features, fps, at, size, queries) for size, at in candidates.items()])
