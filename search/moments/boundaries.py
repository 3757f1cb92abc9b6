"""Boundaries of a moment: where similarity over time stands high, measured by short windows at every other frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.moments.window_scores import Vectors, curve, score_windows

#: Lengths in seconds of the windows whose similarities are averaged at each instant, and frames from one to the next.
CURVE_LENGTHS = (2.0, 2.8, 4.0)
STRIDE = 2

#: A moment goes on while similarity stays in the upper third between the motion's usual level and its peak, or
#: within so much of the peak.
_UPPER = 0.35
_LEAST_DROP = 0.16
#: How much higher than its peak what it goes on into may be: beyond, it is another moment.
_HIGHER = 0.05
#: How much below that a moment may dip and still be one, in seconds times cosine.
_DIP = 0.1


def frame_curve(encoder: Encoder, features: Vectors, fps: float, queries: Vectors) -> Vectors:
    """Similarity (Q, T') of a stretch of motion (T', F) to queries (Q, D), one value a feature frame."""
    frames = len(features)
    times = (np.arange(frames, dtype=np.float64) + 0.5) / fps
    curves = []
    for seconds in CURVE_LENGTHS:
        length = min(round(seconds * fps), frames)
        starts = np.arange(0, frames - length + 1, STRIDE)
        windows = score_windows(encoder, features, fps, starts, length, queries)
        curves.append(curve(windows, times))
    return np.asarray(np.mean(curves, axis=0), np.float32)


def gains(similarity: NDArray[np.floating], level: float, first: int, last: int) -> NDArray[np.float64]:
    """What each frame adds to a moment that peaks within the frames from `first` to `last`: positive where it goes on.

    Parameters
    ----------
    similarity : array (T',)
    level : float
        What motion that does not fit scores.
    """
    peak = float(similarity[first:last].max())
    threshold = peak - max(_UPPER * (peak - level), _LEAST_DROP)
    return np.asarray(similarity, np.float64) - threshold


def grow(similarity: NDArray[np.floating], level: float, fps: float, first: int, last: int) -> tuple[int, int]:
    """The moment around the peak within the frames from `first` to `last`, as a range of frames.

    From the peak it grows to either side to where its gains add up to most, stopping where they have fallen too far
    below that, as alignments are extended in sequence search (X-drop; Altschul et al. 1990), or where a higher moment
    begins.
    """
    peak = first + int(np.argmax(similarity[first:last]))
    gain = np.where(similarity > similarity[peak] + _HIGHER, -np.inf, gains(similarity, level, first, last))
    left, right = _extent(gain[:peak][::-1], _DIP * fps), _extent(gain[peak + 1 :], _DIP * fps)
    return peak - left, peak + 1 + right


def _extent(gain: NDArray[np.float64], dip: float) -> int:
    """How many of the first frames add up to most before the sum falls by more than `dip` below its highest."""
    total = np.concatenate([[0.0], np.cumsum(gain)])
    fallen = np.flatnonzero(np.maximum.accumulate(total) - total > dip)
    return int(np.argmax(total[: fallen[0]] if len(fallen) else total))


def best_spans(gain: Sequence[NDArray[np.float64]], least: int = 1) -> list[tuple[int, int]]:
    """Consecutive spans of frames, one a row, that add up to most; each begins where the one before ends or later.

    Kadane's algorithm for one row, its extension by dynamic programming for several: the best chain that ends at each
    frame is the row's sum since the best beginning, plus the best chain of the rows before up to there.

    Parameters
    ----------
    gain : sequence of S float64 arrays (T',)
    least : int
        Frames of a span; fewer where there are too few for all rows.

    Returns
    -------
    list of (start, end), S ranges of frames, `end` exclusive
    """
    frames = len(gain[0])
    least = max(min(least, frames // len(gain)), 1)
    numbers = np.arange(frames + 1)
    before = np.zeros(frames + 1)  # the best chain of the rows so far that ends at or before each frame
    links = []
    for row in gain:
        total = np.concatenate([[0.0], np.cumsum(np.maximum(row, -1e6))])
        opening = before - total
        best = np.maximum.accumulate(opening)
        begin = np.maximum.accumulate(np.where(opening >= best, numbers, 0))
        ending = np.full(frames + 1, -np.inf)
        ending[least:] = total[least:] + best[:-least]
        before = np.maximum.accumulate(ending)
        end = np.maximum.accumulate(np.where(ending >= before, numbers, 0))
        links.append((np.concatenate([np.zeros(least, np.int64), begin[:-least]]), end))
    found, at = [], frames
    for begin, end in reversed(links):
        last = int(end[at])
        at = int(begin[last])
        found.append((at, last))
    return found[::-1]
