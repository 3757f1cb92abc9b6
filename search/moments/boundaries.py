"""Boundaries of a moment: how far it extends from its peak in a curve of similarity over time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: A moment goes on while similarity stays in the upper part between the background level and its peak, or within so
#: much of the peak.
_UPPER = 0.35
_MIN_DROP = 0.16
#: Similarity so much above its peak belongs to another moment.
_HIGHER = 0.05
#: How much below that a moment may dip and still be one, in seconds times cosine.
_DIP = 0.1
#: Gain beyond the ends of the motion and where a higher moment begins: nothing makes up for it.
_NEVER = -1e3
#: Seconds on either side of a peak that are looked at first; four times as many while a moment goes on.
_REACH = 10.0
#: Peaks that are grown at once.
_PEAKS = 256


def local_maxima(similarity: NDArray[np.floating]) -> NDArray[np.int64]:
    """The frames (P,) of a curve (T',) that are higher than the one before and no lower than the next."""
    rise = np.diff(similarity) > 0
    return np.flatnonzero(np.r_[True, rise] & ~np.r_[rise, False])


def gains(similarity: NDArray[np.floating], level: float, first: int, last: int) -> NDArray[np.float64]:
    """What each frame adds to a moment that peaks within the frames from `first` to `last`: positive where it goes on.

    Parameters
    ----------
    similarity : array (T',)
    level : float
        The background level.

    Returns
    -------
    float64 array (T',)
    """
    return np.asarray(similarity, np.float64) - _threshold(similarity[first:last].max(), level)


def grow(
    similarity: NDArray[np.floating], level: float, fps: float, peaks: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The moments around the peaks (P,) as ranges of frames: first and end frames (P,).

    From its peak a moment grows to either side to where its gains add up to most, stopping where they have fallen too
    far below that, as alignments are extended in sequence search (X-drop; Altschul et al. 1990), or where a higher
    moment begins.
    """
    first, end = np.empty_like(peaks), np.empty_like(peaks)
    for at in range(0, len(peaks), _PEAKS):
        some = slice(at, at + _PEAKS)
        first[some] = peaks[some] - _extents(similarity, level, fps, peaks[some], -1)
        end[some] = peaks[some] + 1 + _extents(similarity, level, fps, peaks[some], 1)
    return first, end


def _threshold(peak: NDArray[np.floating], level: float) -> NDArray[np.float64]:
    return np.asarray(peak - np.maximum(_UPPER * (peak - level), _MIN_DROP), np.float64)


def _extents(
    similarity: NDArray[np.floating], level: float, fps: float, peaks: NDArray[np.int64], side: int
) -> NDArray[np.int64]:
    """How many frames beside each peak belong to its moment, before (`side` -1) or after it (1)."""
    height = similarity[peaks][:, None].astype(np.float64)
    reach = round(_REACH * fps)
    while True:
        frames = peaks[:, None] + side * np.arange(1, reach + 1)
        inside = (frames >= 0) & (frames < len(similarity))
        beside = similarity[np.clip(frames, 0, len(similarity) - 1)]
        gain = np.where(inside & (beside <= height + _HIGHER), beside - _threshold(height, level), _NEVER)
        total = np.concatenate([np.zeros((len(peaks), 1)), np.cumsum(gain, axis=1)], axis=1)
        fallen = np.maximum.accumulate(total, axis=1) - total > _DIP * fps
        if fallen.any(axis=1).all():
            over = np.logical_or.accumulate(fallen, axis=1)
            return np.asarray(np.where(over, -np.inf, total).argmax(axis=1), np.int64)
        reach *= 4
