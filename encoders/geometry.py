"""Directions, angles and rotations, over any number of frames."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def unit(vectors: Array) -> Array:
    """Vectors (..., 3) made one long; zero stays zero."""
    scaled: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
    return scaled


def angle_between(a: Array, b: Array) -> Array:
    """Angle (...,) in degrees between vectors (..., 3)."""
    angle: Array = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1)))
    return angle


def frames(across: Array, up: Array) -> Array:
    """Rotations (..., 3, 3) whose columns are left, up and forward.

    `across` points left and is kept; `up` is kept as far as it is square to it.
    """
    x = unit(across)
    y = unit(up - x * (x * up).sum(-1, keepdims=True))
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def rotation_between(a: Array, b: Array) -> Array:
    """The smallest rotation (3, 3) that takes direction a to direction b (Rodrigues' formula)."""
    a, b = unit(a), unit(b)
    axis = np.cross(a, b)
    cos = float(a @ b)
    if cos < -0.999:
        return np.eye(3)
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation: Array = np.eye(3) + skew + skew @ skew / (1 + cos)
    return rotation
