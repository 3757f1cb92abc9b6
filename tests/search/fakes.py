"""A model whose answers can be foreseen: a window's vector is the direction of its mean feature."""

from __future__ import annotations

import numpy as np

FPS = 10.0
DIMENSIONS = 8


class MeanEncoder:
    """Encodes a window as the unit vector of its mean; counts what it encodes."""

    calibration = None

    def __init__(self) -> None:
        self.encoded = 0
        self.most_at_once = 0

    def encode_windows(self, features: np.ndarray, starts: np.ndarray, length: int) -> np.ndarray:
        self.encoded += len(starts)
        self.most_at_once = max(self.most_at_once, len(starts))
        sums = np.concatenate([np.zeros((1, features.shape[1])), np.cumsum(features, axis=0, dtype=np.float64)])
        means = sums[np.asarray(starts) + length] - sums[np.asarray(starts)]
        return (means / np.maximum(np.linalg.norm(means, axis=1, keepdims=True), 1e-9)).astype(np.float32)


def take(seconds: float, *actions: tuple[float, float, int], seed: int = 0) -> np.ndarray:
    """Features of a take: each (start, end, kind) in seconds points along the axis `kind`, all else along the last two.

    Elsewhere the last two kinds take turns of three seconds, and everything is noisy.
    """
    features = np.random.default_rng(seed).normal(scale=0.2, size=(round(seconds * FPS), DIMENSIONS))
    kinds = DIMENSIONS - 2 + np.arange(len(features)) // round(3 * FPS) % 2
    free = np.ones(len(features), bool)
    for start, end, kind in actions:
        span = slice(round(start * FPS), round(end * FPS))
        features[span, kind] += 1.0
        free[span] = False
    features[free, kinds[free]] += 1.0
    return features.astype(np.float32)


def query(*kinds: int) -> np.ndarray:
    """Unit vectors (Q, D) that ask for the kinds."""
    return np.eye(DIMENSIONS, dtype=np.float32)[list(kinds)]
