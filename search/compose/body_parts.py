"""Body parts: which joints each has, what they are called, and which a sentence speaks of.

The five parts of STMC (Petrovich et al., CVPRW 2024): both legs are one part, and the root goes with them.
"""

from __future__ import annotations

import re

from encoders.errors import QueryError
from encoders.skeleton import INDEX

#: Part -> the joints whose rotations are its own; the root's way and heading go with the legs.
JOINTS_OF: dict[str, tuple[str, ...]] = {
    "legs": tuple("pelvis left_hip right_hip left_knee right_knee left_ankle right_ankle left_foot right_foot".split()),
    "spine": ("spine1", "spine2", "spine3"),
    "head": ("neck", "head"),
    "left arm": ("left_collar", "left_shoulder", "left_elbow", "left_wrist"),
    "right arm": ("right_collar", "right_shoulder", "right_elbow", "right_wrist"),
}
PARTS = tuple(JOINTS_OF)
ALL = frozenset(PARTS)
INDICES = {part: [INDEX[name] for name in names] for part, names in JOINTS_OF.items()}

#: Other names of a part, and of several.
_ALIASES = {
    "torso": ("spine",),
    "trunk": ("spine",),
    "back": ("spine",),
    "neck": ("head",),
    "leg": ("legs",),
    "left leg": ("legs",),
    "right leg": ("legs",),
    "feet": ("legs",),
    "hips": ("legs",),
    "left hand": ("left arm",),
    "right hand": ("right arm",),
    "arms": ("left arm", "right arm"),
    "hands": ("left arm", "right arm"),
    "upper body": ("spine", "head", "left arm", "right arm"),
    "lower body": ("legs",),
    "all": PARTS,
    "whole body": PARTS,
}
_ARMS = frozenset({"left arm", "right arm"})
_UPPER = frozenset({"spine", "head"})
#: What a sentence says -> the parts that it speaks of; the first that fits.
_WORDS = tuple(
    (re.compile(pattern, re.IGNORECASE), parts)
    for pattern, parts in (
        (r"\b(both|two) (hands|arms)|\bclap|\b(his|her|their|the) (hands|arms)\b|\barms\b|\bshrug|\bcross", _ARMS),
        (r"\bleft[- ](hand|arm|elbow|wrist|fist|shoulder)|\b(hand|arm)s? to the left", frozenset({"left arm"})),
        (r"\bright[- ](hand|arm|elbow|wrist|fist|shoulder)|\b(hand|arm)s? to the right", frozenset({"right arm"})),
        (
            r"\b(nod(s|ding)?|shakes? (his|her|their|the)? ?head|look(s|ing)?|turns? (his|her|their|the) head|head)\b",
            {"head"},
        ),
        (r"\b(bow|bend|lean|twist)(s|ing)?\b", _UPPER),
        (r"\b(wav(e|es|ing)|point|salut|throw|catch|punch|drink|eat|phone|call|knock|wip|beckon|greet)", {"right arm"}),
    )
)
_LEGS = re.compile(
    r"\b(walk|run|jog|jump|hop|leap|kick|step|squat|kneel|sit|stand|turn|march|danc|skip|crawl|climb|lie|lying|crouch|"
    r"lung|stomp|tiptoe|stroll|sprint|spin|circle|backwards?|forwards?|cartwheel|fall|get(s|ting)? up|limp|stagger|"
    r"legs?|foot|feet|knees?)",
    re.IGNORECASE,
)
_TURNED_HEAD = re.compile(r"\bturns? (his|her|their|the) head", re.IGNORECASE)


def parts_named(names: list[str]) -> frozenset[str]:
    """The parts that names mean, aliases among them.

    Raises
    ------
    QueryError
        If a name means no part.
    """
    found: set[str] = set()
    for name in names:
        plain = " ".join(name.lower().replace("_", " ").split())
        if plain not in PARTS and plain not in _ALIASES:
            raise QueryError(f"{name!r} is no body part; parts are {', '.join(PARTS)}")
        found |= {plain} if plain in PARTS else set(_ALIASES[plain])
    return frozenset(found)


def parts_of(sentence: str) -> frozenset[str]:
    """The parts that a sentence speaks of: all where it speaks of legs, or of none."""
    if _LEGS.search(_TURNED_HEAD.sub("", sentence)):
        return ALL
    return next((frozenset(parts) for pattern, parts in _WORDS if pattern.search(sentence)), ALL)
