"""Which joint of a file is which joint of the body: names first, the shape of the tree where they tell nothing.

A rig names a limb's joints in its own way, but always in order from the trunk to the tip. So each name only
proposes roles ("shoulder" may be the collar bone or the shoulder joint), and the best assignment along a path
of the tree that keeps the order decides.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnknownRig
from indexer.readers.take import Take

LEG = ("hip", "knee", "ankle", "toe")
ARM = ("collar", "shoulder", "elbow", "wrist")
TRUNK = ("neck", "head")
ESSENTIAL = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist", "head")

_SURE, _MAYBE, _TIP = 0.0, 1.0, 2.0
_WORTH = {role: 10.0 if role in ESSENTIAL else 4.0 for role in LEG + ARM + TRUNK}


class Name(NamedTuple):
    """A joint's name, understood: its side and the roles it may play, with a cost each."""

    side: str
    roles: dict[str, float]
    is_tip: bool


@dataclass
class RigMap:
    """Where the body's joints are found in a take.

    Attributes
    ----------
    joints : dict
        Landmark ("left_hip", "neck", ...) to joint number.
    spine : list of int
        Joints between the legs' and the arms' branching, upwards.
    """

    joints: dict[str, int]
    spine: list[int] = field(default_factory=list)

    @property
    def missing(self) -> list[str]:
        """Landmarks without which no body can be built."""
        need = [f"{side}_{role}" for role in ESSENTIAL[:-1] for side in ("left", "right")]
        lacking = [name for name in need if name not in self.joints]
        return lacking if {"neck", "head"} & set(self.joints) else [*lacking, "head"]


@lru_cache(maxsize=1)
def _vocabulary() -> tuple[dict[str, str], dict[str, dict[str, float]], frozenset[str], frozenset[str], frozenset[str]]:
    data = json.loads((files("indexer") / "rigs" / "names.json").read_text(encoding="utf-8"))
    sides = {word: side for side, words in data["sides"].items() for word in words}
    stems: dict[str, dict[str, float]] = {}
    for role, tiers in data["roles"].items():
        for tier, cost in (("maybe", _MAYBE), ("sure", _SURE)):
            for stem in tiers[tier]:
                stems.setdefault(stem, {})[role] = cost
    return sides, stems, frozenset(data["ignored"]), frozenset(data["ends"]), frozenset(data["affixes"])


_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z][a-z]+|[a-z]+|\d+|[^\W\d_a-zA-Z]+")


def understand(name: str) -> Name:
    """Side and possible roles of a joint name."""
    sides, stems, ignored, ends, affixes = _vocabulary()
    tokens = [token.lower() for token in _WORD.findall(re.split(r"[:|]", name)[-1])]
    side = next((sides[token] for token in tokens if token in sides), "")
    words = [token for token in tokens if token not in sides and not token.isdigit()]
    if name.startswith("__"):  # connectors that MakeHuman puts between a joint and its branches
        return Name(side, {}, False)
    is_tip = bool(words) and words[-1] in ends
    words = [word for word in words if word not in ends] if is_tip else words
    for start in range(len(words)):
        stem = "".join(words[start:])
        if stem in stems:
            return Name(side, stems[stem], is_tip)
        if not side and stem[:1] in ("l", "r") and stem[1:] in stems:
            return Name(sides[stem[0]], stems[stem[1:]], is_tip)
        for word, value in sides.items():
            if not side and len(word) > 2 and stem.startswith(word) and stem[len(word) :] in stems:
                return Name(value, stems[stem[len(word) :]], is_tip)
    if ignored & set(words):
        return Name(side, {}, is_tip)
    stripped = [word for word in words if word not in affixes]
    for start in range(len(stripped)):
        if "".join(stripped[start:]) in stems:
            return Name(side, stems["".join(stripped[start:])], is_tip)
    return Name(side, {}, is_tip)


def map_rig(take: Take, path: str | PathLike[str], joint_map: dict[str, str] | None = None) -> RigMap:
    """The body in a take.

    Raises
    ------
    UnknownRig
        If a joint without which no body can be built is not found.
    """
    rig = map_names(take)
    if rig.missing:
        raise UnknownRig(path, rig.missing)
    rig.spine = spine_between(take, rig.joints)[1:]
    return rig


def map_names(take: Take) -> RigMap:
    """Landmarks by joint names alone; may be incomplete."""
    names = [understand(name) for name in take.names]
    joints: dict[str, int] = {}
    paths = _paths(take.parents)
    for side in ("left", "right"):
        for limb in (LEG, ARM):
            joints.update({f"{side}_{role}": j for role, j in _best(paths, names, limb, side).items()})
    joints.update(_best(paths, names, TRUNK, ""))
    return RigMap(joints)


def _paths(parents: NDArray[np.int64]) -> list[list[int]]:
    """Each way from a root to a leaf."""
    leaves = sorted(set(range(len(parents))) - set(parents.tolist()))
    return [ancestry(parents, leaf)[::-1] for leaf in leaves]


def ancestry(parents: NDArray[np.int64], joint: int) -> list[int]:
    """The joint and its parents up to the root."""
    chain = [joint]
    while parents[chain[-1]] >= 0:
        chain.append(int(parents[chain[-1]]))
    return chain


def _best(paths: Sequence[Sequence[int]], names: Sequence[Name], roles: Sequence[str], side: str) -> dict[str, int]:
    """The most valuable assignment of a limb's roles along any path."""
    found = [_assign(path, names, roles, side) for path in paths]
    return max(found, key=lambda x: x[0])[1] if found else {}


def _assign(
    path: Sequence[int], names: Sequence[Name], roles: Sequence[str], side: str
) -> tuple[float, dict[str, int]]:
    """Roles to joints, both in order, by dynamic programming over (joints seen, roles used)."""
    best: list[tuple[float, dict[str, int]]] = [(0.0, {})] + [(-np.inf, {})] * len(roles)
    previous: dict[str, float] = {}
    for joint in path:
        name = names[joint]
        offers = name.roles if name.side == side else {}
        if name.is_tip:
            offers = {_next(roles, role): _TIP for role in previous if _next(roles, role)}
        else:
            previous = offers or previous
        for k in range(len(roles), 0, -1):
            role = roles[k - 1]
            if role not in offers:
                continue
            gain = _WORTH[role] - offers[role]
            score, chosen = max(best[:k], key=lambda x: x[0])
            if score + gain > best[k][0]:
                best[k] = (score + gain, {**chosen, role: joint})
    return max(best, key=lambda x: x[0])


def _next(roles: Sequence[str], role: str) -> str:
    at = roles.index(role) + 1 if role in roles else len(roles)
    return roles[at] if at < len(roles) else ""


def spine_between(take: Take, joints: dict[str, int]) -> list[int]:
    """Joints on the way from where the legs part to where the arms part, upwards, both included."""
    low = _meeting(take.parents, joints["left_hip"], joints["right_hip"])
    high = _meeting(take.parents, joints["left_shoulder"], joints["right_shoulder"])
    down, up = ancestry(take.parents, low), ancestry(take.parents, high)
    shared = next((j for j in down if j in up), None)
    if shared is None:
        return []
    return down[: down.index(shared)] + up[: up.index(shared) + 1][::-1]


def _meeting(parents: NDArray[np.int64], a: int, b: int) -> int:
    above = ancestry(parents, b)
    return next((j for j in ancestry(parents, a) if j in above), a)
