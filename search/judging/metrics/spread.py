"""How much motions differ: over all of them, and among those of one label or sentence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

#: Pairs over all motions, and pairs of each label: those of ACTOR's and Action2Motion's code.
PAIRS, PAIRS_OF_A_LABEL = 200, 20


def diversity(vectors: ArrayLike, rng: Generator, pairs: int = PAIRS) -> float:
    """Mean Euclidean distance of `pairs` pairs of vectors (N, D), both drawn with replacement.

    Guo et al., "Action2Motion" (ACM MM 2020); ACTOR's code takes 200 pairs, T2M's and T2LM's 300. Nearer to the
    real motions' figure is better.

    Raises
    ------
    ValueError
        If there are fewer than two vectors.
    """
    points = np.asarray(vectors, np.float64)
    if points.ndim != 2 or len(points) < 2:
        raise ValueError(f"vectors {points.shape} must be (N, D) with N >= 2")
    first, second = rng.integers(len(points), size=(2, pairs))
    return float(np.linalg.norm(points[first] - points[second], axis=1).mean())


def multimodality(vectors: ArrayLike, groups: Sequence[str], rng: Generator, pairs: int = PAIRS_OF_A_LABEL) -> float:
    """Mean Euclidean distance of `pairs` pairs of two different motions of one group, averaged over groups.

    Guo et al. (ACM MM 2020): groups are the motions of one label; Guo et al. (CVPR 2022): of one sentence. The
    published code also pairs a motion with itself: with n motions in each group its figure is this one times 1 - 1/n.

    Parameters
    ----------
    vectors : array (N, D)
    groups : sequence of N strings
        Groups of a single motion do not count.

    Raises
    ------
    ValueError
        If no group has two motions.
    """
    points, names = np.asarray(vectors, np.float64), np.asarray(groups)
    if len(points) != len(names):
        raise ValueError(f"{len(points)} vectors and {len(names)} groups")
    members = [np.flatnonzero(names == name) for name in np.unique(names)]
    means = [_within(points[rows], rng, pairs) for rows in members if len(rows) > 1]
    if not means:
        raise ValueError("no group has two motions")
    return float(np.mean(means))


def _within(points: NDArray[np.float64], rng: Generator, pairs: int) -> float:
    first = rng.integers(len(points), size=pairs)
    second = (first + rng.integers(1, len(points), size=pairs)) % len(points)
    return float(np.linalg.norm(points[first] - points[second], axis=1).mean())
