"""Which way is up, and whether the body is seen in a mirror."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from encoders.geometry import Array, unit
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
_AXES = np.vstack([np.eye(3), -np.eye(3)])  # in the order of UP_AXES
#: What a file's axis is believed to be before looking: BVH says +Y, many programs write +Z.
_HABIT = np.array([0.0, 0.15, 0.1, 0.0, 0.0, 0.0])
_CLEAR = 0.4  # mean cosine that decides
_SUNK, _FLOOR = -0.1, 0.25  # leg lengths between which the lowest point stays where there is a floor at height 0


class Up(NamedTuple):
    """The axis of a file that is up, one of `UP_AXES`, and the reason to think so."""

    axis: str
    reason: str


def orientation(up: str, landmarks: Landmarks, rest: Landmarks) -> Array:
    """The matrix (3, 3) that brings landmarks to Y up and right-handed: a rotation, mirrored where needed.

    `up` is the axis that is up, one of `UP_AXES`.
    """
    turn = _TO_Y[up]
    return np.diag([-1.0, 1, 1]) @ turn if is_mirrored(landmarks, rest) else turn


def up_axis(landmarks: Landmarks, rest: Landmarks, stated: str | None = None, *, is_certain: bool = False) -> Up:
    """Which way is up in a file.

    What is expected before looking is the axis that the file states, else that along which its rest pose stands, else
    +Y. It is up where the movement has a floor at height 0 along it; elsewhere heads are over hips and hips over feet
    most of the time.

    Parameters
    ----------
    landmarks : Landmarks
        The movement.
    rest : Landmarks
        The rest pose, T = 1.
    stated : str, optional
        The axis that the file states.
    is_certain : bool
        That axis is up whatever the movement looks like.
    """
    if stated is not None and is_certain:
        return Up(stated, "by definition")
    standing = standing_axes(rest)
    at_rest = None if standing is None else UP_AXES[int(np.argmax(_AXES @ standing[:, 1]))]
    expected = stated or at_rest or "y"
    trunk = unit(landmarks.marks["head"] - landmarks.middle("hip"))
    legs = unit(landmarks.middle("hip") - landmarks.middle("ankle"))
    upright = _AXES @ (trunk + legs).mean(axis=0) / 2
    best = UP_AXES[int(np.argmax(upright + _HABIT))]
    floor, floor_of_best = _floor(landmarks, expected), _floor(landmarks, best)
    if floor == "level" or (floor == "near" and not floor_of_best):
        return Up(expected, "it has a floor at height 0")
    if (stated or at_rest) and upright.max() < _CLEAR:
        return Up(expected, "the file says so" if stated else "the rest pose stands")
    return Up(best, "posture")


def _floor(landmarks: Landmarks, axis: str) -> str:
    """Whether the lowest point of the body is near height 0 usually ("near") or nearly always ("level"); else ""."""
    lowest = (landmarks.points() @ _AXES[UP_AXES.index(axis)]).min(axis=-1) / landmarks.leg_length()
    low, middle, high = np.quantile(lowest, (0.05, 0.5, 0.95))
    if not _SUNK < middle < _FLOOR:
        return ""
    return "level" if high - low < _FLOOR else "near"


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
