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
    peak = float(similarity[first:last].max())
    threshold = peak - max(_UPPER * (peak - level), _MIN_DROP)
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
