"""Dynamic time warping: two sequences compared at whatever pace each has (Sakoe and Chiba, 1978)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def warped_distance(a: Array, b: Array) -> float:
    """Mean distance of the frames (T, D), (T', D) that the cheapest alignment puts side by side.

    The alignment begins and ends with both sequences and goes on by a frame of either or of both.
    """
    if not len(a) or not len(b):
        raise ValueError("an empty sequence cannot be aligned")
    square = (a**2).sum(1)[:, None] + (b**2).sum(1) - 2 * a @ b.T
    costs = np.sqrt(np.maximum(square, 0))
    return _cheapest(costs)


def _cheapest(costs: Array) -> float:
    """Total cost of the cheapest path through costs (T, T'), over the pairs on it; one anti-diagonal at a time."""
    rows, columns = costs.shape
    total = np.full((rows + 1, columns + 1), np.inf)
    steps = np.zeros((rows + 1, columns + 1))
    total[0, 0] = 0
    for diagonal in range(2, rows + columns + 1):
        i = np.arange(max(1, diagonal - columns), min(rows, diagonal - 1) + 1)
        j = diagonal - i
        before = np.stack([total[i - 1, j - 1], total[i - 1, j], total[i, j - 1]])
        way = before.argmin(axis=0)
        taken = np.stack([steps[i - 1, j - 1], steps[i - 1, j], steps[i, j - 1]])
        total[i, j] = costs[i - 1, j - 1] + before[way, np.arange(len(i))]
        steps[i, j] = 1 + taken[way, np.arange(len(i))]
    return float(total[rows, columns] / steps[rows, columns])
