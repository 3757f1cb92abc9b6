"""Directions, rotations and tracks over time, over any number of frames."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
F = TypeVar("F", bound=np.floating[Any])


def length(vectors: NDArray[F]) -> NDArray[F]:
    """Length (...,) of vectors (..., N)."""
    # For N = 3 three times as quick as np.linalg.norm.
    lengths: NDArray[F] = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    return lengths


def unit(vectors: NDArray[F], least: float = 1e-9) -> NDArray[F]:
    """Vectors (..., N) divided by their length, or by `least` where they are shorter; zero stays zero."""
    scaled: NDArray[F] = vectors / np.maximum(length(vectors), vectors.dtype.type(least))[..., None]
    return scaled


def cross(a: NDArray[F], b: NDArray[F]) -> NDArray[F]:
    """Vector products (..., 3)."""
    # Four times as quick as np.cross for few vectors, and quicker for many.
    product = np.empty(np.broadcast_shapes(a.shape, b.shape), np.result_type(a, b))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.subtract(a[..., j] * b[..., k], a[..., k] * b[..., j], out=product[..., i])
    return product


def apply(matrices: Array, vectors: Array) -> Array:
    """Matrices (..., 3, 3) times vectors (..., 3)."""
    # For many small matrices quicker than a product of matrices.
    applied: Array = np.einsum("...ij,...j->...i", matrices, vectors)
    return applied


def angle_between(a: Array, b: Array) -> Array:
    """Angle (...,) in degrees between vectors (..., 3)."""
    angle: Array = np.degrees(np.arctan2(length(cross(a, b)), (a * b).sum(-1)))
    return angle


def frames(across: Array, up: Array) -> Array:
    """Rotations (..., 3, 3) whose columns are left, up and forward.

    `across` points left and is kept; `up` is kept as far as it is square to it.
    """
    x = unit(across)
    y = unit(up - x * (x * up).sum(-1, keepdims=True))
    return np.stack([x, y, cross(x, y)], axis=-1)


def rotation_between(a: Array, b: Array) -> Array:
    """The smallest rotations (..., 3, 3) that take directions a to directions b (..., 3).

    They are half a turn about a, then half a turn about the direction midway. Opposite directions have none midway:
    any direction square to a serves. Where a or b is zero, nothing turns.
    """
    a, b = np.broadcast_arrays(unit(a), unit(b))
    least = np.eye(3)[np.abs(a).argmin(axis=-1)]
    square = least - a * (a * least).sum(-1, keepdims=True)
    middle = unit(np.where(length(a + b)[..., None] > 1e-9, a + b, square))
    known = (length(a) > 0) & (length(b) > 0)
    return np.where(known[..., None, None], _half_turn(middle) @ _half_turn(a), np.eye(3))


def _half_turn(axis: Array) -> Array:
    """Rotations (..., 3, 3) by 180 degrees about unit vectors (..., 3)."""
    turn: Array = 2 * axis[..., :, None] * axis[..., None, :] - np.eye(3)
    return turn


def interpolate(track: NDArray[F], at: NDArray[np.floating[Any]], axis: int = 0) -> NDArray[F]:
    """A track (..., T, ...) at places `at` (N,), counted in frames from 0 to T - 1, interpolated linearly."""
    last = track.shape[axis] - 1
    low = np.minimum(at.astype(np.int64), last)
    high = np.minimum(low + 1, last)
    share = (at - low).astype(track.dtype).reshape(-1, *[1] * (track.ndim - 1 - axis))
    mixed: NDArray[F] = track.take(low, axis) * (1 - share) + track.take(high, axis) * share
    return mixed


def resample(track: NDArray[F], fps: float, to: float) -> NDArray[F]:
    """A track (T, ...) of `fps` frames a second at `to` frames a second, on the true time grid from the first frame.

    Raises
    ------
    ValueError
        If the new rate is not a positive number.
    """
    if not (np.isfinite(to) and to > 0):
        raise ValueError(f"fps={to} must be positive")
    count = int(np.floor((len(track) - 1) * to / fps + 1e-6)) + 1
    return interpolate(track, np.arange(count) * (fps / to))
