"""Spans of time: overlap and non-maximum suppression."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def iou(starts: ArrayLike, ends: ArrayLike, start: float, end: float) -> NDArray[np.float64]:
    """Temporal intersection over union of each span with the span from `start` to `end`.

    Parameters
    ----------
    starts, ends : array-like (N,)

    Returns
    -------
    float64 array (N,), 0 to 1
    """
    starts, ends = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    shared = np.clip(np.minimum(ends, end) - np.maximum(starts, start), 0, None)
    union = (ends - starts) + (end - start) - shared
    return np.asarray(shared / np.maximum(union, 1e-9), dtype=np.float64)


def suppress(starts: ArrayLike, ends: ArrayLike, scores: ArrayLike, k: int, *, overlap: float) -> NDArray[np.int64]:
    """Temporal non-maximum suppression: the best spans that overlap no better one.

    Parameters
    ----------
    starts, ends, scores : array-like (N,)
    k : int
        At most so many.
    overlap : float
        Spans with a larger intersection over union with a better one are dropped.

    Returns
    -------
    int64 array (at most k,)
        Indices, best first.
    """
    starts, ends = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    order = np.argsort(-np.asarray(scores), kind="stable")
    kept: list[int] = []
    while len(order) and len(kept) < k:
        best, order = int(order[0]), order[1:]
        kept.append(best)
        order = order[iou(starts[order], ends[order], starts[best], ends[best]) <= overlap]
    return np.array(kept, dtype=np.int64)
