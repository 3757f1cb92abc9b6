"""Features become a motion again: what a generator decodes, as joints."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from encoders.errors import ArgumentError
from encoders.features import canonical, humanml3d
from encoders.geometry import cross, unit
from encoders.motion import FPS, Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS, PARENTS

Array = NDArray[np.float64]

_POINTS = {name: i for i, name in enumerate(canonical.POINTS)}
#: Share of the line from the middle of the hips to the middle of the shoulders at which joints of the trunk lie.
_TRUNK = {"pelvis": 0.06, "spine1": 0.27, "spine2": 0.54, "spine3": 0.67, "neck": 1.04}
_COLLAR = 0.88, 0.35  # the same of collars, and their share of the way to the shoulders
_SIDES = (("left", 1.0), ("right", -1.0))
#: Contact from which a sole surely stands.
_STANDS = 0.6


def recovered_motion(kind: str, features: NDArray[np.floating]) -> Motion:
    """The motion (at 20 frames a second, from the origin, facing +Z) of features (T', F) of a kind.

    Raises
    ------
    ArgumentError
        If features of this kind do not tell where joints are.
    """
    if kind not in _RECOVERIES:
        raise ArgumentError(f"features of kind {kind!r} cannot be turned into joints; {', '.join(_RECOVERIES)} can")
    joints = _RECOVERIES[kind](np.asarray(features, np.float64))
    joints[..., 1] -= joints[..., 1].min()
    return Motion(joints.astype(np.float32), FPS)


def body_joints(features: Array) -> Array:
    """Joints (2 T - 1, 22, 3) at 20 frames a second of `body` features (T, 96) at 10.

    The inverse of `encoders.features.canonical.body_features` as far as there is one: the trunk is straight, and bones
    have the target lengths. Where soles stand, the body moves so that they stay where they are: decoded velocities and
    poses do not agree to the centimetre.
    """
    rows = upsampled(features)
    layout = canonical.LAYOUT
    points = rows[:, layout["positions"]].reshape(len(rows), -1, 3)
    up, forward = (unit(rows[:, layout[name]]) for name in ("trunk_up", "pelvis_forward"))
    pose = with_bone_lengths(_pose(points, up, unit(cross(up, forward))))
    angles = _sum(rows[:, layout["yaw_rate"].start])
    turned = _turn(pose, angles)
    velocity = _turn(rows[:, None, layout["root_velocity"]], angles)[:, 0]
    root = np.zeros((len(rows), 3))
    root[:, ::2] = _sum(_grounded(velocity[:, ::2], turned, rows[:, layout["contacts"]]))
    root[:, 1] = rows[:, layout["height"].start]
    return turned + root[:, None]


def upsampled(rows: Array) -> Array:
    """Rows (T, F) with one between each two, by Catmull-Rom splines: (2 T - 1, F)."""
    padded = np.concatenate([rows[:1], rows, rows[-1:]])
    between = (9 * (padded[1:-2] + padded[2:-1]) - (padded[:-3] + padded[3:])) / 16
    out = np.empty((2 * len(rows) - 1, rows.shape[1]))
    out[::2], out[1::2] = rows, between
    return out


def with_bone_lengths(joints: Array) -> Array:
    """Joints (T, 22, 3) with the directions of their bones and the target lengths, about the root."""
    out = np.zeros_like(joints)
    for joint, parent in enumerate(PARENTS[1:], start=1):
        out[:, joint] = out[:, parent] + unit(joints[:, joint] - joints[:, parent]) * BONE_LENGTHS[joint]
    return out + joints[:, :1]


def _pose(points: Array, up: Array, across: Array) -> Array:
    """All joints (T, 22, 3) around the middle of the hips, from the points of the canonical body."""
    joints = np.zeros((len(points), len(JOINTS), 3))
    shoulders = (points[:, _POINTS["left_shoulder"]] + points[:, _POINTS["right_shoulder"]]) / 2
    for name, share in _TRUNK.items():
        joints[:, INDEX[name]] = share * shoulders
    for name, place in _POINTS.items():
        joints[:, INDEX[name]] = points[:, place]
    for side, sign in _SIDES:
        joints[:, INDEX[f"{side}_hip"]] = sign * canonical.HIP * across
        outward = joints[:, INDEX[f"{side}_shoulder"]] - shoulders
        joints[:, INDEX[f"{side}_collar"]] = _COLLAR[0] * shoulders + _COLLAR[1] * outward
    return joints


def _grounded(velocity: Array, turned: Array, contacts: Array) -> Array:
    """Velocity (T, 2) of the root on the floor, of joints (T, 22, 3) about it: against that of soles which stand."""
    soles = turned[:, [INDEX[name] for name in canonical.SOLES]][..., ::2]
    moving = np.gradient(soles, 1 / FPS, axis=0) if len(soles) > 1 else np.zeros_like(soles)
    weight = np.clip((contacts - _STANDS) / (1 - _STANDS), 0, 1)
    total = weight.sum(axis=1, keepdims=True)
    standing = -(weight[..., None] * moving).sum(axis=1) / np.maximum(total, 1e-6)
    share = np.minimum(total, 1)
    grounded: Array = share * standing + (1 - share) * velocity
    return grounded


def _sum(rates: Array) -> Array:
    """Integral over time of rates a second (T, ...), zero in the first frame; trapezoids."""
    steps = (rates[1:] + rates[:-1]) / (2 * FPS)
    return np.concatenate([np.zeros_like(rates[:1]), np.cumsum(steps, axis=0)])


def _turn(vectors: Array, angles: Array) -> Array:
    """Vectors (T, P, 3) turned about Y by angles (T,), from +Z towards +X."""
    cosine, sine = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, z = vectors[..., 0], vectors[..., 2]
    return np.stack([cosine * x + sine * z, vectors[..., 1], cosine * z - sine * x], axis=-1)


def _humanml3d_joints(features: Array) -> Array:
    return humanml3d.features_to_joints(features).astype(np.float64)


_RECOVERIES: dict[str, Callable[[Array], Array]] = {"body": body_joints, "humanml3d": _humanml3d_joints}
