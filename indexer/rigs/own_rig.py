"""Takes of the 22 joints themselves: in any order and with end sites, as `motionseek export` writes them, or of a body
that is built as theirs under any names.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import length, unit
from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS, PARENTS
from indexer.rigs.mapping import SIDES, RigMap
from indexer.rigs.topology import meeting
from indexer.take import Take

_TIP = "_end"
#: Where the last bones of an exported rig point in its rest pose; all are equally long.
TIPS = {
    "left_foot": (0.0, 0.0, 1.0),
    "right_foot": (0.0, 0.0, 1.0),
    "head": (0.0, 1.0, 0.0),
    "left_wrist": (1.0, 0.0, 0.0),
    "right_wrist": (-1.0, 0.0, 0.0),
}

#: Metres, on a body with the target's legs, by which the bones of the trunk may be longer or shorter than the target's,
#: and those of limbs. SMPL's own vary by 0.03 from person to person; Mixamo's and MotionBuilder's differ by 0.08.
_TRUNK, _LIMB = 0.05, 0.08
_IS_LIMB = np.array([name.endswith(("knee", "ankle", "foot", "elbow", "wrist", "head")) for name in JOINTS[1:]])


def as_own_rig(take: Take) -> Take:
    """The 22 joints in their order, without tips, where a take has these and no others; any other take as it is.

    The up axis of an exported rig is certain: it is known by its tips, and is written Y up.
    """
    if take.names == JOINTS:
        return take
    bodies = [joint for joint, name in enumerate(take.names) if name in INDEX]
    at = {take.names[joint]: joint for joint in bodies}
    others = [name for name in take.names if name not in INDEX]
    if len(bodies) != len(JOINTS) or len(at) != len(JOINTS) or any(not _is_tip(name) for name in others):
        return take
    order = [at[name] for name in JOINTS]
    if [_parent(take, joint) for joint in order] != PARENTS.tolist():
        return take
    exported = _has_exported_tips(take)
    return replace(
        take,
        names=JOINTS,
        parents=PARENTS.astype(np.int64),
        rest=take.rest[order],
        positions=take.positions[:, order],
        up="y" if exported else take.up,
        up_is_certain=exported or take.up_is_certain,
        rotations=None,
    )


def own_body(take: Take, rig: RigMap) -> list[int] | None:
    """Where in a take the 22 joints stand, in their order; None where its skeleton is no body like theirs.

    It is one if it has these joints in the same tree, three vertebrae among them, and its bones are about as long as
    the target's, whatever the names are.
    """
    if take.names == JOINTS:
        return list(range(len(JOINTS)))
    marks = rig.joints
    found = {name: marks.get(name.replace("foot", "toe"), -1) for name in JOINTS}
    root = meeting(take.parents, marks["left_hip"], marks["right_hip"])
    found["pelvis"] = -1 if root is None else root
    found |= {f"spine{number}": joint for number, joint in enumerate(rig.spine, start=1)}
    joints = [found[name] for name in JOINTS]
    if len(rig.spine) != 3 or min(joints) < 0 or take.parents[joints[1:]].tolist() != [joints[k] for k in PARENTS[1:]]:
        return None
    bones = length(take.positions[0, joints[1:]] - take.positions[0, take.parents[joints[1:]]])
    legs = [INDEX[f"{side}_{name}"] - 1 for side in SIDES for name in ("knee", "ankle")]
    scale = BONE_LENGTHS[1:][legs].sum() / max(float(bones[legs].sum()), 1e-9)
    allowed = np.where(_IS_LIMB, _LIMB, _TRUNK)
    return joints if (np.abs(bones * scale - BONE_LENGTHS[1:]) < allowed).all() else None


def _is_tip(name: str) -> bool:
    return name.endswith(_TIP) and name.removesuffix(_TIP) in INDEX


def _parent(take: Take, joint: int) -> int:
    parent = int(take.parents[joint])
    return INDEX.get(take.names[parent], -2) if parent >= 0 else -1


def _has_exported_tips(take: Take) -> bool:
    tips: list[NDArray[np.float64]] = []
    for name, direction in TIPS.items():
        if name + _TIP not in take.names:
            return False
        tip = take.rest[take.names.index(name + _TIP)] - take.rest[take.names.index(name)]
        if np.abs(unit(tip) - direction).max() > 1e-4:
            return False
        tips.append(tip)
    sizes = length(np.array(tips))
    return bool(np.ptp(sizes) < 1e-4 * sizes.max())
