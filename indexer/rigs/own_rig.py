"""Takes of the 22 joints themselves, in any order and with end sites: what `motionseek export` writes, and others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import length, unit
from encoders.skeleton import INDEX, JOINTS, PARENTS
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
