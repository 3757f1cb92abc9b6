"""A model whose answers can be foreseen: a window's vector is the direction of its mean feature."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from encoders.motion import Motion
from search.moments.queried_motion import QueriedMotion
from search.query.question import EncodedQuestion
from search.source import MotionSource

FPS = 10.0
DIMENSIONS = 8


class MeanEncoder:
    """An `Encoder` of windows as the unit vectors of their means; counts what it encodes."""

    name, fingerprint, feature_kind = "mean", "mean", "body"
    fps, max_frames, latent_size = FPS, 128, DIMENSIONS

    def __init__(self, calibration: Mapping[str, np.ndarray] | None = None) -> None:
        self.calibration = calibration
        self.encoded = 0
        self.most_at_once = 0

    def features(self, motion: Motion) -> np.ndarray:
        return motion.joints.reshape(len(motion), -1)

    def encode_windows(self, features: np.ndarray, starts: np.ndarray, length: int) -> np.ndarray:
        self.encoded += len(starts)
        self.most_at_once = max(self.most_at_once, len(starts))
        sums = np.concatenate([np.zeros((1, features.shape[1])), np.cumsum(features, axis=0, dtype=np.float64)])
        means = sums[np.asarray(starts) + length] - sums[np.asarray(starts)]
        return (means / np.maximum(np.linalg.norm(means, axis=1, keepdims=True), 1e-9)).astype(np.float32)

    def encode_features(self, features: Sequence[np.ndarray]) -> np.ndarray:
        return np.stack([self.encode_windows(rows, np.array([0]), len(rows))[0] for rows in features])

    def encode_motions(self, motions: Sequence[Motion]) -> np.ndarray:
        return self.encode_features([self.features(motion) for motion in motions])

    def encode_texts(self, sentences: Sequence[str]) -> np.ndarray:
        raise NotImplementedError("sentences mean nothing to it; ask with `query`")


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


def queried(features: np.ndarray, *kinds: int, encoder: MeanEncoder | None = None) -> QueriedMotion:
    """A question for the kinds, asked of a motion whose first numbers are these features."""
    joints = np.zeros((len(features), 66), np.float32)
    joints[:, :DIMENSIONS] = features
    vectors = np.pad(query(*kinds), ((0, 0), (0, 66 - DIMENSIONS)))
    motion = MotionSource.of_motion(Motion(joints.reshape(-1, 22, 3), FPS))
    return QueriedMotion(encoder or MeanEncoder(), motion, EncodedQuestion(vectors, tuple(map(str, kinds))))
