"""Landmarks of any figure become the 22 joints, with the target skeleton's bone lengths.

Rigs agree on where hips, knees, ankles, shoulders, elbows and wrists are; they differ in where they put the
pelvis, the vertebrae and the collar bones. So only the former are taken as they are. The trunk is rebuilt on
them: frames of pelvis and chest from hips, shoulders and neck, and in these the offsets of the target skeleton.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS, PARENTS

Array = NDArray[np.float64]

#: Directions of the trunk's bones in an upright body facing +Z (rounded means over HumanML3D and KIT-ML).
_UPRIGHT = {
    "left_hip": (0.058, -0.083, -0.008),
    "right_hip": (-0.058, -0.083, -0.008),
    "spine1": (0.0, 0.122, -0.034),
    "spine2": (0.0, 0.130, 0.034),
    "spine3": (0.0, 0.050, 0.019),
    "neck": (0.0, 0.209, 0.0),
    "left_collar": (0.073, 0.112, -0.006),
    "right_collar": (-0.073, 0.112, -0.006),
}
#: From ankle to the ball of the foot where a rig has no toes, in a frame of the shank.
_FOOT = (0.0, -0.055, 0.115)


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, 1e-9)


def offset(joint: str) -> Array:
    """The bone that ends at a trunk joint, in an upright body facing +Z, in metres."""
    return _unit(np.array(_UPRIGHT[joint])) * float(BONE_LENGTHS[INDEX[joint]])


def frames(across: Array, up: Array) -> Array:
    """Rotations (..., 3, 3) whose columns are left, up and forward.

    `across` points left and is kept; `up` is kept as far as it is square to it.
    """
    x = _unit(across)
    y = _unit(up - x * (x * up).sum(-1, keepdims=True))
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def build(marks: dict[str, Array], spine: Array, scale: float) -> Array:
    """Joints (T, 22, 3) in metres out of landmarks (T, 3) of a right-handed figure with Y up.

    Parameters
    ----------
    marks : dict
        Hips, knees, ankles, shoulders, elbows, wrists, neck and head; toes where there are any.
    spine : array (T, S, 3)
        Points along the back between hips and neck, upwards; S may be 0.
    scale : float
        Metres in a unit of the landmarks.
    """
    marks = {name: place * scale for name, place in marks.items()}
    curve = _back(marks, spine * scale)
    hips = marks["left_hip"] - marks["right_hip"]
    shoulders = marks["left_shoulder"] - marks["right_shoulder"]
    waist = _along(curve, np.array([0.5]))[:, 0]
    low = frames(hips, waist - curve[:, 0])
    high = frames(shoulders, curve[:, -1] - waist)

    joints = np.zeros((len(curve), len(JOINTS), 3))

    def put(joint: str, direction: Array) -> None:
        at = INDEX[joint]
        joints[:, at] = joints[:, PARENTS[at]] + _unit(direction) * BONE_LENGTHS[at]

    middle = (offset("left_hip") + offset("right_hip")) / 2
    joints[:, 0] = curve[:, 0] - low @ middle
    for joint, share in (("spine1", 0.0), ("spine2", 0.4), ("spine3", 0.8), ("neck", 1.0)):
        put(joint, _between(low, high, share) @ offset(joint))
    put("head", marks["head"] - marks["neck"])
    neck = joints[:, INDEX["neck"]]
    for side in ("left", "right"):
        put(f"{side}_hip", low @ offset(f"{side}_hip"))
        put(f"{side}_collar", high @ offset(f"{side}_collar"))
        shoulder = neck + marks[f"{side}_shoulder"] - marks["neck"]
        put(f"{side}_shoulder", shoulder - joints[:, INDEX[f"{side}_collar"]])
        for parent, joint in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist")):
            put(f"{side}_{joint}", marks[f"{side}_{joint}"] - marks[f"{side}_{parent}"])
        put(f"{side}_foot", _foot(marks, side, hips))
    return joints


def _back(marks: dict[str, Array], spine: Array) -> Array:
    """The line of the back (T, S + 2, 3) from between the hips to the neck."""
    start = (marks["left_hip"] + marks["right_hip"]) / 2
    end = marks["neck"]
    return np.concatenate([start[:, None], spine, end[:, None]], axis=1)


def _along(curve: Array, shares: Array) -> Array:
    """Points (T, len(shares), 3) at shares of the length of polylines (T, S, 3); typical lengths serve all frames."""
    steps = np.median(np.linalg.norm(np.diff(curve, axis=1), axis=-1), axis=0)
    knots = np.concatenate([[0.0], np.cumsum(steps)])
    knots /= max(knots[-1], 1e-9)
    at = np.clip(np.searchsorted(knots, shares, side="right") - 1, 0, len(steps) - 1)
    weight = (shares - knots[at]) / np.maximum(knots[at + 1] - knots[at], 1e-9)
    return curve[:, at] * (1 - weight)[:, None] + curve[:, at + 1] * weight[:, None]


def _between(low: Array, high: Array, share: float) -> Array:
    """Rotations a share of the way from one to another, by blending their axes."""
    blend = low * (1 - share) + high * share
    return frames(blend[..., 0], blend[..., 1])


def _foot(marks: dict[str, Array], side: str, hips: Array) -> Array:
    """Direction from the ankle to the ball of the foot."""
    toe = marks.get(f"{side}_toe")
    if toe is not None:
        return toe - marks[f"{side}_ankle"]
    shank = frames(hips, marks[f"{side}_knee"] - marks[f"{side}_ankle"])
    return shank @ np.array(_FOOT)
