"""Joints in the frame of the body, and motions brought to one beginning."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.skeleton import INDEX

Array = NDArray[np.float64]

_LEFT_HIP, _RIGHT_HIP, _LEFT_SHOULDER, _RIGHT_SHOULDER = (
    INDEX[name] for name in ("left_hip", "right_hip", "left_shoulder", "right_shoulder")
)


def headings(joints: Array) -> Array:
    """Angles (T,) about Y, from +Z towards +X, that a body of joints (T, 22, 3) faces.

    Square to the mean of the lines across hips and shoulders, as RIFKE has it (Holden et al., SIGGRAPH 2016; Petrovich,
    thesis, 2.4.1). Where these stand upright the last known angle holds.
    """
    across = joints[:, _LEFT_HIP] - joints[:, _RIGHT_HIP] + joints[:, _LEFT_SHOULDER] - joints[:, _RIGHT_SHOULDER]
    known = np.hypot(across[:, 0], across[:, 2]) > 1e-6
    angles = np.arctan2(-across[:, 2], across[:, 0])
    last = np.maximum.accumulate(np.where(known, np.arange(len(angles)), -1))
    return np.where(last >= 0, angles[last], 0.0)


def turned(vectors: Array, angles: Array) -> Array:
    """Vectors (T, J, 3) turned about Y by angles (T,) or one angle, from +Z towards +X."""
    cosine, sine = (np.broadcast_to(f(angles), len(vectors))[:, None] for f in (np.cos, np.sin))
    x, z = vectors[..., 0], vectors[..., 2]
    return np.stack([cosine * x + sine * z, vectors[..., 1], cosine * z - sine * x], axis=-1)


def local_pose(joints: Array, *, keep_height: bool = False) -> Array:
    """Joints (T, 22, 3) from the root, every frame facing +Z; with `keep_height` heights stay those of the world."""
    root = joints[:, :1].copy()
    if keep_height:
        root[..., 1] = 0
    return turned(joints - root, -headings(joints))


def from_origin(joints: Array) -> Array:
    """A motion (T, 22, 3) that begins above the origin and faces +Z there; heights stay."""
    start = joints[:1, :1] * np.array([1.0, 0.0, 1.0])
    return turned(joints - start, -headings(joints[:1])[0])
