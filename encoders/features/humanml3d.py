"""Joints <-> the 263 features of HumanML3D (Guo et al., CVPR 2022), feature kind `humanml3d`.

Published weights were trained on these numbers, quirks included, so the quirks are kept and marked "as published".
Numbers where the published code gives up (bones exactly opposite to the reference pose, bones of no length) are
finite here. All functions take any leading dimensions and compute in float64.

Every rotation here is minimal, from an axis u to a direction v: the half-turn about u, then the half-turn about
h = (u + v) / |u + v|. As matrices: (2 h h' - 1) (2 u u' - 1).
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from encoders.motion import FPS as MOTION_FPS
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, CHAINS, INDEX, JOINTS, PARENTS, RAW_OFFSETS

Floats = NDArray[np.float64]

SIZE = 263
FPS = MOTION_FPS

#: Where each group of numbers lies: turn (half the heading's change, radians), root velocity x and z (metres a
#: frame), root height (metres), joints 1..21 (metres, facing +Z above the floor's origin), their local rotations
#: (first two columns), velocities of all joints (metres a frame), contacts (left ankle, foot, right ankle, foot).
LAYOUT = {
    "turn": slice(0, 1),
    "root_velocity": slice(1, 3),
    "height": slice(3, 4),
    "positions": slice(4, 67),
    "rotations": slice(67, 193),
    "velocities": slice(193, 259),
    "contacts": slice(259, 263),
}

_LEFT_HIP, _RIGHT_HIP, _LEFT_SHOULDER, _RIGHT_SHOULDER = (
    INDEX[name] for name in ("left_hip", "right_hip", "left_shoulder", "right_shoulder")
)
_SOLES = [INDEX[name] for name in ("left_ankle", "left_foot", "right_ankle", "right_foot")]
_CONTACT_THRESHOLD = 0.002  # square metres a frame, squared: 0.89 m/s at 20 frames a second
_SMOOTHING_FRAMES = 20.0  # standard deviation of the Gaussian over the facing direction
_SMOOTHING_RADIUS = 80

#: Sums bones along the tree: ``positions - root = _CHAIN_SUM @ bones``.
_CHAIN_SUM = np.eye(len(JOINTS))
for _joint, _parent in enumerate(PARENTS[1:], start=1):
    _CHAIN_SUM[_joint] += _CHAIN_SUM[_parent]

#: The joint in whose frame a rotation is stated. As published, every chain starts in the root's, the arms' too.
_FRAME_OF = np.zeros(len(JOINTS), dtype=np.int64)
for _chain in CHAINS:
    _FRAME_OF[list(_chain[2:])] = _chain[1:-1]

#: Reference direction of each joint's bone; of the root, the facing direction.
_AXES = RAW_OFFSETS.copy()
_AXES[0] = (0, 0, 1)
_HALF_TURN = 2 * _AXES**2 - 1  # the diagonal of 2 u u' - 1, as each axis has one component


def _unit(vectors: Floats, otherwise: ArrayLike = 0.0) -> Floats:
    """Vectors of length one; `otherwise` where a vector has no length."""
    length = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))[..., None]
    known = length > 1e-9
    return np.where(known, vectors / np.where(known, length, 1), otherwise)


def _bones(joints: Floats) -> Floats:
    """Vector from each joint's parent to the joint; zero for the root."""
    return joints - joints[..., np.maximum(PARENTS, 0), :]


def _turned(vectors: Floats, angle: Floats) -> Floats:
    """Vectors (..., J, 3) turned about Y by angle (...)."""
    cosine, sine = np.cos(angle)[..., None], np.sin(angle)[..., None]
    x, z = vectors[..., 0], vectors[..., 2]
    return np.stack([cosine * x + sine * z, vectors[..., 1], cosine * z - sine * x], axis=-1)


def _across(joints: Floats, start: int, end: int) -> Floats:
    return joints[..., end, :] - joints[..., start, :]


def _forward(across: Floats) -> Floats:
    """Y x across, as (x, z): the horizontal direction that leads ahead when `across` leads to the right."""
    return np.stack([across[..., 2], -across[..., 0]], axis=-1)


def _angle_to_ahead(forward: Floats) -> Floats:
    """The turn about Y that brings a horizontal direction (x, z) to +Z; zero for no direction."""
    known = np.einsum("...i,...i->...", forward, forward) > 1e-18
    return np.where(known, -np.arctan2(forward[..., 0], np.where(known, forward[..., 1], 1)), 0)


def uniform_skeleton(joints: ArrayLike) -> Floats:
    """The same poses on the target skeleton: bone directions kept, lengths replaced, the root scaled by leg length.

    As published, the source's leg is its right one in the first frame.
    """
    joints = np.asarray(joints, dtype=np.float64)
    bones = _bones(joints)
    leg = [INDEX["right_knee"], INDEX["right_ankle"]]
    source = np.linalg.norm(bones[..., :1, leg, :], axis=-1).sum(-1)[..., None, None]
    scale = np.where(source > 1e-9, BONE_LENGTHS[leg].sum(dtype=np.float64) / np.maximum(source, 1e-9), 1)
    bones = _unit(bones, RAW_OFFSETS) * BONE_LENGTHS[:, None].astype(np.float64)
    return np.asarray(joints[..., :1, :] * scale + _CHAIN_SUM @ bones)


def canonical(joints: ArrayLike) -> Floats:
    """The motion on the floor (its lowest joint over all frames), begun at the origin and facing +Z."""
    joints = np.array(joints, dtype=np.float64)
    joints[..., 1] -= joints[..., 1].min(axis=(-2, -1), keepdims=True)
    first = joints[..., :1, :, :]
    joints[..., ::2] -= first[..., :1, ::2].copy()
    across = _across(first, _LEFT_HIP, _RIGHT_HIP) + _across(first, _LEFT_SHOULDER, _RIGHT_SHOULDER)
    return _turned(joints, _angle_to_ahead(_forward(across)))


def _smooth(values: Floats) -> Floats:
    """Gaussian over time (axis -2), the ends held."""
    reach = np.arange(-_SMOOTHING_RADIUS, _SMOOTHING_RADIUS + 1)
    kernel = np.exp(-0.5 * (reach / _SMOOTHING_FRAMES) ** 2)
    frames = np.clip(np.arange(values.shape[-2] + 2 * _SMOOTHING_RADIUS) - _SMOOTHING_RADIUS, 0, values.shape[-2] - 1)
    return np.asarray(sliding_window_view(values[..., frames, :], len(kernel), axis=-2) @ (kernel / kernel.sum()))


def _root_angles(joints: Floats) -> Floats:
    """The turn about Y that faces each frame to +Z, in -pi..pi.

    As published: the hips count the wrong way round (left minus right), and the first frame is taken to face +Z
    though smoothing makes it not quite so.
    """
    across = _across(joints, _RIGHT_HIP, _LEFT_HIP) + _across(joints, _LEFT_SHOULDER, _RIGHT_SHOULDER)
    angles = _angle_to_ahead(_smooth(_forward(_unit(across))))
    angles[..., 0] = 0
    return angles


def _local_rotations(joints: Floats, root_angles: Floats) -> Floats:
    """First two columns of each joint's rotation in the frame of the joint before it: (..., T, 21, 6)."""
    directions = _unit(_bones(joints), _AXES)
    directions[..., 0, :] = np.stack([np.sin(root_angles), np.zeros_like(root_angles), np.cos(root_angles)], axis=-1)
    # Opposite to the axis any half-way direction square to it will do; this one turns the root about Y.
    halfway = _unit(directions + _AXES, np.roll(_AXES, 1, axis=-1))
    frame, frame_half_turn = halfway[..., _FRAME_OF, :], _HALF_TURN[_FRAME_OF]
    columns = []
    for axis in range(2):
        column = 2 * halfway * halfway[..., axis : axis + 1]
        column[..., axis] -= 1
        column *= _HALF_TURN[:, axis, None]
        along = np.einsum("...i,...i->...", frame, column)[..., None]
        columns.append((2 * frame * along - column) * frame_half_turn)
    return np.concatenate(columns, axis=-1)[..., 1:, :]


def joints_to_features(joints: ArrayLike, *, retarget: bool = True) -> NDArray[np.float32]:
    """The 263 features of one motion or of many of equal length.

    Parameters
    ----------
    joints : array (..., T, 22, 3)
        Positions in metres, Y up, 20 frames a second.
    retarget : bool
        Bring the motion to the target bone lengths first, as published.

    Returns
    -------
    float32 array (..., T - 1, 263)
        Finite for finite joints; laid out as in `LAYOUT`.

    Raises
    ------
    ValueError
        If there are fewer than two frames, or not 22 joints.
    """
    joints = np.asarray(joints, dtype=np.float64)
    if joints.ndim < 3 or joints.shape[-2:] != (len(JOINTS), 3) or joints.shape[-3] < 2:
        raise ValueError(f"joints.shape={joints.shape} must be (..., T, {len(JOINTS)}, 3) with T >= 2")
    joints = canonical(uniform_skeleton(joints) if retarget else joints)
    angles = _root_angles(joints)

    steps = np.diff(joints, axis=-3)
    contacts = np.square(steps[..., _SOLES, :]).sum(-1) < _CONTACT_THRESHOLD
    # As published: half angles lie within a quarter turn, so one frame has the wrong sign where heading passes 180.
    turn = np.arcsin(np.sin(np.diff(angles, axis=-1) / 2))[..., None]
    root_velocity = _turned(steps[..., :1, :], angles[..., 1:])[..., 0, ::2]
    rotations = _local_rotations(joints, angles)

    above_origin = joints[..., :-1, 1:, :].copy()
    above_origin[..., ::2] -= joints[..., :-1, :1, ::2]
    positions = _turned(above_origin, angles[..., :-1])
    velocities = _turned(steps, angles[..., :-1])

    parts = [turn, root_velocity, joints[..., :-1, 0, 1:2], positions, rotations[..., :-1, :, :], velocities, contacts]
    shape = (*turn.shape[:-1], -1)
    return np.concatenate([part.reshape(shape) for part in parts], axis=-1).astype(np.float32)


def features_to_joints(features: ArrayLike, *, joint_count: int = len(JOINTS)) -> NDArray[np.float32]:
    """Joint positions (..., T, J, 3), begun at the origin and facing +Z, from root motion and joint positions.

    Parameters
    ----------
    features : array (..., T, 12 J - 1)
        The 263 of the 22 joints, or as many of another skeleton that are laid out alike.
    joint_count : int
        J.

    Raises
    ------
    ValueError
        If there are not 12 J - 1 numbers a frame.
    """
    features = np.asarray(features, dtype=np.float64)
    if features.ndim < 2 or features.shape[-1] != 12 * joint_count - 1:
        raise ValueError(f"features.shape={features.shape} must be (..., T, {12 * joint_count - 1})")
    # A frame's root velocity leads to the next frame.
    before = features[..., :-1, :]
    angles = np.zeros(features.shape[:-1])
    np.cumsum(2 * before[..., LAYOUT["turn"].start], axis=-1, out=angles[..., 1:])

    root = np.zeros((*features.shape[:-1], 1, 3))
    root[..., 1:, 0, ::2] = before[..., LAYOUT["root_velocity"]]
    root = np.cumsum(_turned(root, -angles), axis=-3)
    start = LAYOUT["positions"].start
    positions = features[..., start : start + 3 * (joint_count - 1)].reshape(*features.shape[:-1], joint_count - 1, 3)
    positions = _turned(positions, -angles) + root
    root[..., 1] = features[..., LAYOUT["height"]]
    return np.concatenate([root, positions], axis=-2).astype(np.float32)


def of_motion(motion: Motion) -> NDArray[np.float32]:
    """The features (T', 263) of a motion at any rate, at 20 frames a second; a single frame is a still pose."""
    joints = motion.resample(FPS).joints
    return joints_to_features(joints if len(joints) > 1 else joints.repeat(2, axis=0))
