"""Shapes: a vector of a whole motion by which copies of one performance are told from motions that are merely alike.

Joints are taken relative to the pelvis with the heading removed, at instants evenly spread over the motion. Each
coordinate is a signal over these instants; without its mean and nearly without its spread, what is left is the course
of the movement. Rigs change how a body is built, and with it mean and spread, but hardly this course.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import interpolate
from encoders.skeleton import INDEX

Vectors = NDArray[np.float32]

_PAIRS = ("shoulder", "elbow", "wrist", "knee", "ankle")
_JOINTS = [INDEX[f"{side}_{joint}"] for joint in _PAIRS for side in ("left", "right")]
_JOINTS += [INDEX["head"], INDEX["spine3"]]
_INSTANTS = 16
#: Numbers of a shape.
SIZE = _INSTANTS * len(_JOINTS) * 3

#: The power of its spread by which a signal is divided: 0 lets large movements decide, 1 weighs all alike.
_WHITENED = 0.9
#: Metres that are added to each spread, that of numbers rounded to millimetres.
_NOISE = 0.001
#: Steps of the way over the floor, in frames: jitter of single frames is no way.
_STRIDE = 4


class Shape(NamedTuple):
    """A motion's shape, its duration in seconds, and the way of the pelvis over the floor in metres."""

    vector: Vectors
    duration: float
    way: float


def shape_of(joints: NDArray[np.float32], duration: float) -> Shape:
    """The shape of a motion of joints (T, 22, 3); its vector (SIZE,) has length 1, or 0 where nothing moves."""
    local = _local(interpolate(joints.astype(np.float64), np.linspace(0, len(joints) - 1, _INSTANTS)))
    signals = local[:, _JOINTS].reshape(_INSTANTS, -1)
    signals = signals - signals.mean(axis=0)
    spread = np.sqrt((signals**2).mean(axis=0) + _NOISE**2)
    vector = (signals / spread**_WHITENED).ravel()
    length = np.linalg.norm(vector)
    way = np.linalg.norm(np.diff(joints[::_STRIDE, 0][:, [0, 2]], axis=0), axis=1).sum()
    return Shape((vector / length if length else vector).astype(np.float32), duration, float(way))


def mirrored(vectors: Vectors) -> Vectors:
    """The shapes (N, SIZE) of the mirrored motions."""
    return vectors[:, _MIRRORED] * _SIGNS


def _mirroring() -> tuple[NDArray[np.int64], Vectors]:
    """Where each number of a mirrored shape comes from, and its sign: sides are swapped, x is negated."""
    sides = np.arange(2 * len(_PAIRS)).reshape(-1, 2)[:, ::-1].ravel()
    joints = np.concatenate([sides, np.arange(len(sides), len(_JOINTS))])
    order = np.arange(SIZE).reshape(_INSTANTS, len(_JOINTS), 3)[:, joints]
    return order.ravel(), np.tile(np.array([-1, 1, 1], np.float32), SIZE // 3)


_MIRRORED, _SIGNS = _mirroring()


def _local(joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Joints (T, 22, 3) relative to the pelvis, turned so that the left of hips and shoulders points along x."""
    left, right = (joints[:, [INDEX[f"{side}_hip"], INDEX[f"{side}_shoulder"]]] for side in ("left", "right"))
    across = (left - right).sum(axis=1)
    flat = across[:, [0, 2]] / np.maximum(np.linalg.norm(across[:, [0, 2]], axis=1, keepdims=True), 1e-6)
    x, z = flat[:, :1], flat[:, 1:]
    relative = joints - joints[:, :1]
    along = relative[..., 0] * x + relative[..., 2] * z
    ahead = relative[..., 2] * x - relative[..., 0] * z
    return np.stack([along, relative[..., 1], ahead], axis=-1)
