"""The body in a skeleton whose names do not help: two pairs of similar chains, one of them with a head above.

Legs and arms are pairs of chains of like bones that part from one joint; the legs' joint lies nearer to the
root. In each chain the two longest bones in a row are the limb's. The side follows from where the body
faces: toes lie ahead of ankles, else knees ahead of the line from hip to ankle.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np

from encoders.geometry import Array
from indexer.rigs.topology import ancestry, children, meeting
from indexer.take import Take

_LIKENESS = 0.25  # how far bones of a pair may differ in length, as a share
_NEARLY = 0.8  # as a share of the longest
_TIP = 1.3  # how much longer than the bone before a head's is, at least
_FRAMES = 200  # enough to tell the sides and what bends


class _Pair(NamedTuple):
    """Two like chains (joint numbers from the trunk outwards) that part from a joint."""

    branch: int
    chains: tuple[list[int], list[int]]
    length: float


def map_shape(take: Take) -> dict[str, int]:
    """Landmarks by the shape of the tree and the pose in it; empty where there is no body."""
    positions = take.positions[:: max(len(take.positions) // _FRAMES, 1)]
    lengths = _bone_lengths(take, positions)
    pairs = _limbs(take, lengths)
    if pairs is None:
        return {}
    legs, arms = pairs[0], _same_order(pairs[0], pairs[1], positions)
    marks: list[dict[str, int]] = [{}, {}]
    for pair, names in (
        (legs, ("", "hip", "knee", "ankle", "toe")),
        (arms, ("collar", "shoulder", "elbow", "wrist", "")),
    ):
        at = _root_of_limb(pair.chains, lengths)
        for mark, chain in zip(marks, pair.chains, strict=True):
            mark.update(
                {name: chain[at - 1 + k] for k, name in enumerate(names) if name and 0 <= at - 1 + k < len(chain)}
            )
    head = _head(take, arms.branch, [chain[0] for chain in arms.chains], legs.branch, lengths)
    if not head:
        return {}
    joints: dict[str, int] = dict(head)
    for side, mark in zip(_sides(positions, marks, head["head"]), marks, strict=True):
        joints.update({f"{side}_{name}": joint for name, joint in mark.items()})
    return joints


def head_above(take: Take, joints: Mapping[str, int]) -> dict[str, int]:
    """Neck and head by the shape of the tree, where the limbs are known."""
    top = meeting(take.parents, joints["left_shoulder"], joints["right_shoulder"])
    low = meeting(take.parents, joints["left_hip"], joints["right_hip"])
    if top is None or low is None:
        return {}
    lengths = _bone_lengths(take, take.positions[:1])
    return _head(take, top, [joints["left_shoulder"], joints["right_shoulder"]], low, lengths)


def _bone_lengths(take: Take, positions: Array) -> Array:
    """Length (J,) of the bone that ends at each joint."""
    bones = np.median(np.linalg.norm(positions - positions[:, take.parents], axis=-1), axis=0)
    lengths: Array = np.where(take.parents < 0, 0.0, bones)
    return lengths


def _limbs(take: Take, lengths: Array) -> tuple[_Pair, _Pair] | None:
    """Legs and arms: of the pairs of like chains the two longest that do not lie within each other."""
    below = children(take.parents)
    chains = _main_chains(below, lengths)
    pairs = []
    for branch, kids in enumerate(below):
        for a, b in combinations(kids, 2):
            first, second = chains[a], chains[b]
            count = min(len(first), len(second))
            one, other = lengths[first[:count]], lengths[second[:count]]
            size = max(float(one.sum()), float(other.sum()), 1e-9)
            if count >= 3 and np.abs(one - other).sum() < _LIKENESS * size:
                pairs.append(_Pair(branch, (first[:count], second[:count]), float(one[1:].sum())))
    pairs.sort(key=lambda pair: -pair.length)
    for i, pair in enumerate(pairs):
        inside = {joint for chain in pair.chains for joint in chain}
        for other_pair in pairs[i + 1 :]:
            members = {joint for chain in other_pair.chains for joint in chain}
            if not (members & inside or inside & set(ancestry(take.parents, other_pair.branch))) and (
                other_pair.length > pair.length / 3
            ):
                depth = [len(ancestry(take.parents, p.branch)) for p in (pair, other_pair)]
                return (pair, other_pair) if depth[0] <= depth[1] else (other_pair, pair)
    return None


def _main_chains(below: list[list[int]], lengths: Array) -> list[list[int]]:
    """From each joint the longest way outwards."""
    chains: list[list[int]] = [[] for _ in below]
    for joint in range(len(below) - 1, -1, -1):  # children come after their parents
        ways = [chains[kid] for kid in below[joint]]
        chains[joint] = [joint, *max(ways, key=lambda way: float(lengths[way].sum()), default=[])]
    return chains


def _same_order(legs: _Pair, arms: _Pair, positions: Array) -> _Pair:
    """The arms in the order of the legs: an arm is on the side of the leg it begins over."""
    first, second = arms.chains
    at = positions[:, [*legs.chains[0][:2], *legs.chains[1][:2], *first[:2], *second[:2]]]
    leg, other_leg, arm, other_arm = (at[:, k : k + 2].mean(axis=1) for k in (0, 2, 4, 6))
    same = float(((leg - other_leg) * (arm - other_arm)).sum()) > 0
    return arms if same else arms._replace(chains=(second, first))


def _root_of_limb(chains: tuple[list[int], list[int]], lengths: Array) -> int:
    """Where in two like chains the limb begins: the last place from which two bones are nearly the longest two.

    The last, because a collar bone may be as long as a forearm.
    """
    bones = lengths[list(chains)].sum(axis=0)[1:]
    reach = bones[:-1] + bones[1:]
    return int(np.flatnonzero(reach > _NEARLY * reach.max())[-1])


def _head(take: Take, top: int, arms: list[int], low: int, lengths: Array) -> dict[str, int]:
    """Neck and head: the longest way up from where the arms part, away from arms and legs."""
    below = children(take.parents)
    chains = _main_chains(below, lengths)
    taken = {joint for end in (*arms, low) for joint in ancestry(take.parents, end)}
    kids = [kid for kid in below[top] if kid not in taken]
    if not kids:
        return {}
    chain = max((chains[kid] for kid in kids), key=lambda way: float(lengths[way].sum()))
    is_tip = len(chain) > 2 and lengths[chain[-1]] > _TIP * lengths[chain[-2]]  # skulls are longer than necks
    if len(chain) > 1 and (is_tip or take.names[chain[-1]].endswith("_end")):
        chain = chain[:-1]
    return {"neck": chain[0], "head": chain[-1]} if len(chain) > 1 else {"head": chain[0]}


def _sides(positions: Array, marks: list[dict[str, int]], head: int) -> tuple[str, str]:
    """Which of two halves of a body is the left one: up x ahead points left."""
    hips = (positions[:, marks[0]["hip"]] + positions[:, marks[1]["hip"]]) / 2
    ahead = np.zeros_like(hips)
    for mark in marks:
        hip, knee, ankle = (positions[:, mark[name]] for name in ("hip", "knee", "ankle"))
        ahead += knee - (hip + ankle) / 2
        if "toe" in mark:
            ahead += positions[:, mark["toe"]] - ankle
    left = np.cross(positions[:, head] - hips, ahead)
    across = positions[:, marks[0]["hip"]] - positions[:, marks[1]["hip"]]
    return ("left", "right") if float((left * across).sum()) > 0 else ("right", "left")
