"""A body is turned to Y up, and turned back where it is seen in a mirror."""

from __future__ import annotations

import numpy as np

from encoders.geometry import Array, cross, unit
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import SIDES
from indexer.rigs.rest_pose import standing_axes
from indexer.take import UP_AXES

#: Rotations that bring each of `UP_AXES` to +Y.
_TO_Y = dict(
    zip(
        UP_AXES,
        (
            np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]),
            np.eye(3),
            np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
            np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
            np.diag([1.0, -1, -1]),
            np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
        ),
        strict=True,
    )
)
_CLEAR = 0.4  # mean cosine that decides


def orientation(up: str, landmarks: Landmarks, rest: Landmarks) -> Array:
    """The matrix (3, 3) that brings landmarks to Y up and right-handed: a rotation, mirrored where needed.

    `up` is the axis that is up, one of `UP_AXES`.
    """
    turn = _TO_Y[up]
    return np.diag([-1.0, 1, 1]) @ turn if is_mirrored(landmarks, rest) else turn


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
    forward = unit(cross(landmarks.across("hip"), landmarks.marks["head"] - landmarks.middle("hip")))
    feet, knees = [], []
    for side in SIDES:
        middle = (landmarks.marks[f"{side}_hip"] + landmarks.marks[f"{side}_ankle"]) / 2
        knees.append(((landmarks.marks[f"{side}_knee"] - middle) * forward).sum(-1).mean() / landmarks.leg_length)
        if f"{side}_toe" in landmarks.marks:
            feet.append((unit(landmarks.bone(f"{side}_ankle", f"{side}_toe")) * forward).sum(-1).mean())
    return float(np.mean(feet)) if feet else 0.0, float(np.mean(knees))
