"""The attributes of a clause (direction, side, speed, count, style, height, amplitude), extracted from its words."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cache

from encoders.corpus.language.lexicon import modifiers
from encoders.corpus.language.normalisation import patterns
from encoders.english import NUMBER_VALUES

_HIS = r"(?:the|his|her|their|its|there|own|a|one'?s?)"
_LIMB = (
    r"(hand|arm|leg|foot|feet|knee|elbow|shoulder|fist|palm|wrist|finger|hip|thigh|ankle|ear|forearm|index finger|heel"
    r"|toe)"
)
_SINGULAR = {"feet": "foot", "index finger": "finger"}


@cache
def _patterns() -> tuple[tuple[re.Pattern[str], str, str], ...]:
    """(pattern, field, value) in order of extraction; "{1}" stands for the pattern's first group."""
    return tuple((re.compile(pattern), name, value) for pattern, name, value in patterns()["attributes"])


_LIMBS = re.compile(
    rf"\b(with |using |by |on )?"
    rf"((?:{_HIS} |both |each |of |left |right |left-handed |right-handed |extended |outstretched )*)"
    rf"{_LIMB}(s?)\b(?! (?:level|height))"
)


@cache
def _styles() -> tuple[re.Pattern[str], dict[str, str]]:
    """A pattern of all style phrases, longest first, and phrase -> style."""
    phrases: dict[str, str] = dict(patterns()["styles"])
    for style, places in modifiers()["style"].items():
        for phrase in [*places.get("adverb", []), *places.get("after", [])]:
            if "{" not in phrase:
                phrases.setdefault(phrase, style)
    longest_first = sorted(phrases, key=len, reverse=True)
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, longest_first))})\b"), phrases


@dataclass
class ClauseAttributes:
    """The attributes extracted from a clause, and the remaining words.

    Attributes
    ----------
    fields : dict
        Field of a step -> value, as text.
    limbs : list of (str, str)
        Body parts in order of mention, singular, with their sides.
    rest : str
        The remaining words, without articles and possessives.
    front, several, unsure : bool
        Whether "in front" and "several times" occurred; whether something cannot be synthesised.
    """

    fields: dict[str, str] = field(default_factory=dict)
    limbs: list[tuple[str, str]] = field(default_factory=list)
    rest: str = ""
    front: bool = False
    several: bool = False
    unsure: bool = False


def _take_limbs(text: str, found: ClauseAttributes) -> str:
    def taken(match: re.Match[str]) -> str:
        by, owner, name, plural = match[1] or "", match[2], match[3], match[4]
        sides = {side for side in ("left", "right") if side in owner}
        many = bool(plural) or name == "feet" or "both" in owner
        side = "both" if many or len(sides) == 2 else next(iter(sides), "")
        noun = _SINGULAR.get(name, name)
        found.limbs.append((noun, side))
        instrument = by.strip() in ("with", "using", "by") and noun in (
            "hand",
            "arm",
            "foot",
            "leg",
            "fist",
            "elbow",
            "knee",
            "finger",
        )
        return " " if instrument else f" {by.strip()} {noun} "

    return " ".join(_LIMBS.sub(taken, text).split())


_SMALL_WORDS = re.compile(
    r"\b(?:the|a|an|his|her|their|its|this|that|own|some|of|very|really|there|just|also|then|again|theirs|quite|even)\b|,"
)
_OBJECT = re.compile(
    r"\b(?:small |large |big |invisible |imaginary )?(?:something|objects?|items?|things?|anything|stuff|it|them)\b"
)


def extract_attributes(clause: str) -> ClauseAttributes:
    """The attributes of a normalised clause without its subject and verb."""
    found = ClauseAttributes()
    text = f" {clause} "
    style_pattern, styles = _styles()
    for phrase in style_pattern.findall(text):
        found.fields["style"] = styles[phrase]
    text = style_pattern.sub(" ", text)
    text = _take_limbs(text, found)
    for pattern, name, value in _patterns():
        match = pattern.search(text)
        if match is None:
            continue
        text = pattern.sub(" ", text, count=1)
        if name in ("unsure", "front", "several"):
            setattr(found, name, True)
        elif name != "nothing":
            if name in found.fields and found.fields[name] != value:
                if name == "direction" and {found.fields[name], value} <= {
                    "forward",
                    "in place",
                    "around",
                    "up",
                    "down",
                }:
                    continue
                found.unsure = True
            found.fields[name] = value.replace("{1}", match[1] if match.groups() and match[1] else "")
    if "count" in found.fields:
        number = found.fields["count"]
        found.fields["count"] = str(NUMBER_VALUES.get(number, number))
    found.rest = " ".join(_OBJECT.sub("obj", _SMALL_WORDS.sub(" ", text)).split())
    return found
