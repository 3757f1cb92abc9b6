"""Features of the same movement as another capture would have recorded it."""

from __future__ import annotations

from itertools import chain

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.features.canonical import LAYOUT, POINTS, SIZE

Array = NDArray[np.float32]

#: The groups of three-dimensional vectors among the `body` features, as columns (V, 3).
_VECTORS = np.concatenate(
    [
        np.arange(SIZE)[LAYOUT[name]].reshape(-1, 3)
        for name in ("positions", "velocities", "trunk_up", "pelvis_forward", "chest_forward", "root_velocity")
    ]
)

#: Columns (2, points, 3) of where each point is and how it moves.
_COLUMNS = np.stack([np.arange(SIZE)[LAYOUT[name]].reshape(-1, 3) for name in ("positions", "velocities")])
#: Shoulder, elbow and wrist of either side among the points.
_ARMS = [[POINTS.index(f"{side}_{joint}") for joint in ("shoulder", "elbow", "wrist")] for side in ("left", "right")]
#: Columns (V, 3) of the vectors that go along with the trunk.
_UPPER_VECTORS = np.concatenate(
    [
        _COLUMNS[:, [POINTS.index("head"), *chain(*_ARMS)]].reshape(-1, 3),
        *(np.arange(SIZE)[LAYOUT[name]].reshape(-1, 3) for name in ("trunk_up", "pelvis_forward", "chest_forward")),
    ]
)


def random_rotation(features: Array, rng: Generator, yaw: float, tilt: float) -> Array:
    """`body` features (T, 96) in a frame that is off by a small random rotation, the same all along.

    Rigs and performers differ in what is straight ahead, and floors in what is up: people asked to walk straight go
    up to five degrees aside of where their hips point (5th and 95th percentile of the CMU takes). `yaw` and `tilt` are
    standard deviations in degrees about the vertical and about either horizontal axis.
    """
    moved = features.copy()
    moved[:, _VECTORS] = features[:, _VECTORS] @ _rotations(rng.normal(0.0, 1.0, (1, 3)) * (tilt, yaw, tilt))[0].T
    return moved


def pose_jitter(features: Array, rng: Generator, posture: float) -> Array:
    """`body` features (T, 96) of somebody who carries arms and trunk otherwise, and swings the arms more or less.

    Trunk, upper arms and forearms are turned by small random rotations, the same all along: of `posture` degrees about
    each axis for limbs and half of that for the trunk (standard deviations). How far a limb goes from its mean
    direction is changed by a factor whose logarithm has `posture` in radians as its standard deviation. Legs stay.
    """
    moved = features.copy()
    degrees = rng.normal(0.0, posture, (5, 3))
    degrees[0] *= (0.5, 0.0, 0.5)  # chest against hips is seldom a habit
    trunk, *arms = _rotations(degrees)
    gain = np.float32(np.exp(rng.normal(0.0, np.radians(posture))))
    moved[:, _UPPER_VECTORS] = features[:, _UPPER_VECTORS] @ trunk.T
    for (shoulder, elbow, wrist), upper, lower in zip(_ARMS, arms[::2], arms[1::2], strict=True):
        upper_arm = _limb(moved, shoulder, elbow, upper, gain)
        forearm = _limb(moved, elbow, wrist, upper @ lower, gain)
        moved[:, _COLUMNS[:, elbow]] = moved[:, _COLUMNS[:, shoulder]] + upper_arm
        moved[:, _COLUMNS[:, wrist]] = moved[:, _COLUMNS[:, elbow]] + forearm
    return moved


def _limb(features: Array, start: int, end: int, turn: Array, gain: np.float32) -> Array:
    """The vector between two points and its velocity (T, 2, 3), turned, and `gain` times as far from its mean."""
    limb = features[:, _COLUMNS[:, end]] - features[:, _COLUMNS[:, start]]
    place = limb[:, 0]
    middle = place.mean(0)
    swung = middle + gain * (place - middle)
    swung *= np.linalg.norm(place, axis=1, keepdims=True) / np.maximum(
        np.linalg.norm(swung, axis=1, keepdims=True), 1e-6
    )
    changed: Array = np.stack([swung, gain * limb[:, 1]], axis=1) @ turn.T
    return changed


def _rotations(degrees: NDArray[np.float64]) -> Array:
    """Rotations (N, 3, 3) by small angles (N, 3) about X, Y and Z."""
    x, y, z = np.radians(degrees).T
    none = np.zeros_like(x)
    skew = np.array([[none, -z, y], [z, none, -x], [-y, x, none]]).transpose(2, 0, 1)
    rotation, triangle = np.linalg.qr(np.eye(3) + skew)
    return np.asarray(rotation * np.sign(np.diagonal(triangle, axis1=1, axis2=2))[:, None], np.float32)
