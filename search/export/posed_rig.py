"""The 22 joints with rotations: a rig in a T-pose, turned so that its bones are where a motion has them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import frames, length, rotation_between, unit
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS, PARENTS
from indexer.rigs import rebuild
from indexer.rigs.own_rig import TIPS
from indexer.rigs.rest_pose import FOOT, HEAD
from search.export.rig_motion import RigMotion

Array = NDArray[np.float64]

#: Metres from a last joint to its tip.
_TIP = 0.1
_TRUNK = ("left_hip", "right_hip", "spine1", "spine2", "spine3", "neck", "left_collar", "right_collar")
#: Directions of the limbs in the rest pose.
_DIRECTIONS = {"head": HEAD}
for _side, _sign in (("left", 1.0), ("right", -1.0)):
    _DIRECTIONS |= {f"{_side}_{joint}": np.array([0.0, -1.0, 0.0]) for joint in ("knee", "ankle")}
    _DIRECTIONS |= {f"{_side}_{joint}": np.array([_sign, 0.0, 0.0]) for joint in ("shoulder", "elbow", "wrist")}
    _DIRECTIONS[f"{_side}_foot"] = FOOT
#: The upper bones of limbs: the joint at their end, that at the end of the lower bone, and the axis, at rest, about
#: which the lower one bends.
_HINGES = {
    INDEX["left_hip"]: (INDEX["left_knee"], INDEX["left_ankle"], np.array([1.0, 0.0, 0.0])),
    INDEX["right_hip"]: (INDEX["right_knee"], INDEX["right_ankle"], np.array([1.0, 0.0, 0.0])),
    INDEX["left_shoulder"]: (INDEX["left_elbow"], INDEX["left_wrist"], np.array([0.0, -1.0, 0.0])),
    INDEX["right_shoulder"]: (INDEX["right_elbow"], INDEX["right_wrist"], np.array([0.0, 1.0, 0.0])),
}
#: How far a bend of the lower bone decides how the upper one is twisted: from a sine of 1 / 4 on mostly.
_BEND = 4.0

_CHILDREN = [np.flatnonzero(joint == PARENTS) for joint in range(len(JOINTS))]


def _bone(name: str) -> Array:
    """The bone that ends at a joint, in the rest pose, in metres."""
    if name in _TRUNK:
        return rebuild.offset(name)
    return unit(_DIRECTIONS[name]) * float(BONE_LENGTHS[INDEX[name]])


#: The bones of the rest pose (22, 3).
_BONES: Array = np.array([np.zeros(3), *(_bone(name) for name in JOINTS[1:])])


def posed_rig(motion: Motion) -> RigMotion:
    """The motion on the rig of the 22 joints and five tips, in metres, Y up.

    A joint with several bones is turned so that they fit best (Kabsch 1976), one with one bone by the smallest turn;
    thighs and upper arms are twisted so that knee and elbow bend as hinges.
    """
    joints = motion.joints.astype(np.float64)
    rotations = joint_rotations(joints)
    tips = [INDEX[name] for name in TIPS]
    ends = np.array(list(TIPS.values())) * _TIP
    rest = np.zeros((len(JOINTS), 3))
    sizes = _bone_sizes(joints)
    for joint in range(1, len(JOINTS)):
        rest[joint] = rest[PARENTS[joint]] + _BONES[joint] * sizes[joint]
    return RigMotion(
        names=(*JOINTS, *(f"{name}_end" for name in TIPS)),
        parents=np.concatenate([PARENTS, tips]),
        rest=np.concatenate([rest, rest[tips] + ends]),
        positions=np.concatenate([joints, joints[:, tips] + np.einsum("tjab,jb->tja", rotations[:, tips], ends)], 1),
        rotations=np.concatenate([rotations, rotations[:, tips]], axis=1),
        fps=motion.fps,
    )


def joint_rotations(joints: Array) -> Array:
    """Rotations (T, 22, 3, 3) that take each joint's bones from the rest pose to where joints (T, 22, 3) are."""
    turns = np.empty((*joints.shape, 3))
    for joint, children in enumerate(_CHILDREN):
        parent = PARENTS[joint]
        above = np.broadcast_to(np.eye(3), (len(joints), 3, 3)) if parent < 0 else turns[:, parent]
        bones = joints[:, children] - joints[:, [joint]]
        if len(children) == 0:
            turns[:, joint] = above
        elif len(children) > 1:
            turns[:, joint] = _kabsch(_BONES[children], bones)
        else:
            turns[:, joint] = rotation_between(above @ _BONES[children[0]], bones[:, 0]) @ above
            if joint in _HINGES:
                turns[:, joint] = _twisted(turns[:, joint], joints, joint)
    return turns


def _twisted(turns: Array, joints: Array, joint: int) -> Array:
    """Rotations (T, 3, 3) of an upper bone, turned about it so that the lower one bends about its hinge."""
    middle, end, hinge = _HINGES[joint]
    along = unit(joints[:, middle] - joints[:, joint])
    bend = np.cross(along, unit(joints[:, end] - joints[:, middle]))
    across = turns @ hinge
    wanted = across + _BEND * bend
    wanted = np.where(length(np.cross(along, wanted))[:, None] > 1e-6, wanted, across)
    at_rest = frames(hinge, unit(_BONES[middle]))
    twisted: Array = frames(np.cross(along, np.cross(wanted, along)), along) @ at_rest.T
    return twisted


def _kabsch(rest: Array, bones: Array) -> Array:
    """The rotations (T, 3, 3) that bring bones (C, 3) of the rest pose nearest to bones (T, C, 3)."""
    u, _, vt = np.linalg.svd(np.einsum("tca,cb->tab", bones, rest))
    u[..., 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    turned: Array = u @ vt
    return turned


def _bone_sizes(joints: Array) -> Array:
    """How much longer (22,) the bones of a motion mostly are than those of the rest pose."""
    bones = joints[:, 1:] - joints[:, PARENTS[1:]]
    return np.concatenate([[1.0], np.median(length(bones), axis=0) / BONE_LENGTHS[1:]])
