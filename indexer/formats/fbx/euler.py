"""Rotations about three axes in the orders that FBX knows, as quaternions (4, T): x, y, z, w."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: The axes in the order in which they turn a body; the last order of the format, spherical, is read as the first.
ORDERS = ((0, 1, 2), (0, 2, 1), (1, 2, 0), (1, 0, 2), (2, 0, 1), (2, 1, 0), (0, 1, 2))


def axes_of(order: float) -> tuple[int, int, int]:
    """Axes of a rotation order by its number."""
    return ORDERS[int(order)] if 0 <= order < len(ORDERS) else ORDERS[0]


def euler_axes(degrees: Floats, order: tuple[int, int, int], out: Floats) -> None:
    """Write where the axes of turned frames point.

    Parameters
    ----------
    degrees : float array (M, 3, T)
        Angles about x, y and z.
    order : tuple of int
        The axes in the order in which they turn a body.
    out : float array (M, 3 axes, 3, T)
    """
    i, j, k = order
    sign = 1.0 if order in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1.0  # the others are mirrored
    radians = np.deg2rad(degrees)
    cosine, sine = np.cos(radians), np.sin(radians) * sign
    ci, cj, ck = (cosine[:, axis] for axis in order)
    si, sj, sk = (sine[:, axis] for axis in order)
    cc, cs, sc, ss = ci * ck, ci * sk, si * ck, si * sk
    out[:, i, i], out[:, i, j], out[:, i, k] = cj * ck, cj * sk, -sj
    out[:, j, i], out[:, j, j], out[:, j, k] = sj * sc - cs, sj * ss + cc, si * cj
    out[:, k, i], out[:, k, j], out[:, k, k] = sj * cc + ss, sj * cs - sc, ci * cj


def multiply(a: Floats, b: Floats) -> Floats:
    """The rotation `a` after `b`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )


def euler_to_quaternion(degrees: Floats, order: float) -> Floats:
    """Quaternions (4, T) of angles (3, T) about x, y and z."""
    half = np.deg2rad(degrees) / 2
    turned = np.zeros((4, degrees.shape[1]))
    turned[3] = 1
    for axis in axes_of(order):
        about = np.zeros_like(turned)
        about[axis], about[3] = np.sin(half[axis]), np.cos(half[axis])
        turned = multiply(about, turned)
    return turned


def quaternion_to_euler(quaternions: Floats, order: float) -> Floats:
    """Angles (3, T) in degrees about x, y and z; where the second one is a right angle, the third is 0."""
    i, j, k = axes_of(order)
    sign = 1.0 if (i, j, k) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1.0
    x, y, z, w = quaternions[i], quaternions[j], sign * quaternions[k], quaternions[3]
    # in the axes i, j, k, the last one mirrored where they are left-handed, this is yaw, pitch and roll
    middle = np.clip(2 * (w * y - x * z), -1, 1)
    first = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    last = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    is_locked = np.abs(middle) > 1 - 1e-12
    first = np.where(is_locked, 2 * np.arctan2(x, w), first)
    last = np.where(is_locked, 0.0, last)
    angles = np.empty((3, quaternions.shape[1]))
    angles[i], angles[j], angles[k] = first, np.arcsin(middle), sign * last
    return np.rad2deg(angles)


def slerp(a: Floats, b: Floats, share: Floats) -> Floats:
    """Rotations a share (T,) of the shorter way from `a` to `b`."""
    cosine = (a * b).sum(axis=0)
    b = np.where(cosine < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(cosine), 0, 1))
    sine = np.sin(angle)
    is_near = sine < 1e-9
    scale = np.where(is_near, 1.0, sine)
    mixed = np.where(is_near, a, (a * np.sin((1 - share) * angle) + b * np.sin(share * angle)) / scale)
    turned: Floats = mixed / np.maximum(np.sqrt((mixed**2).sum(axis=0)), 1e-300)
    return turned
