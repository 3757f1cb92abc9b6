"""What a rig's rest pose says about its own build, so that it can be told from movement.

A person who stands in a T-pose stands so in every rig; but one rig draws the elbows bent by 17 degrees, the
feet flat or pointed, the neck upright or forward. Where the rest pose shows a standing body, its difference
from the target skeleton's standing body is a constant of the rig and is taken off every frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from indexer.figure import Figure
from indexer.geometry import Array, angle_between, frames, rotation_between, unit
from indexer.mapping import SIDES

#: From neck to head, and from ankle to the ball of the foot, in a standing body facing +Z (means over KIT-ML).
HEAD = np.array([0.0, 0.075, 0.0625])
FOOT = np.array([0.0, -0.055, 0.115])
#: From neck to left shoulder.
SHOULDER = np.array([0.193, -0.115, -0.01])

#: Degrees by which a standing rest pose may deviate.
_UPRIGHT, _MAX_BEND = 25.0, 30.0


@dataclass(frozen=True)
class Calibration:
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


def trunk_frames(figure: Figure) -> tuple[Array, Array]:
    """Frames (T, 3, 3) of pelvis and chest: left, up, forward."""
    hips, neck = figure.middle("hip"), figure.marks["neck"]
    waist = _waist(np.concatenate([hips[:, None], figure.spine, neck[:, None]], axis=1))
    return frames(figure.across("hip"), waist - hips), frames(figure.across("shoulder"), neck - waist)


def _waist(back: Array) -> Array:
    """The point (T, 3) half way along a line (T, S, 3); its typical lengths serve all frames."""
    steps = np.median(np.linalg.norm(np.diff(back, axis=1), axis=-1), axis=0)
    knots = np.concatenate([[0.0], np.cumsum(steps)])
    half = knots[-1] / 2
    at = int(np.clip(np.searchsorted(knots, half, side="right") - 1, 0, len(steps) - 1))
    weight = (half - knots[at]) / max(float(steps[at]), 1e-9)
    point: Array = back[:, at] * (1 - weight) + back[:, at + 1] * weight
    return point


def foot_frames(figure: Figure, side: str) -> Array:
    """Frames (T, 3, 3) at an ankle: left, up the shank, forward."""
    return frames(figure.across("hip"), figure.bone(f"{side}_ankle", f"{side}_knee"))


def calibrate(figure: Figure, rest: Figure) -> Calibration:
    """The constants of a rig from its rest pose (T = 1); where that shows no standing body, the neutral ones."""
    standing = standing_axes(rest)
    if standing is None:
        _, high = trunk_frames(figure)
        return Calibration(shoulders=_shoulders(high.swapaxes(-1, -2) @ _from_neck(figure)))
    body = rest.transformed(standing.T)
    low, high = (frame[0] for frame in trunk_frames(body))
    head = rotation_between(body.bone("neck", "head")[0] * [0, 1, 1], HEAD)
    feet = {}
    for side in SIDES:
        feet[side] = np.eye(3)
        if f"{side}_toe" in body.marks:
            local = foot_frames(body, side)[0].T @ body.bone(f"{side}_ankle", f"{side}_toe")[0]
            feet[side] = rotation_between(local * [0, 1, 1], FOOT)
    bends = {}
    for side in SIDES:
        for upper, bend, lower in (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")):
            bones = body.bone(f"{side}_{upper}", f"{side}_{bend}"), body.bone(f"{side}_{bend}", f"{side}_{lower}")
            angle = float(angle_between(*bones)[0])
            bends[f"{side}_{bend}"] = angle if angle < _MAX_BEND else 0.0
    return Calibration(low, high, head, feet, bends, _shoulders(_from_neck(body)))


def _from_neck(figure: Figure) -> Array:
    """Columns (T, 3, 2): the left and the right shoulder from the neck."""
    return np.stack([figure.bone("neck", f"{side}_shoulder") for side in SIDES], axis=-1)


def _shoulders(from_neck: Array) -> Array:
    """The usual place (3,) of the left shoulder from the neck, out of tracks (T, 3, 2) in the chest's frame."""
    left, right = np.median(from_neck, axis=0).T
    place: Array = (left + right * [-1, 1, 1]) / 2
    place[0] = max(place[0], 1e-6)
    return place


def standing_axes(rest: Figure) -> Array | None:
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
