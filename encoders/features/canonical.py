"""The default model's features, `body`: the same numbers for the same movement in any rig.

A rig's proportions and rest pose (hip width, collars, spine curve, shoulder slope) say nothing about a movement but
shift joint positions by more than many movements do. So a canonical, left-right symmetric body is rebuilt from what
rigs agree on: the directions of limbs, the line across the hips, the line across the shoulders and the line between
their midpoints. Heading and place are then removed frame by frame. No number depends on where a window begins:
compute features once for a take and slice them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.geometry import cross, length, unit
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, INDEX

Array = NDArray[np.float32]

#: The rate at which velocities are taken, and the rate of the features.
SOURCE_FPS = 20.0
FPS = 10.0

#: The points of the canonical body, in the order of the position and velocity features.
POINTS = (
    "head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
    "left_knee", "right_knee", "left_ankle", "right_ankle", "left_foot", "right_foot",
)  # fmt: skip
#: Points that can bear weight on the ground, in the order of the contact features.
SOLES = ("left_ankle", "right_ankle", "left_foot", "right_foot")
_SOLES = [POINTS.index(name) for name in SOLES]


def _lay_out(**sizes: int) -> dict[str, slice]:
    ends = np.cumsum(list(sizes.values())).tolist()
    return {name: slice(end - size, end) for (name, size), end in zip(sizes.items(), ends, strict=True)}


#: Where each group of numbers lies: positions of `POINTS` from the middle of the hips and their velocities relative
#: to it, its height above the floor and its velocity (metres and seconds, the body facing +Z), three unit vectors,
#: the turn about Y (radians a second, left is positive), how surely each of `SOLES` stands on the floor (0..1).
LAYOUT = _lay_out(
    positions=3 * len(POINTS),
    velocities=3 * len(POINTS),
    height=1,
    trunk_up=3,
    pelvis_forward=3,
    chest_forward=3,
    root_velocity=3,
    yaw_rate=1,
    contacts=len(SOLES),
)
SIZE = LAYOUT["contacts"].stop


def _both(name: str) -> float:
    return float(BONE_LENGTHS[INDEX[f"left_{name}"]] + BONE_LENGTHS[INDEX[f"right_{name}"]]) / 2


#: Limbs of the canonical body from the trunk outwards, each for the left and the right: starts, ends and length.
_LIMBS = (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"), ("ankle", "foot"))
_STARTS, _ENDS = (
    np.array([INDEX[f"{side}_{limb[end]}"] for limb in _LIMBS for side in ("left", "right")]) for end in (0, 1)
)
_LENGTHS = BONE_LENGTHS[_ENDS].reshape(-1, 2).mean(-1).repeat(2)[:, None]
_TRUNK_JOINTS = [INDEX[n] for n in ("left_hip", "right_hip", "left_shoulder", "right_shoulder", "head")]
_LEG = slice(4, 8)  # thighs and shanks among the limbs

# Metres; what the target skeleton does not state is an average adult's with such legs.
HIP, _SHOULDER, _TRUNK, _HEAD = 0.1, 0.18, 0.48, 0.2
_SIDES = np.array([[1], [-1]], np.float32)
_LOOKING_AHEAD = np.array([0, 0.98, 0.2], np.float32)
_SOLE_HEIGHTS = np.array([0.08, 0.08, 0, 0], np.float32)

_FLOOR_PERCENTILE = 5.0
_HEADING_KERNEL = np.array([1, 3, 6, 7, 6, 3, 1], np.float32) / 27
_CONTACT_SPEED, _CONTACT_HEIGHT = 0.4, 0.1
_FARTHEST = 1e6  # metres: keeps squares of absurd but finite input within float32


def _unit(vectors: Array) -> Array:
    """Vectors of length one; those shorter than a micrometre count as none."""
    return unit(vectors, 1e-6)


def _rate(values: Array) -> Array:
    """Change a second along axis 0, by central differences, one-sided at the ends; zero for a single frame."""
    if len(values) == 1:
        return np.zeros_like(values)
    rate = np.empty_like(values)
    rate[1:-1] = (values[2:] - values[:-2]) * (SOURCE_FPS / 2)
    rate[0] = (values[1] - values[0]) * SOURCE_FPS
    rate[-1] = (values[-1] - values[-2]) * SOURCE_FPS
    return rate


def _smooth(values: Array) -> Array:
    """Values averaged over a few neighbouring frames (axis 0), the ends held."""
    reach = len(_HEADING_KERNEL) // 2
    padded = np.concatenate([values[:1].repeat(reach, 0), values, values[-1:].repeat(reach, 0)])
    smooth = np.zeros_like(values)
    for shift, weight in enumerate(_HEADING_KERNEL):
        smooth += weight * padded[shift : shift + len(values)]
    return smooth


def _scale(limbs: Array) -> Array:
    """Target leg length over this body's own, the median over frames; 1 where the body has no legs."""
    legs = np.median(length(limbs[..., _LEG, :]).sum(-1), axis=0)
    scale: Array = np.where(legs > 1e-4, _LENGTHS[_LEG].sum() / np.maximum(legs, 1e-4), 1).astype(np.float32)
    return scale


def _head(direction: Array, up: Array, forward: Array) -> Array:
    """Direction to the head, looking ahead on the whole.

    Rigs disagree by up to 30 degrees on where head joints lie, at rest too, but agree on how heads move: the take's
    median direction in the chest's frame counts as looking ahead.
    """
    chest = np.stack([cross(up, forward), up, forward], axis=-2)
    local = np.einsum("...ij,...j->...i", chest, direction)
    local += _LOOKING_AHEAD - np.median(local, axis=0)
    return _unit(np.einsum("...ij,...i->...j", chest, local))


def _heading(hips: Array, shoulders: Array, pelvis_forward: Array) -> tuple[Array, Array]:
    """Cosine and sine of the turn about Y that faces the body to +Z.

    Facing is square to the lines across hips and shoulders. Where a body lies on its side these stand upright, and
    what the pelvis faces decides; it has less weight, since it opposes them in a handstand.
    """
    across = hips + shoulders
    forward = _smooth(np.stack([-across[..., 2], across[..., 0]], -1) + np.float32(0.5) * pelvis_forward[..., ::2])
    forward = _unit(forward)
    known = (forward != 0).any(-1)
    return np.where(known, forward[..., 1], np.float32(1)), forward[..., 0]


def _turn(vectors: Array, cosine: Array, sine: Array) -> Array:
    """Vectors (T, ..., P, 3) turned about Y so that the heading becomes +Z."""
    x, z = vectors[..., 0], vectors[..., 2]
    cosine, sine = cosine[..., None], sine[..., None]
    return np.stack([cosine * x - sine * z, vectors[..., 1], sine * x + cosine * z], axis=-1)


def _points(up: Array, hips: Array, shoulders: Array, head: Array, limbs: Array) -> Array:
    """The canonical body's `POINTS` (..., 13, 3) around the middle of its hips."""
    up = up[..., None, :] * np.float32(_TRUNK)
    shoulder = up + np.float32(_SHOULDER) * _SIDES * shoulders[..., None, :]
    elbow = shoulder + limbs[..., 0:2, :]
    wrist = elbow + limbs[..., 2:4, :]
    knee = np.float32(HIP) * _SIDES * hips[..., None, :] + limbs[..., 4:6, :]
    ankle = knee + limbs[..., 6:8, :]
    foot = ankle + limbs[..., 8:10, :]
    return np.concatenate(
        [up + np.float32(_HEAD) * head[..., None, :], shoulder, elbow, wrist, knee, ankle, foot], axis=-2
    )


def _contacts(points: Array, velocities: Array, root_velocity: Array, height: Array) -> Array:
    """How surely each of `SOLES` stands on the ground, 0..1: one at rest on it, less the faster and the higher."""
    speed = length(velocities[..., _SOLES, :] + root_velocity[..., None, :])
    above = np.maximum(points[..., _SOLES, 1] + height[..., None] - _SOLE_HEIGHTS, 0)
    contacts: Array = 1 / (1 + (speed / _CONTACT_SPEED) ** 2 + (above / _CONTACT_HEIGHT) ** 2)
    return contacts


def body_features(joints: ArrayLike) -> Array:
    """Features of one motion or of many of equal length.

    Parameters
    ----------
    joints : array (..., T, 22, 3)
        Positions in metres (any scale will do), Y up, 20 frames a second.

    Returns
    -------
    float32 array (..., ceil(T / 2), SIZE)
        Every second frame's features, laid out as in `LAYOUT`. Finite for finite joints.
    """
    # Time is the first axis inside, whatever the leading dimensions.
    place: Array = np.moveaxis(np.clip(joints, -_FARTHEST, _FARTHEST).astype(np.float32), -3, 0)
    limbs = place[..., _ENDS, :] - place[..., _STARTS, :]
    left_hip, right_hip, left_shoulder, right_shoulder, head = (place[..., i, :] for i in _TRUNK_JOINTS)
    middle_hip: Array = (left_hip + right_hip) * np.float32(0.5)
    middle_shoulder: Array = (left_shoulder + right_shoulder) * np.float32(0.5)

    up = _unit(middle_shoulder - middle_hip)
    hips, shoulders = _unit(left_hip - right_hip), _unit(left_shoulder - right_shoulder)
    pelvis_forward, chest_forward = _unit(cross(hips, up)), _unit(cross(shoulders, up))
    head = _head(_unit(head - middle_shoulder), up, chest_forward)

    root = middle_hip * _scale(limbs)[..., None]
    points = _points(up, hips, shoulders, head, _unit(limbs) * _LENGTHS)
    lowest = root[..., 1] + np.minimum(points[..., 1].min(-1), 0)
    height = root[..., 1] - np.percentile(lowest, _FLOOR_PERCENTILE, axis=0).astype(np.float32)

    velocities, root_velocity = _rate(points), _rate(root)
    contacts = _contacts(points, velocities, root_velocity, height)
    cosine, sine = _heading(hips, shoulders, pelvis_forward)
    yaw_rate = cosine * _rate(sine) - sine * _rate(cosine)

    vectors = np.stack([up, pelvis_forward, chest_forward, root_velocity], axis=-2)
    turned = _turn(np.concatenate([points, velocities, vectors], axis=-2)[::2], cosine[::2], sine[::2])
    turned = turned.reshape(*turned.shape[:-2], -1)
    split = LAYOUT["velocities"].stop
    parts = [turned[..., :split], height[::2, ..., None], turned[..., split:], yaw_rate[::2, ..., None], contacts[::2]]
    return np.ascontiguousarray(np.moveaxis(np.concatenate(parts, axis=-1), 0, -2))


def of_motion(motion: Motion) -> Array:
    """The features (T', SIZE) of a motion at any rate, T' frames at 10 a second."""
    return body_features(motion.resample(SOURCE_FPS).joints)


def of_motions(motions: Sequence[Motion]) -> list[Array]:
    """The same numbers for many motions, those of equal length at once: several times as quick where they are short."""
    joints = [motion.resample(SOURCE_FPS).joints for motion in motions]
    features = dict[int, Array]()
    for frames in {len(track) for track in joints}:
        alike = [i for i, track in enumerate(joints) if len(track) == frames]
        features |= zip(alike, body_features(np.stack([joints[i] for i in alike])), strict=True)
    return [features[i] for i in range(len(joints))]


def _mirrored_name(name: str) -> str:
    side, _, rest = name.partition("_")
    return {"left": "right_", "right": "left_"}[side] + rest if rest else name


def _mirror() -> tuple[NDArray[np.int64], Array]:
    index, sign = np.arange(SIZE), np.ones(SIZE, np.float32)
    swap = [POINTS.index(_mirrored_name(name)) for name in POINTS]
    for group in ("positions", "velocities"):
        index[LAYOUT[group]] = index[LAYOUT[group]].reshape(-1, 3)[swap].ravel()
        sign[LAYOUT[group]][::3] = -1
    for group in ("trunk_up", "pelvis_forward", "chest_forward", "root_velocity", "yaw_rate"):
        sign[LAYOUT[group].start] = -1
    index[LAYOUT["contacts"]] = index[LAYOUT["contacts"]][[SOLES.index(_mirrored_name(name)) for name in SOLES]]
    return index, sign


#: ``features[..., MIRROR_INDEX] * MIRROR_SIGN`` are the features of the mirrored motion.
MIRROR_INDEX, MIRROR_SIGN = _mirror()
