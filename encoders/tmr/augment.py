"""Features of the same movement as another capture would have recorded it."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.body import LAYOUT, SIZE

Array = NDArray[np.float32]

#: The groups of three-dimensional vectors among the `body` features, as columns (V, 3).
_VECTORS = np.concatenate(
    [
        np.arange(SIZE)[LAYOUT[name]].reshape(-1, 3)
        for name in ("positions", "velocities", "trunk_up", "pelvis_forward", "chest_forward", "root_velocity")
    ]
)


def turned(features: Array, rng: Generator, yaw: float, tilt: float) -> Array:
    """`body` features (T, 96) in a frame that is off by a small random rotation, the same all along.

    Rigs and performers differ in what is straight ahead, and floors in what is up: people asked to walk straight go
    up to five degrees aside of where their hips point (5th and 95th percentile of the CMU takes). `yaw` and `tilt` are
    standard deviations in degrees about the vertical and about either horizontal axis.
    """
    x, y, z = np.radians(rng.normal(0.0, 1.0, 3) * (tilt, yaw, tilt))
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation, triangle = np.linalg.qr(np.eye(3) + skew)
    rotation = (rotation * np.sign(np.diag(triangle))).astype(np.float32)
    moved = features.copy()
    moved[:, _VECTORS] = features[:, _VECTORS] @ rotation.T
    return moved
