"""Frames for an animation that has keys and no frame rate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Where keys are sparse an animation is sampled at the usual rate; none is sampled faster than the fastest cameras.
SPARSE_FPS, USUAL_FPS, MAX_FPS = 20, 30, 240
MAX_HOURS = 12
_LONGEST = 10.0  # seconds between two keys that say nothing of a rate
_ON_GRID = 0.01  # frames by which the last key may lie before a frame


def key_rate(keys: Sequence[Array]) -> float:
    """Frames a second of key times (K,) in seconds: the most common spacing; `USUAL_FPS` where keys are sparse."""
    spacings = np.concatenate([np.diff(times) for times in keys])
    rates = np.round(1 / spacings[(spacings > 1 / (4 * MAX_FPS)) & (spacings < _LONGEST)]).astype(np.int64)
    if not len(rates):
        return float(USUAL_FPS)
    common = int(np.bincount(rates).argmax())
    return float(min(common, MAX_FPS) if common >= SPARSE_FPS else USUAL_FPS)


def sample_times(first: float, last: float, rate: float) -> Array:
    """Times (T,) of frames from `first` to `last`, all in seconds.

    Raises
    ------
    ValueError
        If they would last longer than `MAX_HOURS`.
    """
    if not last - first <= MAX_HOURS * 3600:
        raise ValueError(f"it lasts {(last - first) / 3600:.3g} hours")
    times: Array = first + np.arange(int((last - first) * rate + _ON_GRID) + 1) / rate
    return times
