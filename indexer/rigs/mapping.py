"""Which joint of a file is which joint of the body: by name first, by the shape of the tree where names do not help.

A rig names a limb's joints in its own way, but always in order from the trunk to the tip. So each name only
proposes roles (`joint_names`), and the best assignment along a path of the tree that keeps the order decides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from os import PathLike

import numpy as np

from encoders.errors import UnknownRig, UnreadableMotion
from encoders.skeleton import INDEX
from indexer.rigs.joint_names import TIP, JointName, parse_joint_name
from indexer.rigs.shape import head_above, map_shape
from indexer.rigs.topology import meeting, paths, route
from indexer.take import Take

LEG = ("hip", "knee", "ankle", "toe")
ARM = ("collar", "shoulder", "elbow", "wrist")
TRUNK = ("neck", "head")
SIDES = ("left", "right")
_NOBODY = (
    "no joint found for any part of a body: not a human figure, or its joints have unknown names;"
    " name them (joint_map=, --joint-map)"
)
ESSENTIAL = tuple(f"{side}_{joint}" for joint in (*LEG[:3], *ARM[1:]) for side in SIDES)

#: What finding a role is worth, against what its names cost.
_WORTH = {role: 4.0 if role in ("toe", "collar", "neck") else 10.0 for role in LEG + ARM + TRUNK}


@dataclass(frozen=True)
class RigMap:
    """Where the body's joints are found in a take.

    Attributes
    ----------
    joints : dict of str to int
        Landmark ("left_hip", "left_toe", "neck", ...) to joint number.
    spine : list of int
        Joints on the way from where the legs part to where the arms part, upwards.
    """

    joints: dict[str, int]
    spine: list[int] = field(default_factory=list)

    @property
    def missing(self) -> list[str]:
        """Landmarks without which no body can be built."""
        lacking = [name for name in ESSENTIAL if name not in self.joints]
        return lacking if {"neck", "head"} & set(self.joints) else [*lacking, "head"]


def map_rig(take: Take, path: str | PathLike[str], joint_map: Mapping[str, str] | None = None) -> RigMap:
    """The body in a take.

    Parameters
    ----------
    take : Take
        As read.
    path : path
        Named in errors.
    joint_map : mapping, optional
        Target joint to joint name in the file, over what is found.

    Raises
    ------
    UnknownRig
        If a joint without which no body can be built is not found.
    UnreadableMotion
        If `joint_map` names a joint that is not among the 22, or not in the file.
    """
    joints = map_names(take)
    given = _given(take, path, joint_map or {})
    rig = RigMap({**joints, **given})
    if rig.missing:
        rig = RigMap({**map_shape(take), **joints, **given})
    if rig.missing == ["head"]:
        rig = RigMap({**rig.joints, **head_above(take, rig.joints)})
    if rig.missing:
        raise UnknownRig(path, rig.missing, _NOBODY if len(rig.missing) >= len(ESSENTIAL) else None)
    return replace(rig, spine=_spine(take, rig.joints))


def map_names(take: Take) -> dict[str, int]:
    """Landmarks by joint names alone; may be incomplete."""
    return dict(_map_names(take.names, tuple(take.parents.tolist())))


@lru_cache(maxsize=16)  # most files of a folder have few skeletons
def _map_names(joint_names: tuple[str, ...], parents: tuple[int, ...]) -> dict[str, int]:
    names = [parse_joint_name(name) for name in joint_names]
    ways = paths(np.array(parents, np.int64))
    joints = _best(ways, names, TRUNK, "")
    for side in SIDES:
        for limb in (LEG, ARM):
            joints.update({f"{side}_{role}": joint for role, joint in _best(ways, names, limb, side).items()})
    return joints


def _given(take: Take, path: str | PathLike[str], joint_map: Mapping[str, str]) -> dict[str, int]:
    """The joints that a joint map names, as landmarks."""
    given: dict[str, int] = {}
    for target, name in joint_map.items():
        if target not in INDEX:
            raise UnreadableMotion(path, f"the joint map names {target!r}, which is none of {', '.join(INDEX)}")
        if name not in take.names:
            raise UnreadableMotion(path, f"the joint map gives {name!r} for {target}, but the file has no such joint")
        given[target.replace("foot", "toe")] = take.names.index(name)
    return given


def _best(ways: Sequence[Sequence[int]], names: Sequence[JointName], roles: Sequence[str], side: str) -> dict[str, int]:
    """The most valuable assignment of a limb's roles along any path."""
    found = [_assign(way, names, roles, side) for way in ways]
    return max(found, key=lambda x: x[0])[1] if found else {}


def _assign(
    way: Sequence[int], names: Sequence[JointName], roles: Sequence[str], side: str
) -> tuple[float, dict[str, int]]:
    """Roles to joints, both in order, by dynamic programming over (joints seen, roles used)."""
    nothing: tuple[float, dict[str, int]] = (-np.inf, {})
    best: list[tuple[float, dict[str, int]]] = [(0.0, {}), *[nothing] * len(roles)]
    before: list[str] = []
    for joint in way:
        name = names[joint]
        offers = name.roles if name.side == side else {}
        if name.is_tip:
            offers = {role: TIP for last, role in pairwise(roles) if last in before}
        else:
            before = list(offers) or before
        for k in range(len(roles), 0, -1):
            role = roles[k - 1]
            if role not in offers:
                continue
            score, chosen = max(best[:k], key=lambda x: x[0])
            score += _WORTH[role] - offers[role]
            if score > best[k][0]:
                best[k] = score, {**chosen, role: joint}
    return max(best, key=lambda x: x[0])


def _spine(take: Take, joints: Mapping[str, int]) -> list[int]:
    """Joints on the way from where the legs part to where the arms part, upwards, without the first."""
    low = meeting(take.parents, joints["left_hip"], joints["right_hip"])
    high = meeting(take.parents, joints["left_shoulder"], joints["right_shoulder"])
    return [] if low is None or high is None else route(take.parents, low, high)[1:]
