"""Key poses: whole-body rows of curves, and smooth movement through them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.curves import ANKLE, BODY, HANGING, HIP, STAND, Array, Curves, standing

Triple = tuple[float, float, float]

_FIELDS = ("root", "pelvis", "spine", "head")
_BOTH = {"hands": 1.0, "feet": -1.0, "reach": -1.0}


def pose(**channels: ArrayLike) -> Array:
    """One row of curves (45,): standing, but for the named channels.

    `root`, `pelvis`, `spine`, `head`, `heading` as in `Curves`. For `hands`, `feet`, `reach`, `elbow`, `knee`,
    `foot_pitch`, `foot_yaw`, `hang`, `shrug`: the left side's value, the right side mirrors it; with a "left_" or
    "right_" before the name, one side's. Naming `reach` gives it full weight.
    """
    curves = standing(1)
    for name, value in channels.items():
        side = name.partition("_")[0]
        if side in ("left", "right"):
            _set(curves, name[len(side) + 1 :], 0 if side == "left" else 1, value)
        elif name in (*_FIELDS, "heading"):
            getattr(curves, name)[:] = value
        else:
            _set(curves, name, 0, value)
            _set(curves, name, 1, _mirrored(name, value))
    return curves.data[0]


def _set(curves: Curves, name: str, side: int, value: ArrayLike) -> None:
    getattr(curves, name)[:, side] = value
    if name == "reach":
        curves.reach_weight[:, side] = 1.0


def _mirrored(name: str, value: ArrayLike) -> ArrayLike:
    if name in ("feet", "reach"):
        return np.asarray(value, np.float64) * [-1.0, 1.0, 1.0]
    return -np.asarray(value, np.float64) if name in ("knee", "foot_yaw") else value


def through(frames: int, poses: Sequence[tuple[float, Array]]) -> Array:
    """Smooth movement through key poses: (F, 45) from pairs of (share of the duration, row).

    Monotone cubic between keys (Fritsch and Carlson 1980), at rest at the first, the last and where a channel turns
    back; a row given twice in a row is held.
    """
    times = np.array([time for time, _ in poses])
    rows = np.stack([row for _, row in poses])
    width = np.maximum(np.diff(times), 1e-6)[:, None]
    slope = np.diff(rows, axis=0) / width
    tangent = np.zeros_like(rows)
    before, after = slope[:-1], slope[1:]
    same = before * after > 0
    total = np.where(same, before + after, 1.0)
    tangent[1:-1] = np.where(same, 2.0 * before * after / total, 0.0)
    now = np.linspace(0.0, 1.0, frames)
    index = np.clip(np.searchsorted(times, now, side="right") - 1, 0, len(times) - 2)
    share = np.clip((now - times[index])[:, None] / width[index], 0.0, 1.0)
    square, cube = share**2, share**3
    start, end = rows[index], rows[index + 1]
    out = start + (3 * square - 2 * cube) * (end - start)
    out += width[index] * ((cube - 2 * square + share) * tangent[index] + (cube - square) * tangent[index + 1])
    return np.asarray(out)


def perform(frames: int, poses: Sequence[tuple[float, Array]], parts: frozenset[str] = BODY) -> Curves:
    """Curves that go through key poses."""
    return Curves(through(frames, poses), [(0, frames)], parts)


STANDING = pose()
__all__ = ["ANKLE", "HANGING", "HIP", "STAND", "STANDING", "perform", "pose", "through"]
