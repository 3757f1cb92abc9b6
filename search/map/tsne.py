"""t-SNE (van der Maaten and Hinton, 2008) of unit vectors, initialised with the two principal components.

Our own is exact and for small numbers; openTSNE, an extra, approximates it in time linear in their number.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

_PERPLEXITY = 20.0
_ITERATIONS = 350
#: Early exaggeration: attraction is multiplied by this in the first quarter of the iterations.
_EXAGGERATION = 12
#: Iterations of openTSNE, early and after, and between two reports of progress.
_EARLY, _LATE, _REPORT = 250, 250, 10
#: Numbers that have exact repulsion in openTSNE.
_SMALL = 2000
#: The part of the work of openTSNE that finding neighbours is, and vectors that are compared with all at once.
_FINDING, _BLOCK = 0.1, 512


def tsne(vectors: Array, progress: Callable[[float], None] = lambda _: None) -> Array:
    """Points (N, 2) of unit vectors (N, D); time and memory grow with N squared, so N is at most a few thousand.

    `progress` is called with the part of the work that is done, 0 to 1.
    """
    count = len(vectors)
    points = _principal_components(vectors)
    if count < 4:
        return points
    p = _joint_probabilities(2 - 2 * vectors @ vectors.T, min(_PERPLEXITY, (count - 1) / 3))
    points *= 1e-2 / max(float(points.std()), 1e-9)
    velocity, gain = np.zeros_like(points), np.ones_like(points)
    rate = max(count / 12, 20.0)
    for iteration in range(_ITERATIONS):
        progress(iteration / _ITERATIONS)
        early = iteration < _ITERATIONS // 4
        gradient = _gradient(p * _EXAGGERATION if early else p, points)
        gain = np.clip(np.where(np.sign(gradient) != np.sign(velocity), gain + 0.2, gain * 0.8), 0.01, None)
        velocity = (0.5 if early else 0.8) * velocity - rate * gain * gradient
        points = points + velocity
        points -= points.mean(axis=0)
    return np.asarray(points, np.float32)


def open_tsne(vectors: Array, progress: Callable[[float], None] = lambda _: None) -> Array:
    """As `tsne`, by openTSNE (Poličar, Stražar and Zupan, 2024), for hundreds of thousands."""
    if len(vectors) < 10:
        return tsne(vectors, progress)
    from openTSNE import TSNEEmbedding
    from openTSNE.affinity import PerplexityBasedNN
    from openTSNE.nearest_neighbors import PrecomputedNeighbors

    few, near = len(vectors) < _SMALL, min(int(3 * _PERPLEXITY), len(vectors) - 1)
    nearest = PrecomputedNeighbors(*neighbours(vectors, near, lambda part: progress(_FINDING * part)))
    affinities = PerplexityBasedNN(perplexity=_PERPLEXITY, knn_index=nearest, n_jobs=1)
    initial = _principal_components(vectors)
    initial *= 1e-4 / max(float(initial[:, 0].std()), 1e-12)
    embedding = TSNEEmbedding(
        initial, affinities, negative_gradient_method="bh" if few else "fft", n_jobs=1, random_state=0
    )
    for iterations, before, settings in (
        (_EARLY, 0, {"exaggeration": _EXAGGERATION, "momentum": 0.5}),
        (_LATE, _EARLY, {"momentum": 0.8}),
    ):

        def report(iteration: int, *_: object, before: int = before) -> None:
            progress(_FINDING + (1 - _FINDING) * (before + iteration) / (_EARLY + _LATE))

        embedding = embedding.optimize(n_iter=iterations, callbacks=[report], callbacks_every_iters=_REPORT, **settings)
    return np.asarray(embedding, np.float32)


def neighbours(
    vectors: Array, count: int, progress: Callable[[float], None] = lambda _: None
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The places (N, count) of the nearest of unit vectors (N, D), in order, and their distances; all are compared."""
    found = np.empty((len(vectors), count), np.int64)
    distances = np.empty((len(vectors), count))
    for first in range(0, len(vectors), _BLOCK):
        progress(first / len(vectors))
        away = 2 - 2 * vectors[first : first + _BLOCK] @ vectors.T
        away[np.arange(len(away)), np.arange(first, first + len(away))] = np.inf
        near = np.argpartition(away, count - 1, axis=1)[:, :count]
        squares = np.take_along_axis(away, near, axis=1)
        order = squares.argsort(axis=1, kind="stable")
        found[first : first + _BLOCK] = np.take_along_axis(near, order, axis=1)
        distances[first : first + _BLOCK] = np.sqrt(np.maximum(np.take_along_axis(squares, order, axis=1), 0))
    return found, distances


def _gradient(p: Array, points: Array) -> Array:
    """The gradient (N, 2) of the Kullback-Leibler divergence at points (N, 2) for joint probabilities (N, N)."""
    squares = (points**2).sum(axis=1)
    kernel = 1 / (1 + np.maximum(squares[:, None] + squares - 2 * points @ points.T, 0))
    np.fill_diagonal(kernel, 0)
    force = (p - kernel / kernel.sum()) * kernel
    gradient: Array = 4 * (force.sum(axis=1)[:, None] * points - force @ points)
    return gradient


def _joint_probabilities(distances: Array, perplexity: float) -> Array:
    """Joint probabilities (N, N) of squared distances; each row's bandwidth is found by bisection on its entropy."""
    distances = np.maximum(distances, 0)
    np.fill_diagonal(distances, np.inf)
    low, high = np.zeros(len(distances)), np.full(len(distances), np.inf)
    beta = np.ones(len(distances))
    least = distances.min(axis=1, keepdims=True)
    for _ in range(40):
        p = np.exp(-(distances - least) * beta[:, None])
        p /= p.sum(axis=1, keepdims=True)
        entropy = -(p * np.log(np.maximum(p, 1e-12))).sum(axis=1)
        wide = entropy > np.log(perplexity)
        low, high = np.where(wide, beta, low), np.where(wide, high, beta)
        beta = np.where(np.isinf(high), beta * 2, (low + high) / 2)
    joint: Array = ((p + p.T) / (2 * len(p))).astype(np.float32)
    return joint


def _principal_components(vectors: Array) -> Array:
    """The projections (N, 2) of vectors on their first two principal axes."""
    centred = vectors - vectors.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    return np.ascontiguousarray(centred @ axes[:, :-3:-1], np.float32)
