"""Rotations as unit quaternions (x, y, z, w), the order of glTF."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def to_quaternions(rotations: Array) -> Array:
    """Quaternions (T, ..., 4) of rotations (T, ..., 3, 3), each on the side of the one a frame before.

    Each column of 4 q q^T can be read off a rotation; the one with the largest diagonal is the most accurate
    (Bar-Itzhack, "New method for extracting the quaternion from a rotation matrix", 2000, in its closed form).
    """
    m = rotations
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    xy, xz, yz = m[..., 0, 1] + m[..., 1, 0], m[..., 0, 2] + m[..., 2, 0], m[..., 1, 2] + m[..., 2, 1]
    xw, yw, zw = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    products = np.stack(
        [
            np.stack([1 + xx - yy - zz, xy, xz, xw], axis=-1),
            np.stack([xy, 1 - xx + yy - zz, yz, yw], axis=-1),
            np.stack([xz, yz, 1 - xx - yy + zz, zw], axis=-1),
            np.stack([xw, yw, zw, 1 + xx + yy + zz], axis=-1),
        ],
        axis=-2,
    )
    best = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    found: Array = np.take_along_axis(products, best[..., None, None], axis=-2)[..., 0, :]
    found = found / np.linalg.norm(found, axis=-1, keepdims=True)
    turned = np.sign((found[1:] * found[:-1]).sum(axis=-1))
    found[1:] *= np.cumprod(np.where(turned < 0, -1.0, 1.0), axis=0)[..., None]
    return found


def to_matrices(quaternions: Array) -> Array:
    """Rotations (..., 3, 3) of unit quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def slerp(track: Array, at: Array) -> Array:
    """Quaternions of a track (T, ..., 4) at places `at` (N,), counted in frames from 0 to T - 1; turning evenly."""
    low = np.minimum(at.astype(np.int64), len(track) - 1)
    high = np.minimum(low + 1, len(track) - 1)
    return between(track[low], track[high], (at - low).reshape(-1, *[1] * (track.ndim - 2)))


def between(a: Array, b: Array, share: Array) -> Array:
    """Unit quaternions (..., 4) a share (...,) of the shorter way from `a` to `b` (Shoemake, SIGGRAPH 1985)."""
    cosine = (a * b).sum(axis=-1)
    b = np.where(cosine[..., None] < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(cosine), 0, 1))
    sine = np.sin(angle)
    near = sine < 1e-6
    safe = np.where(near, 1.0, sine)
    first = np.where(near, 1 - share, np.sin((1 - share) * angle) / safe)
    second = np.where(near, share, np.sin(share * angle) / safe)
    mixed = a * first[..., None] + b * second[..., None]
    unit: Array = mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)
    return unit
