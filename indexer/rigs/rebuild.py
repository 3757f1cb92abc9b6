"""A body of any rig becomes the 22 joints, with the target skeleton's bone lengths.

Rigs agree on where hips, knees, ankles, shoulders, elbows and wrists are; they differ in where they put the
pelvis, the vertebrae and the collar bones. So only the former are taken as they are. The trunk is rebuilt on
them: frames of pelvis and chest from hips, shoulders, back and neck, and in these the offsets of the target
skeleton. What is left of a rig's own build is known from its rest pose and taken off (`correction`).
"""

from __future__ import annotations

import numpy as np

from encoders.geometry import Array, angle_between, apply, frames, unit
from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS, PARENTS
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import SIDES
from indexer.rigs.rest_pose import FOOT, RestPoseCorrection, foot_frames, trunk_frames

#: Directions of the trunk's bones in an upright body facing +Z (rounded means over HumanML3D and KIT-ML).
_UPRIGHT = {
    "left_hip": (0.058, -0.083, -0.008),
    "right_hip": (-0.058, -0.083, -0.008),
    "spine1": (0.0, 0.122, -0.034),
    "spine2": (0.0, 0.130, 0.034),
    "spine3": (0.0, 0.050, 0.019),
    "neck": (0.0, 0.209, 0.0),
    "left_collar": (0.073, 0.112, -0.006),
    "right_collar": (-0.073, 0.112, -0.006),
}
LEG, ARM = ("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")
#: How far up the back each trunk bone lies: 0 turns with the pelvis, 1 with the chest.
_SHARES = {"spine1": 0.0, "spine2": 0.4, "spine3": 0.8, "neck": 1.0}


def offset(joint: str) -> Array:
    """The bone that ends at a trunk joint, in an upright body facing +Z, in metres."""
    return unit(np.array(_UPRIGHT[joint])) * float(BONE_LENGTHS[INDEX[joint]])


def build(landmarks: Landmarks, scale: float, correction: RestPoseCorrection) -> Array:
    """Joints (T, 22, 3) in metres from right-handed landmarks with Y up.

    Parameters
    ----------
    landmarks : Landmarks
        Landmarks over time.
    scale : float
        Metres in a unit of the landmarks.
    correction : RestPoseCorrection
        What the rig's rest pose says about its own build.
    """
    low, high = trunk_frames(landmarks)
    low, high = low @ correction.low.T, high @ correction.high.T
    joints = np.zeros((len(landmarks), len(JOINTS), 3))

    def put(joint: str, direction: Array) -> None:
        at = INDEX[joint]
        joints[:, at] = joints[:, PARENTS[at]] + unit(direction) * BONE_LENGTHS[at]

    middle = (offset("left_hip") + offset("right_hip")) / 2
    joints[:, 0] = landmarks.middle("hip") * scale - low @ middle
    for joint, share in _SHARES.items():
        put(joint, _between(low, high, share) @ offset(joint))
    put("head", _turned(landmarks.bone("neck", "head"), high, correction.head))
    for side in SIDES:
        put(f"{side}_hip", low @ offset(f"{side}_hip"))
        put(f"{side}_collar", high @ offset(f"{side}_collar"))
        from_neck = apply(high.swapaxes(-1, -2), landmarks.bone("neck", f"{side}_shoulder"))
        shoulder = joints[:, INDEX["neck"]] + apply(high, correction.shoulder(side, from_neck))
        put(f"{side}_shoulder", shoulder - joints[:, INDEX[f"{side}_collar"]])
        for limb, bones in ((LEG, _leg), (ARM, _arm)):
            for joint, bone in zip(limb[1:], bones(landmarks, side, correction), strict=True):
                put(f"{side}_{joint}", bone)
        ground = foot_frames(landmarks, side)
        if f"{side}_toe" in landmarks.marks:
            put(f"{side}_foot", _turned(landmarks.bone(f"{side}_ankle", f"{side}_toe"), ground, correction.feet[side]))
        else:
            put(f"{side}_foot", ground @ FOOT)
    return joints


def rebuild(joints: Array, scale: float) -> Array:
    """The 22 joints (T, 22, 3) of another body with the target skeleton's bone lengths, all directions kept.

    `scale` is metres in a unit of the joints.
    """
    rebuilt = np.empty_like(joints)
    rebuilt[:, 0] = joints[:, 0] * scale
    for at in range(1, len(JOINTS)):
        parent = PARENTS[at]
        rebuilt[:, at] = rebuilt[:, parent] + unit(joints[:, at] - joints[:, parent]) * BONE_LENGTHS[at]
    return rebuilt


def _turned(directions: Array, local: Array, fix: Array) -> Array:
    """Directions (T, 3) turned by a rotation (3, 3) given in local frames (T, 3, 3)."""
    return apply(local, apply(local.swapaxes(-1, -2), directions) @ fix.T)


def _between(low: Array, high: Array, share: float) -> Array:
    """Rotations a share of the way from one to another, by blending their axes."""
    blend = low * (1 - share) + high * share
    return frames(blend[..., 0], blend[..., 1])


def _arm(landmarks: Landmarks, side: str, correction: RestPoseCorrection) -> tuple[Array, Array]:
    """Directions (T, 3) of upper arm and forearm, the elbow straightened by its bend in the rest pose."""
    first, second, bend = _limb(landmarks, side, ARM, correction)
    away = unit(second - first * (first * second).sum(-1, keepdims=True))
    return first, first * np.cos(bend) + away * np.sin(bend)


def _leg(landmarks: Landmarks, side: str, correction: RestPoseCorrection) -> tuple[Array, Array]:
    """Directions (T, 3) of upper leg and shank, the knee straightened by its bend in the rest pose.

    Rigs divide a leg differently at the knee but agree on where the foot is, so the direction from hip to ankle
    is kept and the target's two bones are laid into a triangle over it.
    """
    first, _, bend = _limb(landmarks, side, LEG, correction)
    reach = unit(landmarks.bone(f"{side}_hip", f"{side}_ankle"))
    pole = unit(first - reach * (first * reach).sum(-1, keepdims=True))
    a, b = (float(BONE_LENGTHS[INDEX[f"{side}_{joint}"]]) for joint in LEG[1:])
    lift = np.arctan2(b * np.sin(bend), a + b * np.cos(bend))  # between the upper leg and the reach
    return reach * np.cos(lift) + pole * np.sin(lift), reach * np.cos(bend - lift) - pole * np.sin(bend - lift)


def _limb(
    landmarks: Landmarks, side: str, limb: tuple[str, str, str], correction: RestPoseCorrection
) -> tuple[Array, Array, Array]:
    """A limb's two directions (T, 3) and how much it is bent (T, 1) in radians, beyond the rest pose."""
    root, middle, end = (f"{side}_{joint}" for joint in limb)
    first, second = unit(landmarks.bone(root, middle)), unit(landmarks.bone(middle, end))
    bend = np.radians(angle_between(first, second) - correction.bends[middle]).clip(0)
    return first, second, bend[:, None]
