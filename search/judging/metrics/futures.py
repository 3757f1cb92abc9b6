"""Several futures predicted for one past and one action: nearest to the truth, and how they differ.

Mao et al., "Weakly-supervised Action Transition Learning for Stochastic Human Motion Prediction" (WAT, CVPR 2022).
A frame is its joints in the body's own frame as one vector, in metres: WAT takes out the translation, too, but compares
the parameters of poses, so that its figures are of another scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from search.judging.metrics.time_warping import warped_distance
from search.plausibility.body_frame import local_pose

Array = NDArray[np.float64]


def best_of_many(futures: Sequence[NDArray[np.floating]], truth: NDArray[np.floating]) -> tuple[float, float]:
    """ADE and ADE_w: mean distance over the truth's frames, and after time warping, each of the best future.

    Parameters
    ----------
    futures : sequence of arrays (T, 22, 3)
        A shorter one holds its last pose.
    truth : array (T', 22, 3)
    """
    if not futures:
        raise ValueError("no future to compare")
    right = _frames(truth)
    rows = [_frames(future) for future in futures]
    plain = min(float(np.linalg.norm(_held(row, len(right)) - right, axis=1).mean()) for row in rows)
    return plain, min(warped_distance(row, right) for row in rows)


def future_diversity(futures: Sequence[NDArray[np.floating]]) -> tuple[float, float]:
    """Div and Div_w: mean over pairs of futures of their mean distance, up to the longest one's end, and after warping.

    Raises
    ------
    ValueError
        If there is no pair.
    """
    if len(futures) < 2:
        raise ValueError("diversity needs at least two futures")
    rows = [_frames(future) for future in futures]
    longest = max(map(len, rows))
    held = [_held(row, longest) for row in rows]
    plain = [np.linalg.norm(a - b, axis=1).mean() for a, b in combinations(held, 2)]
    return float(np.mean(plain)), float(np.mean([warped_distance(a, b) for a, b in combinations(rows, 2)]))


def _frames(joints: NDArray[np.floating]) -> Array:
    """Joints (T, 22, 3) as a row of numbers a frame (T, 66), without place and heading."""
    return local_pose(np.asarray(joints, np.float64)).reshape(len(joints), -1)


def _held(rows: Array, count: int) -> Array:
    """The first `count` rows, the last one repeated where there are fewer."""
    return rows[np.minimum(np.arange(count), len(rows) - 1)]
