"""What a rig's rest pose shows of its own build, so that it can be separated from movement.

A person who stands in a T-pose stands so in every rig; but one rig draws the elbows bent by 17 degrees, the
feet flat or pointed, the neck upright or forward. Where the rest pose shows a standing body, its difference
from the target skeleton's standing body is a constant of the rig and is taken off every frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from encoders.geometry import Array, angle_between, frames, rotation_between, unit
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import SIDES

#: From neck to head, and from ankle to the ball of the foot, in a standing body facing +Z (means over KIT-ML).
HEAD = np.array([0.0, 0.075, 0.0625])
FOOT = np.array([0.0, -0.055, 0.115])
#: From neck to left shoulder.
SHOULDER = np.array([0.193, -0.115, -0.01])

#: Degrees by which a standing rest pose may deviate.
_UPRIGHT, _MAX_BEND = 25.0, 30.0
_SAGITTAL = np.array([0.0, 1.0, 1.0])  # only how far a bone leans forward is the rig's; to the sides it is posed
_DOWN = 0.15  # share of frames in which a foot surely stands on the floor
_MAX_TILT = 0.7  # radians by which a foot is tilted at most
_NARROW = 0.1  # leg lengths that shoulders are at least away from the neck


@dataclass(frozen=True)
class RestPoseCorrection:
    """Constant rotations (3, 3) of a rig, and its bends in degrees, at rest.

    `low` and `high` are what the pelvis' and the chest's frames are in a standing body; `head` and `feet` turn
    bones, in the frames of chest and shank; `bends` are taken off knees and elbows; `shoulders` is the usual place
    of the left shoulder from the neck, in the chest's frame and the file's units.
    """

    low: Array = field(default_factory=lambda: np.eye(3))
    high: Array = field(default_factory=lambda: np.eye(3))
    head: Array = field(default_factory=lambda: rotation_between(np.array([0.0, 1.0, 0.0]), HEAD))
    feet: dict[str, Array] = field(default_factory=lambda: {side: np.eye(3) for side in SIDES})
    bends: dict[str, float] = field(
        default_factory=lambda: {f"{side}_{joint}": 0.0 for side in SIDES for joint in ("knee", "elbow")}
    )
    shoulders: Array = field(default_factory=lambda: SHOULDER)

    def shoulder(self, side: str, from_neck: Array) -> Array:
        """Where a shoulder is from the neck (T, 3), on the target skeleton, in the chest's frame, in metres."""
        mirror = np.array([1.0 if side == "left" else -1.0, 1.0, 1.0])
        width = SHOULDER[0] / self.shoulders[0]
        place: Array = (SHOULDER + (from_neck * mirror - self.shoulders) * width) * mirror
        return place


def trunk_frames(landmarks: Landmarks) -> tuple[Array, Array]:
    """Frames (T, 3, 3) of pelvis and chest: left, up, forward."""
    hips, neck = landmarks.middle("hip"), landmarks.marks["neck"]
    waist = _waist(np.concatenate([hips[:, None], landmarks.spine, neck[:, None]], axis=1))
    return frames(landmarks.across("hip"), waist - hips), frames(landmarks.across("shoulder"), neck - waist)


def _waist(back: Array) -> Array:
    """The point (T, 3) half way along a line (T, S, 3); its typical lengths serve all frames."""
    steps = np.median(np.linalg.norm(np.diff(back, axis=1), axis=-1), axis=0)
    knots = np.concatenate([[0.0], np.cumsum(steps)])
    half = knots[-1] / 2
    at = int(np.clip(np.searchsorted(knots, half, side="right") - 1, 0, len(steps) - 1))
    weight = (half - knots[at]) / max(float(steps[at]), 1e-9)
    point: Array = back[:, at] * (1 - weight) + back[:, at + 1] * weight
    return point


def foot_frames(landmarks: Landmarks, side: str) -> Array:
    """Frames (T, 3, 3) at an ankle: left, up the shank, forward."""
    return frames(landmarks.across("hip"), landmarks.bone(f"{side}_ankle", f"{side}_knee"))


def rest_pose_correction(landmarks: Landmarks, rest: Landmarks) -> RestPoseCorrection:
    """The constants of a rig, from its rest pose (T = 1) where that shows a standing body, else from its movement.

    `landmarks` are right-handed with Y up, those of `rest` right-handed.
    """
    standing = standing_axes(rest)
    if standing is None or max(_knee_bends(rest)) > _MAX_BEND:  # with bent knees it is a frame of some movement
        return _from_movement(landmarks)
    return _from_rest(rest.transformed(standing.T))


def _knee_bends(rest: Landmarks) -> list[float]:
    """How far (degrees) each knee is bent in a rest pose (T = 1)."""
    legs = [(rest.bone(f"{side}_hip", f"{side}_knee"), rest.bone(f"{side}_knee", f"{side}_ankle")) for side in SIDES]
    return [float(angle_between(thigh, shank)[0]) for thigh, shank in legs]


def _from_rest(body: Landmarks) -> RestPoseCorrection:
    """The constants of a rig from a standing body (T = 1) with Y up that faces +Z."""
    low, high = (frame[0] for frame in trunk_frames(body))
    feet, bends = {}, {}
    for side in SIDES:
        feet[side] = np.eye(3)
        if f"{side}_toe" in body.marks:
            local = foot_frames(body, side)[0].T @ body.bone(f"{side}_ankle", f"{side}_toe")[0]
            feet[side] = rotation_between(local * _SAGITTAL, FOOT)
        for upper, bend, lower in (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")):
            bones = body.bone(f"{side}_{upper}", f"{side}_{bend}"), body.bone(f"{side}_{bend}", f"{side}_{lower}")
            angle = float(angle_between(*bones)[0])
            bends[f"{side}_{bend}"] = angle if angle < _MAX_BEND else 0.0
    head = rotation_between(body.bone("neck", "head")[0] * _SAGITTAL, HEAD)
    return RestPoseCorrection(low, high, head, feet, bends, _shoulders(_from_neck(body), body.leg_length))


def _from_movement(landmarks: Landmarks) -> RestPoseCorrection:
    """What movement shows without a rest pose: where the shoulders usually are, and how feet lie on the floor."""
    _, high = trunk_frames(landmarks)
    shoulders = _shoulders(high.swapaxes(-1, -2) @ _from_neck(landmarks), landmarks.leg_length)
    return RestPoseCorrection(feet={side: _planted(landmarks, side) for side in SIDES}, shoulders=shoulders)


def _planted(landmarks: Landmarks, side: str) -> Array:
    """The turn (3, 3) that lets a foot lie on the floor as the target's does, by the frames where it is lowest."""
    if f"{side}_toe" not in landmarks.marks:
        return np.eye(3)
    height = landmarks.marks[f"{side}_ankle"][:, 1]
    down = height <= np.quantile(height, _DOWN)
    foot = unit(landmarks.bone(f"{side}_ankle", f"{side}_toe"))[down]
    pitch = float(np.median(np.arcsin(np.clip(foot[:, 1], -1, 1))))
    wanted = float(np.arctan2(FOOT[1], FOOT[2]))
    turn = float(np.clip(pitch - wanted, -_MAX_TILT, _MAX_TILT))
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def _from_neck(landmarks: Landmarks) -> Array:
    """Columns (T, 3, 2): the left and the right shoulder from the neck."""
    return np.stack([landmarks.bone("neck", f"{side}_shoulder") for side in SIDES], axis=-1)


def _shoulders(from_neck: Array, leg: float) -> Array:
    """The usual place (3,) of the left shoulder from the neck, out of tracks (T, 3, 2) in the chest's frame."""
    left, right = np.median(from_neck, axis=0).T
    place: Array = (left + right * [-1, 1, 1]) / 2
    place[0] = max(place[0], _NARROW * leg)
    return place


def standing_axes(rest: Landmarks) -> Array | None:
    """Left, up and forward (3, 3) of a rest pose that stands along the file's axes; None if it does not stand."""
    trunk = (rest.marks["neck"] - rest.middle("hip"))[0]
    legs = (rest.middle("hip") - rest.middle("ankle"))[0]
    up = _nearest_axis(legs)
    across = _nearest_axis(rest.across("hip")[0])
    if up is None or across is None or abs(float(up @ across)) > 0.5:
        return None
    shoulders = rest.across("shoulder")[0]
    if angle_between(trunk, up) > _UPRIGHT or angle_between(shoulders, across) > _UPRIGHT:
        return None
    return frames(across, up)


def _nearest_axis(direction: Array) -> Array | None:
    """The axis within a few degrees of a direction."""
    direction = unit(direction)
    if not direction.any():
        return None
    at = int(np.argmax(np.abs(direction)))
    axis = np.zeros(3)
    axis[at] = np.sign(direction[at])
    return axis if angle_between(direction, axis) < _UPRIGHT / 2 else None
