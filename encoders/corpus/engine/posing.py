"""Posing: random human skeleton geometry, and joint positions from curves by two-bone inverse kinematics.

Everything is vectorised over frames, and the four limbs are solved together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, Array, Curves
from encoders.skeleton import INDEX, MIRROR

#: Offset of each joint from its parent, metres, of a typical adult rig in standing pose.
OFFSETS = np.array(
    [
        [0, 0, 0], [0.085, -0.07, -0.01], [-0.085, -0.07, -0.01], [0, 0.115, -0.015], [0, -0.4, 0], [0, -0.4, 0],
        [0, 0.135, 0.03], [0, -0.415, 0], [0, -0.415, 0], [0, 0.065, 0.035], [0.02, -0.065, 0.13],
        [-0.02, -0.065, 0.13], [0, 0.205, -0.015], [0.07, 0.11, -0.02], [-0.07, 0.11, -0.02], [0, 0.1, 0.045],
        [0.11, 0.03, -0.015], [-0.11, 0.03, -0.015], [0, -0.27, 0], [0, -0.27, 0], [0, -0.26, 0], [0, -0.26, 0],
    ]
)  # fmt: skip
_AHEAD = 0.075  #: metres of the hips ahead of the ankles, standing
CANONICAL_LEG = 0.815  #: length of the canonical leg, hip to ankle

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
    """Offsets (22, 3) of a random symmetric body: lengths, widths, slopes and bone directions vary as between rigs."""
    offsets = OFFSETS * np.exp(rng.normal(0.0, 0.07 * spread, (22, 1)))
    offsets *= np.exp(rng.normal(0.0, 0.05 * spread))
    offsets[1:] += rng.normal(0.0, 1.0, (21, 3)) * spread * _WOBBLE[1:]
    mirrored = offsets[MIRROR] * np.array([-1.0, 1.0, 1.0])
    return np.asarray((offsets + mirrored) / 2)


#: Standard deviation of each offset between rigs, metres per axis (averaging both sides shrinks it by 0.7).
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
    angles = np.stack([pitch, -np.asarray(roll), yaw])
    (cp, cr, cy), (sp, sr, sy) = np.cos(angles), np.sin(angles)
    out = np.empty((*cp.shape, 3, 3))
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


def turn(matrix: Array, vectors: Array) -> Array:
    """Rotate vectors by matrices (F, 3, 3): (K, 3), the same in every frame, or (F, K, 3); gives (F, K, 3)."""
    if vectors.ndim == 2:
        return np.asarray((matrix.reshape(-1, 3) @ vectors.T).reshape(-1, 3, len(vectors)).swapaxes(1, 2))
    return np.asarray(vectors @ matrix.swapaxes(1, 2))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("...i,...i->...", a, b)[..., None])


def _cross(a: Array, b: Array) -> Array:
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return out


def two_bone(start: Array, target: Array, upper: Array, lower: Array, pole: Array) -> tuple[Array, Array]:
    """Middle and end joint of a two-bone limb: (..., 3) each.

    Parameters
    ----------
    start, target : float array (..., 3)
        Root of the limb; target of its end. A target out of reach is moved in along the line.
    upper, lower : float array (...)
        Bone lengths.
    pole : float array (..., 3)
        Direction in which the middle joint bends.
    """
    line = target - start
    distance = np.sqrt(_dot(line, line))
    axis = line / np.maximum(distance, 1e-6)
    upper, lower = upper[..., None], lower[..., None]
    distance = np.clip(distance, np.abs(upper - lower) + 0.02, (upper + lower) * 0.9985)
    along = (distance * distance + upper * upper - lower * lower) / (2 * distance)
    away = np.sqrt(np.maximum(upper * upper - along * along, 0.0))
    side = pole - _dot(pole, axis) * axis
    side *= away / np.sqrt(np.maximum(_dot(side, side), 1e-12))
    return start + along * axis + side, start + distance * axis


def _swing(pole: Array, axis: Array, angle: Array) -> Array:
    """Rotate `pole`, less its component along a unit `axis`, about that axis (Rodrigues)."""
    pole = pole - _dot(pole, axis) * axis
    return np.asarray(np.cos(angle)[..., None] * pole + np.sin(angle)[..., None] * _cross(axis, pole))


def _carry(vector: Array, source: Array, target: Array) -> Array:
    """Rotate `vector` (orthogonal to `source`) by the smallest rotation from `source` to `target`."""
    return np.asarray(
        vector - (source + target) * (_dot(vector, target) / np.maximum(1.0 + _dot(source, target), 0.05))
    )


def _length(offsets: Array, joints: list[int]) -> Array:
    return np.asarray(np.sqrt((offsets[joints] ** 2).sum(-1)))


def leg_scale(offsets: Array) -> float:
    """Ratio of a body's leg length to the canonical one."""
    return float((_length(offsets, _KNEES) + _length(offsets, _ANKLES)).mean() / CANONICAL_LEG)


@dataclass(frozen=True)
class _Trunk:
    """Joints (F, 22, 3) with limbs not yet set, and the frames of pelvis and chest (F, 3, 3)."""

    joints: Array
    pelvis: Array
    chest: Array


def _trunk(curves: Curves, offsets: Array, scale: float) -> _Trunk:
    """Spine, head, hips and shoulders by forward kinematics."""
    frames = len(curves)
    joints = np.empty((frames, 22, 3))
    pelvis_yaw = curves.pelvis[:, 2]
    tilt = rotation(
        np.stack([curves.pelvis[:, 0], curves.spine[:, 0] / 3, 0.75 * curves.head[:, 0], 0.0 * pelvis_yaw]),
        np.stack([curves.pelvis[:, 1], curves.spine[:, 1] / 3, 0.75 * curves.head[:, 1], 0.0 * pelvis_yaw]),
        np.stack([pelvis_yaw, curves.spine[:, 2] / 3, 0.75 * curves.head[:, 2], curves.heading]),
    )
    pelvis, bend = tilt[3] @ tilt[0], tilt[1]
    hips = offsets[_HIPS]
    local = turn(pelvis, np.concatenate([hips - hips.mean(0), [-hips.mean(0), offsets[3] - hips.mean(0)]]))
    # Upright, the hips are ahead of the ankles, over the middle of the feet.
    upright = np.clip((curves.root[:, 1] - 0.5) / 0.3, 0.0, 1.0) * np.clip(np.cos(curves.pelvis[:, 0]), 0.0, 1.0)
    root = curves.root * scale + _AHEAD * upright[:, None] * tilt[3][:, :, 2]
    joints[:, [*_HIPS, 0, 3]] = root[:, None] + local
    frame = pelvis
    for parent, child in ((3, 6), (6, 9)):
        frame = frame @ bend
        joints[:, child] = joints[:, parent] + turn(frame, offsets[child : child + 1])[:, 0]
    chest = frame @ bend
    joints[:, [12, *_COLLARS]] = joints[:, 9:10] + turn(chest, offsets[[12, *_COLLARS]])
    joints[:, 15] = joints[:, 12] + turn(chest @ tilt[2], offsets[15:16])[:, 0]
    # A raised arm lifts its shoulder.
    lift = curves.shrug + 0.35 * np.clip(curves.hands[..., 1] + 0.1, 0.0, 1.1) * (1 - curves.reach_weight)
    cos, sin = np.cos(lift), np.sin(lift)
    out, up, ahead = (offsets[_SHOULDERS] * _OUT).T
    bone = np.stack([(out * cos - up * sin) * _OUT[:, 0], out * sin + up * cos, np.broadcast_to(ahead, cos.shape)], -1)
    joints[:, _SHOULDERS] = joints[:, _COLLARS] + turn(chest, bone)
    return _Trunk(joints, pelvis, chest)


def _lower(curves: Curves, hips: Array, offsets: Array, scale: float) -> Array:
    """Lowering of the hips (F, 1) that brings feet near the ground within reach of their legs."""
    reach = (_length(offsets, _KNEES) + _length(offsets, _ANKLES)) * 0.997
    gap = hips - curves.feet * scale
    excess = gap[..., 1] - np.sqrt(np.maximum(reach * reach - gap[..., 0] ** 2 - gap[..., 2] ** 2, 0.01))
    grounded = np.clip(2.0 - curves.feet[..., 1] / (1.5 * ANKLE), 0.0, 1.0)
    needed = (np.clip(excess, 0.0, 0.12) * grounded).max(-1)
    # The mean of a running maximum is smooth and never below what is needed.
    for width, reduced in ((7, np.max), (7, np.mean)):
        needed = reduced(sliding_window_view(np.pad(needed, width // 2, mode="edge"), width), axis=-1)
    return np.asarray(needed[:, None])


def _knee_poles(curves: Curves, trunk: _Trunk, axis: Array) -> Array:
    """Knee poles (F, 2, 3): the front of the pelvis, rotated with the leg, mixed with the direction of the toes."""
    pole = _carry(trunk.pelvis[:, None, :, 2], -trunk.pelvis[:, None, :, 1], axis)
    toes = np.stack([np.sin(curves.foot_yaw), np.zeros_like(curves.foot_yaw), np.cos(curves.foot_yaw)], -1)
    return _swing(pole + 0.5 * toes * np.clip(-axis[..., 1:2], 0.0, 1.0), axis, -curves.knee)


def _hand_targets(curves: Curves, trunk: _Trunk, arm: Array, scale: float) -> Array:
    """Wrists in the world (F, 2, 3): a blend of the chest's frame, an upright frame and world targets."""
    own = curves.hands * (arm[:, None] * _OUT)
    # The upright frame has the chest's heading without pitch and roll.
    yaw = np.arctan2(trunk.chest[:, 0, 2], trunk.chest[:, 2, 2])
    level = turn(rotation(np.zeros_like(yaw), np.zeros_like(yaw), yaw), own)
    hand = turn(trunk.chest, own)
    hand += (level - hand) * curves.hang[..., None] + trunk.joints[:, _SHOULDERS]
    return np.asarray(hand + (curves.reach * scale - hand) * curves.reach_weight[..., None])


def _elbow_poles(curves: Curves, trunk: _Trunk, axis: Array) -> Array:
    """Elbow poles (F, 2, 3): back for a hanging arm, down for one held forward, outward for a raised one."""
    raised = axis @ trunk.chest[:, :, 1:2]
    local = np.empty_like(axis)
    local[..., 0] = _OUT[:, 0] * (0.12 + 0.3 * np.clip(raised[..., 0] + 0.4, 0.0, 1.0))
    local[..., 1] = -0.85
    local[..., 2] = -0.6 + 0.7 * np.clip(raised[..., 0] + 0.3, 0.0, 1.0)
    return _swing(turn(trunk.chest, local), axis, curves.elbow * _OUT[:, 0])


def pose(curves: Curves, offsets: Array) -> Array:
    """Joint positions (F, 22, 3) in metres of a body with `offsets` (22, 3)."""
    scale = leg_scale(offsets)
    trunk = _trunk(curves, offsets, scale)
    joints = trunk.joints
    joints[..., 1] -= _lower(curves, joints[:, _HIPS], offsets, scale)
    arm = _length(offsets, _ELBOWS) + _length(offsets, _WRISTS)
    start = joints[:, [*_HIPS, *_SHOULDERS]]
    target = np.concatenate([curves.feet * scale, _hand_targets(curves, trunk, arm, scale)], axis=1)
    axis = target - start
    axis /= np.sqrt(np.maximum(_dot(axis, axis), 1e-9))
    pole = np.concatenate([_knee_poles(curves, trunk, axis[:, :2]), _elbow_poles(curves, trunk, axis[:, 2:])], axis=1)
    upper, lower = _length(offsets, [*_KNEES, *_ELBOWS]), _length(offsets, [*_ANKLES, *_WRISTS])
    middle, end = two_bone(start, target, upper, lower, pole)
    joints[:, [*_KNEES, *_ELBOWS]], joints[:, [*_ANKLES, *_WRISTS]] = middle, end
    foot = rotation(-curves.foot_pitch, np.zeros_like(curves.foot_pitch), curves.foot_yaw)
    joints[:, _FEET] = end[:, :2] + (foot @ offsets[_FEET][..., None])[..., 0]
    return joints
