"""Spans of time: overlap and non-maximum suppression."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

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


def best_first(starts: ArrayLike, ends: ArrayLike, scores: ArrayLike, *, overlap: float) -> Iterator[int]:
    """Temporal non-maximum suppression: the spans that overlap no better one, one by one, best first.

    Parameters
    ----------
    starts, ends, scores : array-like (N,)
    overlap : float
        Spans with a larger intersection over union with a better one are dropped.

    Yields
    ------
    int
        Indices.
    """
    starts, ends = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    order = np.argsort(-np.asarray(scores), kind="stable")
    while len(order):
        best, order = int(order[0]), order[1:]
        yield best
        order = order[iou(starts[order], ends[order], starts[best], ends[best]) <= overlap]


def suppress(starts: ArrayLike, ends: ArrayLike, scores: ArrayLike, k: int, *, overlap: float) -> NDArray[np.int64]:
    """The first k, at most, of `best_first`: int64 array."""
    return np.array(list(islice(best_first(starts, ends, scores, overlap=overlap), k)), dtype=np.int64)
