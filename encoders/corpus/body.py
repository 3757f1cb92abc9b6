"""Bodies: random but human skeleton geometry, and posing one from curves by two-bone inverse kinematics.

Everything is vectorised over frames; a geometry may be one body, or one body a frame (many clips in one call).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.curves import ANKLE, Array, Curves
from encoders.skeleton import INDEX, MIRROR

#: Offset of each joint from its parent in metres, standing, of a typical adult rig.
OFFSETS = np.array(
    [
        [0, 0, 0], [0.085, -0.07, -0.01], [-0.085, -0.07, -0.01], [0, 0.115, -0.015], [0, -0.4, 0], [0, -0.4, 0],
        [0, 0.135, 0.01], [0, -0.415, 0], [0, -0.415, 0], [0, 0.065, 0.02], [0.02, -0.065, 0.13], [-0.02, -0.065, 0.13],
        [0, 0.205, -0.03], [0.07, 0.11, -0.02], [-0.07, 0.11, -0.02], [0, 0.1, 0.045], [0.11, 0.03, -0.015],
        [-0.11, 0.03, -0.015], [0, -0.27, 0], [0, -0.27, 0], [0, -0.26, 0], [0, -0.26, 0],
    ]
)  # fmt: skip
LEG = 0.815  #: length of the canonical leg, hip to ankle

_HIPS = [INDEX["left_hip"], INDEX["right_hip"]]
_KNEES = [INDEX["left_knee"], INDEX["right_knee"]]
_ANKLES = [INDEX["left_ankle"], INDEX["right_ankle"]]
_FEET = [INDEX["left_foot"], INDEX["right_foot"]]
_COLLARS = [INDEX["left_collar"], INDEX["right_collar"]]
_SHOULDERS = [INDEX["left_shoulder"], INDEX["right_shoulder"]]
_ELBOWS = [INDEX["left_elbow"], INDEX["right_elbow"]]
_WRISTS = [INDEX["left_wrist"], INDEX["right_wrist"]]
_OUT = np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])  # own-side outward to world x


def random_geometry(rng: Generator, *, spread: float = 1.0) -> Array:
    """Offsets (22, 3) of a random body, symmetric, as rigs differ: lengths, widths, slopes and bone directions."""
    offsets = OFFSETS * np.exp(rng.normal(0.0, 0.07 * spread, (22, 1)))
    offsets *= np.exp(rng.normal(0.0, 0.05 * spread))
    offsets[1:] += rng.normal(0.0, 1.0, (21, 3)) * spread * _WOBBLE[1:]
    mirrored = offsets[MIRROR] * np.array([-1.0, 1.0, 1.0])
    return np.asarray((offsets + mirrored) / 2)


#: How far each offset strays between rigs, in metres, by axis (averaging both sides shrinks it by 0.7).
_WOBBLE = np.zeros((22, 3))
_WOBBLE[_HIPS] = [0.012, 0.05, 0.015]
_WOBBLE[[3, 6, 9]] = [0.0, 0.02, 0.018]
_WOBBLE[12] = [0.0, 0.02, 0.02]
_WOBBLE[15] = [0.0, 0.02, 0.025]
_WOBBLE[_COLLARS] = [0.035, 0.04, 0.02]
_WOBBLE[_SHOULDERS] = [0.02, 0.04, 0.025]
_WOBBLE[_FEET] = [0.012, 0.02, 0.015]


def rotation(pitch: Array, roll: Array, yaw: Array) -> Array:
    """Rotation matrices (..., 3, 3): yaw about Y after pitch (forward) about X after roll (to the left) about Z."""
    cp, sp, cr, sr, cy, sy = np.cos(pitch), np.sin(pitch), np.cos(roll), -np.sin(roll), np.cos(yaw), np.sin(yaw)
    out = np.empty((*np.shape(pitch), 3, 3))
    out[..., 0, 0] = cy * cr + sy * sp * sr
    out[..., 0, 1] = sy * sp * cr - cy * sr
    out[..., 0, 2] = sy * cp
    out[..., 1, 0] = cp * sr
    out[..., 1, 1] = cp * cr
    out[..., 1, 2] = -sp
    out[..., 2, 0] = cy * sp * sr - sy * cr
    out[..., 2, 1] = sy * sr + cy * sp * cr
    out[..., 2, 2] = cy * cp
    return out


def turn(matrix: Array, vector: Array) -> Array:
    """Rotate vectors (..., 3) by matrices (..., 3, 3)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.sqrt(np.maximum((vector * vector).sum(-1, keepdims=True), 1e-12)))


def _cross(a: Array, b: Array) -> Array:
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def two_bone(start: Array, target: Array, upper: Array, lower: Array, pole: Array) -> tuple[Array, Array]:
    """Middle and end joint of a two-bone limb: (..., 3) each.

    Parameters
    ----------
    start, target : float array (..., 3)
        Root of the limb; where its end is to be. A target out of reach is drawn in along the line.
    upper, lower : float array (...)
        Bone lengths.
    pole : float array (..., 3)
        Direction that the middle joint bends towards.
    """
    line = target - start
    distance = np.sqrt((line * line).sum(-1))
    axis = line / np.maximum(distance, 1e-6)[..., None]
    distance = np.clip(distance, np.abs(upper - lower) + 0.02, (upper + lower) * 0.9985)
    along = (distance * distance + upper * upper - lower * lower) / (2 * distance)
    away = np.sqrt(np.maximum(upper * upper - along * along, 0.0))
    side = _unit(pole - (pole * axis).sum(-1, keepdims=True) * axis)
    middle = start + along[..., None] * axis + away[..., None] * side
    return middle, start + distance[..., None] * axis


def _swing(pole: Array, axis: Array, angle: Array) -> Array:
    """Turn `pole` about a unit `axis` (Rodrigues), the part along the axis left out."""
    pole = pole - (pole * axis).sum(-1, keepdims=True) * axis
    return np.asarray(np.cos(angle)[..., None] * pole + np.sin(angle)[..., None] * _cross(axis, pole))


@dataclass(frozen=True)
class _Torso:
    joints: Array
    pelvis: Array
    chest: Array
    facing: Array


def _torso(curves: Curves, offsets: Array, scale: Array) -> _Torso:
    """Spine, head, hips and shoulders by forward kinematics: joints (F, 22, 3) with the limbs still empty."""
    joints = np.zeros((len(curves), 22, 3))
    facing = rotation(np.zeros(len(curves)), np.zeros(len(curves)), curves.heading)
    pelvis = facing @ rotation(*curves.pelvis.T)
    bend = rotation(*(curves.spine.T / 3))
    hips = np.moveaxis(offsets[..., _HIPS, :], -2, 0)
    root = curves.root * scale
    joints[:, 0] = root - turn(pelvis, hips.mean(0) + np.zeros((len(curves), 3)))
    for side in (0, 1):
        joints[:, _HIPS[side]] = joints[:, 0] + turn(pelvis, hips[side])
    frame = pelvis
    joints[:, 3] = joints[:, 0] + turn(frame, offsets[..., 3, :])
    for parent, child in ((3, 6), (6, 9)):
        frame = frame @ bend
        joints[:, child] = joints[:, parent] + turn(frame, offsets[..., child, :])
    chest = frame @ bend
    joints[:, 12] = joints[:, 9] + turn(chest, offsets[..., 12, :])
    joints[:, 15] = joints[:, 12] + turn(chest @ rotation(*(curves.head.T * 0.75)), offsets[..., 15, :])
    lift = curves.shrug + 0.35 * np.clip(curves.hands[..., 1] + 0.1, 0.0, 1.1) * (1 - curves.reach_weight)
    cos, sin = np.cos(lift), np.sin(lift)
    for side, sign in ((0, 1.0), (1, -1.0)):
        joints[:, _COLLARS[side]] = joints[:, 9] + turn(chest, offsets[..., _COLLARS[side], :])
        bone = np.broadcast_to(offsets[..., _SHOULDERS[side], :], (len(curves), 3)).copy()
        x, y = bone[:, 0] * sign, bone[:, 1]
        bone[:, 0], bone[:, 1] = (x * cos[:, side] - y * sin[:, side]) * sign, x * sin[:, side] + y * cos[:, side]
        joints[:, _SHOULDERS[side]] = joints[:, _COLLARS[side]] + turn(chest, bone)
    return _Torso(joints, pelvis, chest, facing)


def _length(offsets: Array, joints: list[int]) -> Array:
    return np.sqrt((offsets[..., joints, :] ** 2).sum(-1))


def _pose_legs(curves: Curves, torso: _Torso, offsets: Array, scale: Array) -> None:
    upper, lower = _length(offsets, _KNEES), _length(offsets, _ANKLES)
    hips = torso.joints[:, _HIPS]
    ankles = curves.feet * scale[..., None, :]
    axis = _unit(ankles - hips)
    # The rest pole +Z of the pelvis, carried by the smallest turn that brings the hanging leg to its line.
    pelvis_up, pelvis_front = torso.pelvis[:, None, :, 1], torso.pelvis[:, None, :, 2]
    pole = _carry(pelvis_front, -pelvis_up, axis)
    toes = np.stack([np.sin(curves.foot_yaw), np.zeros_like(curves.foot_yaw), np.cos(curves.foot_yaw)], -1)
    pole = _swing(pole + 0.5 * toes * np.clip(-axis[..., 1:2], 0.0, 1.0), axis, -curves.knee)
    knees, ankles = two_bone(hips, ankles, upper, lower, pole)
    torso.joints[:, _KNEES], torso.joints[:, _ANKLES] = knees, ankles
    foot = rotation(-curves.foot_pitch, np.zeros_like(curves.foot_pitch), curves.foot_yaw)
    torso.joints[:, _FEET] = ankles + turn(foot, np.broadcast_to(offsets[..., _FEET, :], ankles.shape))


def _carry(vector: Array, source: Array, target: Array) -> Array:
    """Turn `vector` (at right angles to `source`) by the smallest rotation that takes `source` to `target`."""
    dot = (source * target).sum(-1, keepdims=True)
    along = (vector * target).sum(-1, keepdims=True)
    return np.asarray(vector - (source + target) * along / np.maximum(1.0 + dot, 0.05))


def _pose_arms(curves: Curves, torso: _Torso, offsets: Array, scale: Array) -> None:
    upper, lower = _length(offsets, _ELBOWS), _length(offsets, _WRISTS)
    shoulders = torso.joints[:, _SHOULDERS]
    arm = (upper + lower)[..., None]
    own = curves.hands * arm * _OUT
    lean = turn(torso.chest[:, None], own)
    # Gravity's frame keeps the chest's heading and drops its pitch and roll.
    front = torso.chest[:, :, 2] - 0.999 * torso.chest[:, 1:2, 2] * np.array([0.0, 1.0, 0.0])
    yaw = np.arctan2(front[:, 0], front[:, 2])
    upright = rotation(np.zeros_like(yaw), np.zeros_like(yaw), yaw)
    level = turn(upright[:, None], own)
    hang = curves.hang[..., None]
    weight = curves.reach_weight[..., None]
    target = (shoulders + lean * (1 - hang) + level * hang) * (1 - weight) + curves.reach * scale[..., None, :] * weight
    axis = _unit(target - shoulders)
    local = (torso.chest[:, None] * axis[..., None]).sum(-2)
    # Elbows point back when the arm hangs, down when it is held forward, outward when it is raised.
    pole = np.empty_like(local)
    pole[..., 0] = _OUT[:, 0] * 0.45
    pole[..., 1] = -0.85
    pole[..., 2] = -0.6 + 0.7 * np.clip(local[..., 1] + 0.3, 0.0, 1.0)
    pole = turn(torso.chest[:, None], pole)
    pole = _swing(pole, axis, curves.elbow * _OUT[:, 0])
    elbows, wrists = two_bone(shoulders, target, upper, lower, pole)
    torso.joints[:, _ELBOWS], torso.joints[:, _WRISTS] = elbows, wrists


def leg_scale(offsets: Array) -> Array:
    """Length of a body's legs over the canonical leg's, (..., 1)."""
    return np.asarray((_length(offsets, _KNEES) + _length(offsets, _ANKLES)).mean(-1, keepdims=True) / LEG)


def _reachable(curves: Curves, torso: _Torso, offsets: Array, scale: Array) -> Array:
    """How far to lower the hips (F,) so that feet near the ground come within reach of their legs."""
    reach = (_length(offsets, _KNEES) + _length(offsets, _ANKLES)) * 0.997
    gap = torso.joints[:, _HIPS] - curves.feet * scale[..., None, :]
    flat = gap[..., 0] ** 2 + gap[..., 2] ** 2
    excess = gap[..., 1] - np.sqrt(np.maximum(reach * reach - flat, 0.01))
    grounded = np.clip(2.0 - curves.feet[..., 1] / (1.5 * ANKLE), 0.0, 1.0)
    return np.asarray((np.clip(excess, 0.0, 0.12) * grounded).max(-1))


def pose(curves: Curves, offsets: Array) -> NDArray[np.float64]:
    """Joint positions (F, 22, 3) in metres of a body with `offsets`, (22, 3) or one body a frame (F, 22, 3)."""
    scale = leg_scale(offsets)
    scale = np.broadcast_to(scale, (len(curves), 1)) if scale.ndim == 1 else scale
    torso = _torso(curves, offsets, scale)
    torso.joints[..., 1] -= _reachable(curves, torso, offsets, scale)[:, None]
    _pose_legs(curves, torso, offsets, scale)
    _pose_arms(curves, torso, offsets, scale)
    return torso.joints
