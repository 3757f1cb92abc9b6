"""What a joint's name means: its side, and the roles in a body it may stand for.

The words are data (`rigs/joint_names.json`); this file only takes names apart. A stem may stand for several roles:
"shoulder" is the collar bone in one rig and the shoulder joint in another. `mapping` decides between them.
"""

from __future__ import annotations

import json
import re
import unicodedata
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

#: What an offered role costs: a stem that surely means it, one that may mean it, the tip of the bone before.
SURE, MAYBE, TIP = 0.0, 1.0, 2.0

_TOKEN = re.compile(r"[A-Z]+(?![a-z])|[A-Z][a-z]+|[a-z]+|\d+|[^\W\d_a-zA-Z]+")


class JointName(NamedTuple):
    """The meaning of a joint's name.

    Attributes
    ----------
    side : str
        "left", "right" or "".
    roles : dict of str to float
        Roles it may play, with the cost of each.
    is_tip : bool
        It only marks where the bone before it ends.
    """

    side: str
    roles: dict[str, float]
    is_tip: bool


class Vocabulary(NamedTuple):
    """The words of all naming schemes."""

    sides: dict[str, str]
    stems: dict[str, dict[str, float]]
    ignored: frozenset[str]
    ends: frozenset[str]
    affixes: frozenset[str]


@lru_cache(maxsize=1)
def vocabulary() -> Vocabulary:
    """The words of `rigs/joint_names.json`."""
    data = json.loads((files("indexer") / "rigs" / "joint_names.json").read_text(encoding="utf-8"))
    stems: dict[str, dict[str, float]] = {}
    for role, tiers in data["roles"].items():
        for tier, cost in (("maybe", MAYBE), ("sure", SURE)):
            for stem in tiers[tier]:
                stems.setdefault(stem, {})[role] = cost
    sides = {word: side for side, words in data["sides"].items() for word in words}
    return Vocabulary(sides, stems, *(frozenset(data[key]) for key in ("ignored", "ends", "affixes")))


def name_words(name: str) -> list[str]:
    """The words and numbers of a joint name in lower case, without its namespace."""
    plain = unicodedata.normalize("NFKC", re.split(r"[:|]", name)[-1])
    return [token.lower() for token in _TOKEN.findall(plain)]


@lru_cache(maxsize=4096)
def parse_joint_name(name: str) -> JointName:
    """Side and possible roles of a joint name.

    Namespaces ("mixamorig:"), prefixes ("Bip01", "CC_Base_"), numbers, and the way sides are marked ("L_", "_l",
    ".L", "Left", "lThigh") do not matter.
    """
    words_of = vocabulary()
    if name.startswith("__"):  # connectors that MakeHuman puts between a joint and its branches
        return JointName("", {}, False)
    tokens = name_words(name)
    side = next((words_of.sides[token] for token in tokens if token in words_of.sides), "")
    words = [token for token in tokens if token not in words_of.sides and not token.isdigit()]
    is_tip = bool(words) and words[-1] in words_of.ends
    words = [word for word in words if word not in words_of.ends] if is_tip else words
    found = _find(words, side) or _find([word for word in words if word not in words_of.affixes], side)
    return JointName(*(found or (side, {})), is_tip)


def _find(words: list[str], side: str) -> tuple[str, dict[str, float]] | None:
    """Side and roles of the longest ending of a name that is known; what stands before it must not be ignored."""
    words_of = vocabulary()
    for start in range(len(words)):
        found = _stem("".join(words[start:]), side)
        if found:
            return None if words_of.ignored & set(words[:start]) else found
    return None


def _stem(stem: str, side: str) -> tuple[str, dict[str, float]] | None:
    """Side and roles of a stem, where the side may be grown together with it: "lthigh", "leftarm", "thighl"."""
    stems, sides = vocabulary().stems, vocabulary().sides
    if stem in stems:
        return side, stems[stem]
    if not side:
        for word, value in sides.items():
            grown = len(word) > 2 or not word.isascii() or word in ("l", "r")
            for rest in (stem.removeprefix(word), stem.removesuffix(word)):
                if grown and rest != stem and rest in stems:
                    return value, stems[rest]
    return None
