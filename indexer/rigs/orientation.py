"""Which way is up, and whether the body is seen in a mirror."""

from __future__ import annotations

import numpy as np

from encoders.geometry import Array, unit
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import SIDES
from indexer.rigs.rest_pose import standing_axes

#: Rotations that bring +x, +y, +z, -x, -y, -z to +Y.
_TO_Y = (
    np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]),
    np.eye(3),
    np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    np.diag([1.0, -1, -1]),
    np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
)
_AXES = np.vstack([np.eye(3), -np.eye(3)])
#: What a file's axis is believed to be before looking: BVH says +Y, many programs write +Z.
_HABIT = np.array([0.0, 0.15, 0.1, 0.0, 0.0, 0.0])
_CLEAR = 0.4  # mean cosine that decides
_FLOOR = 0.2  # leg lengths within which the lowest point lies where there is a floor at height 0


def orientation(landmarks: Landmarks, rest: Landmarks) -> Array:
    """The matrix (3, 3) that brings landmarks to Y up and right-handed: a rotation, mirrored where needed."""
    turn = _TO_Y[_up(landmarks, rest)]
    return np.diag([-1.0, 1, 1]) @ turn if is_mirrored(landmarks, rest) else turn


def _up(landmarks: Landmarks, rest: Landmarks) -> int:
    """Which of +x, +y, +z, -x, -y, -z is up: where heads are over hips, and hips over feet, most of the time.

    Someone may lie all the time: then the rest pose decides, if by it the body lies on a floor at height 0.
    """
    trunk = unit(landmarks.marks["head"] - landmarks.middle("hip"))
    legs = unit(landmarks.middle("hip") - landmarks.middle("ankle"))
    upright = _AXES @ (trunk + legs).mean(axis=0) / 2
    best = int(np.argmax(upright + _HABIT))
    standing = standing_axes(rest)
    if standing is None:
        return best
    at_rest = int(np.argmax(_AXES @ standing[:, 1]))
    if upright[best] < _CLEAR:
        return at_rest
    lies = _has_floor(landmarks, _AXES[at_rest]) and not _has_floor(landmarks, _AXES[best])
    return at_rest if lies else best


def _has_floor(landmarks: Landmarks, up: Array) -> bool:
    """Is the lowest point of the body at height 0, usually?"""
    lowest = (landmarks.points() @ up).min(axis=-1)
    return bool(abs(np.median(lowest)) < _FLOOR * landmarks.leg_length())


def is_mirrored(landmarks: Landmarks, rest: Landmarks) -> bool:
    """Do feet and knees point backwards, if what is called left is on the left?

    Such a file was written with axes of the other hand.
    """
    feet, knees = _ahead(landmarks)
    if standing_axes(rest) is not None:
        feet = (feet + _ahead(rest)[0]) / 2
    return feet < -_CLEAR and knees < 0 if "left_toe" in landmarks.marks else knees < -0.1


def _ahead(landmarks: Landmarks) -> tuple[float, float]:
    """How far, on average, feet point forward (cosine) and knees stand forward of the leg (in leg lengths)."""
    forward = unit(np.cross(landmarks.across("hip"), landmarks.marks["head"] - landmarks.middle("hip")))
    feet, knees = [], []
    for side in SIDES:
        middle = (landmarks.marks[f"{side}_hip"] + landmarks.marks[f"{side}_ankle"]) / 2
        knees.append(((landmarks.marks[f"{side}_knee"] - middle) * forward).sum(-1).mean() / landmarks.leg_length())
        if f"{side}_toe" in landmarks.marks:
            feet.append((unit(landmarks.bone(f"{side}_ankle", f"{side}_toe")) * forward).sum(-1).mean())
    return float(np.mean(feet)) if feet else 0.0, float(np.mean(knees))
