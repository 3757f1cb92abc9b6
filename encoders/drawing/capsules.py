"""The body that is drawn: tapered capsules on the 22 joints, and where a camera looks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.skeleton import INDEX

#: Radians from where a person faces to where the viewer stands: seen from the front, a third to the side.
VIEW = 0.6
#: Colours of the parts on a light page.
TINTS = {"body": (106, 99, 90), "left": (221, 90, 34), "right": (156, 147, 135)}
#: Seconds over which the camera's aim is averaged, so that it follows without shaking.
_FOLLOW = 1.2


class Capsule(NamedTuple):
    """A limb from joint `start` to joint `end`, radii in metres at either end; `part` is body, left or right.

    With `beyond`, the limb begins at `start` and extends `beyond` metres in the direction from `end` to `start`: heads,
    hands and toes have no joint at their tip.
    """

    start: int
    end: int
    near: float
    far: float
    part: str
    beyond: float = 0.0


#: search/page/figure.js draws the same table; a test holds the two together.
CAPSULES = (
    Capsule(0, 3, 0.112, 0.108, "body"), Capsule(3, 6, 0.108, 0.118, "body"), Capsule(6, 9, 0.118, 0.122, "body"),
    Capsule(9, 12, 0.085, 0.052, "body"), Capsule(12, 15, 0.05, 0.052, "body"),
    Capsule(15, 12, 0.088, 0.096, "body", 0.1), Capsule(16, 17, 0.062, 0.062, "body"),
    Capsule(1, 2, 0.1, 0.1, "body"), Capsule(6, 16, 0.1, 0.06, "body"), Capsule(6, 17, 0.1, 0.06, "body"),
    Capsule(3, 1, 0.1, 0.098, "body"), Capsule(3, 2, 0.1, 0.098, "body"),
    Capsule(1, 4, 0.086, 0.058, "left"), Capsule(4, 7, 0.057, 0.04, "left"), Capsule(7, 10, 0.04, 0.034, "left"),
    Capsule(10, 7, 0.034, 0.027, "left", 0.05),
    Capsule(2, 5, 0.086, 0.058, "right"), Capsule(5, 8, 0.057, 0.04, "right"), Capsule(8, 11, 0.04, 0.034, "right"),
    Capsule(11, 8, 0.034, 0.027, "right", 0.05),
    Capsule(16, 18, 0.052, 0.041, "left"), Capsule(18, 20, 0.041, 0.031, "left"),
    Capsule(20, 18, 0.034, 0.024, "left", 0.09),
    Capsule(17, 19, 0.052, 0.041, "right"), Capsule(19, 21, 0.041, 0.031, "right"),
    Capsule(21, 19, 0.034, 0.024, "right", 0.09),
)  # fmt: skip

_START, _END = (np.array([getattr(c, name) for c in CAPSULES]) for name in ("start", "end"))
_BEYOND = np.array([c.beyond for c in CAPSULES], np.float32)

#: Radii (C, 2) of the capsules at either end, in metres.
RADII = np.array([(c.near, c.far) for c in CAPSULES], np.float32)


def capsules(joints: NDArray[np.float32]) -> NDArray[np.float32]:
    """Both ends (..., C, 2, 3) of every capsule of poses (..., 22, 3), in metres."""
    start, end = joints[..., _START, :], joints[..., _END, :]
    back = start - end
    reach = _BEYOND / np.maximum(np.linalg.norm(back, axis=-1), 1e-6)
    tip = np.where(_BEYOND[:, None] > 0, start + reach[..., None] * back, end)
    ends: NDArray[np.float32] = np.stack([start, tip], axis=-2).astype(np.float32)
    return ends


def view_axes(yaw: float, pitch: float = 0.0) -> NDArray[np.float32]:
    """Unit vectors to the right, up and towards a viewer (3, 3), one a row.

    The viewer stands at the angle `yaw` about Y from +Z and looks down by `pitch`, in radians.
    """
    sine, cosine = np.sin(yaw), np.cos(yaw)
    towards = np.array([np.cos(pitch) * sine, np.sin(pitch), np.cos(pitch) * cosine])
    right = np.array([cosine, 0.0, -sine])
    return np.stack([right, np.cross(towards, right), towards]).astype(np.float32)


def aim(joints: NDArray[np.float32], fps: float) -> NDArray[np.float32]:
    """Where on the ground a camera looks that follows the pelvis of joints (T, 22, 3): x and z (T, 2) in metres."""
    pelvis = joints[:, 0, [0, 2]].astype(np.float64)
    frames = np.arange(len(pelvis))
    around = np.minimum(round(_FOLLOW * fps / 2), np.minimum(frames, len(pelvis) - 1 - frames))
    sums = np.concatenate([np.zeros((1, 2)), np.cumsum(pelvis, axis=0)])
    mean = (sums[frames + around + 1] - sums[frames - around]) / (2 * around + 1)[:, None]
    return np.asarray(mean, np.float32)


def heading(joints: NDArray[np.float32]) -> float:
    """The way the hips of joints (T, 22, 3) mostly face, as an angle about Y from +Z, in radians."""
    across = (joints[:, INDEX["left_hip"]] - joints[:, INDEX["right_hip"]]).sum(axis=0)
    return float(np.arctan2(-across[2], across[0]))


def reach(joints: NDArray[np.float32], fps: float) -> tuple[float, float]:
    """How far any of the joints (T, 22, 3) goes from where the camera aims, sideways and up, in metres."""
    aside = joints[:, :, [0, 2]] - aim(joints, fps)[:, None]
    return float(np.linalg.norm(aside, axis=-1).max()), float(joints[..., 1].max())
