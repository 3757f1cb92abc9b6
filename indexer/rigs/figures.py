"""Figures: a take of several people becomes one take each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.rigs.mapping import ESSENTIAL, RigMap, map_names, map_rig
from indexer.rigs.topology import children
from indexer.take import Take

#: Joints that a body needs.
_FEWEST = len(ESSENTIAL) + 1
#: Two bodies are one if they are nearer than this, as a share of a body's size.
_SAME = 0.02


def figures(take: Take) -> list[Take]:
    """The people in a take, one take each; the take itself where it has one skeleton, or one that is a body.

    The skeletons are several roots, or hang side by side below one. The second figure is named "2", or "NAME#2" where
    the take has a name. A skeleton that is no body is left out, and so is one that is always where another is, such as
    a control rig.
    """
    trees = _skeletons(take)
    if len(trees) < 2 or not _is_within(take, trees):
        return [take]
    bodies = [(part, rig) for part in _alike([_part(take, tree) for tree in trees]) if (rig := _body(part)) is not None]
    if len(bodies) < 2:
        return [take]
    found = _distinct(bodies)
    names = [take.name, *(f"{take.name}#{number}".lstrip("#") for number in range(2, len(found) + 1))]
    return [replace(figure, name=name) for figure, name in zip(found, names, strict=True)]


def _skeletons(take: Take) -> list[list[int]]:
    """The joints of each skeleton of the size of a body that lies beside others; fewer than two where none does."""
    below = children(take.parents)
    trees: list[list[int]] = [[joint] for joint in range(len(below))]
    for joint in range(len(below) - 1, -1, -1):  # children come after their parents
        for kid in below[joint]:
            trees[joint] += trees[kid]
    level = [joint for joint, parent in enumerate(take.parents.tolist()) if parent < 0]
    while len(large := [joint for joint in level if len(trees[joint]) >= _FEWEST]) == 1:
        level = below[large[0]]
    return [sorted(trees[joint]) for joint in large]


def _part(take: Take, joints: Sequence[int]) -> Take:
    """The take of some of its joints, a whole branch of the tree."""
    number = {joint: index for index, joint in enumerate(joints)}
    parents = [number.get(int(take.parents[joint]), -1) for joint in joints]
    names = tuple(take.names[joint] for joint in joints)
    whole = take.rotations
    return replace(
        take,
        names=names,
        parents=np.array(parents, np.int64),
        rest=take.rest[joints],
        positions=take.positions[:, joints],
        rotations=None if whole is None else lambda: whole()[:, joints],
    )


def _body(take: Take) -> RigMap | None:
    try:
        return map_rig(take, "")
    except UnreadableMotion:
        return None


def _alike(parts: list[Take]) -> list[Take]:
    """The skeletons whose joints are named as a body's; where none is, those with as many joints as the largest.

    By its shape alone a hand beside a body is one as well: fingers are pairs of like chains.
    """
    named = [part for part in parts if set(ESSENTIAL) <= set(map_names(part))]
    most = max(len(part.names) for part in parts)
    return named or [part for part in parts if len(part.names) == most]


def _is_within(take: Take, trees: Sequence[Sequence[int]]) -> bool:
    """Whether no limb of the body that is found in the whole take lies outside the skeletons.

    Else these are parts of one body, such as two hands with all their fingers.
    """
    whole = _body(take)
    inside = {joint for tree in trees for joint in tree}
    return whole is None or all(whole.joints[name] in inside for name in ESSENTIAL)


def _distinct(bodies: Sequence[tuple[Take, RigMap]]) -> list[Take]:
    """The bodies without those that double another."""
    tracks = [take.positions[:, [rig.joints[name] for name in ESSENTIAL]] for take, rig in bodies]
    size = max(float(np.ptp(tracks[0][0], axis=0).max()), 1e-9)
    kept: list[int] = []
    for index, track in enumerate(tracks):
        if all(_distance(track, tracks[other]) >= _SAME * size for other in kept):
            kept.append(index)
    return [bodies[index][0] for index in kept]


def _distance(track: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(track - other, axis=-1).mean())
