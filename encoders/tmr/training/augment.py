"""Augmentation of features: random rotation and pose jitter."""

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
    """`body` features (T, 96) rotated a little at random, the same in all frames.

    Rigs and performers differ in what is straight ahead, and floors in what is up: people asked to walk straight go
    up to five degrees aside of where their hips point (5th and 95th percentile of the CMU takes). `yaw` and `tilt` are
    standard deviations in degrees about the vertical and about either horizontal axis.
    """
    moved = features.copy()
    moved[:, _VECTORS] = features[:, _VECTORS] @ _rotations(rng.normal(0.0, 1.0, (1, 3)) * (tilt, yaw, tilt))[0].T
    return moved


def pose_jitter(features: Array, rng: Generator, degrees: float) -> Array:
    """`body` features (T, 96) with a constant offset of arms and trunk, and a larger or smaller arm swing.

    Trunk, upper arms and forearms are rotated at random about each axis, the same in all frames: by `degrees` for limbs
    and half of that for the trunk (standard deviations). The deviation of a limb from its mean direction is scaled by a
    factor whose logarithm has `degrees`, in radians, as its standard deviation. Legs stay.
    """
    moved = features.copy()
    angles = rng.normal(0.0, degrees, (5, 3))
    angles[0] *= (0.5, 0.0, 0.5)  # a constant twist of the chest against the hips is rare
    trunk, *arms = _rotations(angles)
    gain = np.float32(np.exp(rng.normal(0.0, np.radians(degrees))))
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
