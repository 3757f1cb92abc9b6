"""Exact t-SNE (van der Maaten and Hinton, 2008) of unit vectors, initialised with the two principal components."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

_PERPLEXITY = 20.0
_ITERATIONS = 350
#: Early exaggeration: attraction is multiplied by this in the first quarter of the iterations.
_EXAGGERATION = 12


def tsne(vectors: Array) -> Array:
    """Points (N, 2) of unit vectors (N, D); time and memory grow with N squared, so N is at most a few thousand."""
    count = len(vectors)
    points = _principal_components(vectors)
    if count < 4:
        return points
    p = _joint_probabilities(2 - 2 * vectors @ vectors.T, min(_PERPLEXITY, (count - 1) / 3))
    points *= 1e-2 / max(float(points.std()), 1e-9)
    velocity, gain = np.zeros_like(points), np.ones_like(points)
    rate = max(count / 12, 20.0)
    for iteration in range(_ITERATIONS):
        early = iteration < _ITERATIONS // 4
        gradient = _gradient(p * _EXAGGERATION if early else p, points)
        gain = np.clip(np.where(np.sign(gradient) != np.sign(velocity), gain + 0.2, gain * 0.8), 0.01, None)
        velocity = (0.5 if early else 0.8) * velocity - rate * gain * gradient
        points = points + velocity
        points -= points.mean(axis=0)
    return np.asarray(points, np.float32)


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
