"""RIFKE, the joint features of TEMOS (Petrovich, Black, Varol, ECCV 2022): joints in the body's own frame.

The frame's origin is the root on the floor; it has axes forward, up and left. Forward is level and square to the mean
of the line across the hips and the line across the shoulders. How the frame turns and moves is kept as differences from
one feature frame to the next, so that nothing says where on the floor a motion is or which way it faces.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.geometry import unit
from encoders.motion import Motion
from encoders.skeleton import INDEX, JOINTS

Array = NDArray[np.float64]

#: Feature frames a second, as TEMOS has them.
FPS = 12.5
_JOINTS = len(JOINTS) - 1
SIZE = 1 + 3 * _JOINTS + 1 + 2
#: Where each group of numbers lies: the root's height, the other joints (forward, up, left of the frame's origin), the
#: turn since the frame before (radians, left is positive), the root's way since then (forward, left); metres.
LAYOUT = {
    "height": slice(0, 1),
    "joints": slice(1, 1 + 3 * _JOINTS),
    "turn": slice(1 + 3 * _JOINTS, 2 + 3 * _JOINTS),
    "way": slice(2 + 3 * _JOINTS, SIZE),
}
_LEFT = [INDEX["left_hip"], INDEX["left_shoulder"]]
_RIGHT = [INDEX["right_hip"], INDEX["right_shoulder"]]
#: Metres across the body below which it has no heading: it lies on its side, and keeps the heading it had.
_LEVEL = 1e-6


def joints_to_rifke(joints: ArrayLike) -> NDArray[np.float32]:
    """Joints (..., T, 22, 3) in metres, Y up -> features (..., T, 67); heights are above the motion's lowest point."""
    points = np.array(joints, np.float64)
    points[..., 1] -= points[..., 1].min(axis=(-2, -1), keepdims=True)
    forward = _forward(points)
    root = points[..., 0, :]
    heading = np.arctan2(forward[..., 0], forward[..., 1])
    turn = _since_before(heading[..., None])
    features = np.concatenate(
        [
            root[..., 1:2],
            _into_frame(points[..., 1:, :] - root[..., None, :] * [1, 0, 1], forward[..., None, :]).reshape(
                *points.shape[:-2], -1
            ),
            (turn + np.pi) % (2 * np.pi) - np.pi,
            _into_frame(_since_before(root * [1, 0, 1]), forward)[..., [0, 2]],
        ],
        axis=-1,
    )
    return features.astype(np.float32)


def rifke_to_joints(features: ArrayLike) -> NDArray[np.float32]:
    """Features (..., T, 67) -> joints (..., T, 22, 3), of which the first frame is above the origin and faces +Z."""
    values = np.asarray(features, np.float64)
    turn = values[..., LAYOUT["turn"]][..., 0].copy()
    way = values[..., LAYOUT["way"]].copy()
    turn[..., 0], way[..., 0, :] = 0, 0
    heading = np.cumsum(turn, axis=-1)
    forward = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    level = np.stack([way[..., 0], np.zeros_like(heading), way[..., 1]], axis=-1)
    root = np.cumsum(_out_of_frame(level, forward), axis=-2)
    local = values[..., LAYOUT["joints"]].reshape(*values.shape[:-1], _JOINTS, 3)
    others = _out_of_frame(local, forward[..., None, :]) + root[..., None, :]
    root[..., 1] = values[..., 0]
    return np.concatenate([root[..., None, :], others], axis=-2).astype(np.float32)


def of_motion(motion: Motion) -> NDArray[np.float32]:
    """The features (T', 67) of a motion at any rate."""
    return joints_to_rifke(motion.resample(FPS).joints)


def _forward(joints: Array) -> Array:
    """Where the body faces, level unit vectors (..., T, 2) of x and z."""
    left = (joints[..., _LEFT, :] - joints[..., _RIGHT, :]).mean(axis=-2)[..., [0, 2]]
    known = (left**2).sum(-1) > _LEVEL**2
    frames = np.where(known, np.arange(known.shape[-1]), -1)
    held = np.maximum.accumulate(frames, axis=-1)
    first = np.where(known.any(axis=-1), known.argmax(axis=-1), 0)[..., None]
    left = np.take_along_axis(left, np.where(held < 0, first, held)[..., None], axis=-2)
    forward = unit(np.stack([-left[..., 1], left[..., 0]], axis=-1), _LEVEL)
    return np.where(known.any(axis=-1)[..., None, None], forward, [0.0, 1.0])


def _into_frame(vectors: Array, forward: Array) -> Array:
    """Vectors (..., 3) as forward, up, left parts."""
    x, y, z = (vectors[..., i] for i in range(3))
    ahead_x, ahead_z = forward[..., 0], forward[..., 1]
    return np.stack([x * ahead_x + z * ahead_z, y, x * ahead_z - z * ahead_x], axis=-1)


def _out_of_frame(parts: Array, forward: Array) -> Array:
    """Inverse of `_into_frame`."""
    ahead, up, left = (parts[..., i] for i in range(3))
    ahead_x, ahead_z = forward[..., 0], forward[..., 1]
    return np.stack([ahead * ahead_x + left * ahead_z, up, ahead * ahead_z - left * ahead_x], axis=-1)


def _since_before(track: Array) -> Array:
    """Differences (..., T, N) from the frame before; zero in the first frame."""
    return np.diff(track, axis=-2, prepend=track[..., :1, :])
