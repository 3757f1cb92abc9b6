"""Verb rules: a verb with the words around it, as an action step. The rules are data: `phrases/verbs.json`.

A rule is [pattern, action, conditions]: the pattern must match all words that `attributes` leaves of the clause; an
action of null marks what cannot be synthesised. Conditions set fields or require something (`need`).
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cache

from encoders.corpus.actions.programs import programs
from encoders.corpus.engine.program import Program
from encoders.corpus.language.attributes import ClauseAttributes
from encoders.corpus.language.lexicon import PHRASES, entry_of
from encoders.corpus.scene import ActionStep
from encoders.english import NUMBER_VALUES, gerund, past, third_person

_PARTICIPLES = {
    "raise": ["risen"], "rise": ["risen"], "throw": ["thrown"], "run": ["run"], "go": ["gone"], "take": ["taken"],
    "lie": ["lied", "laying"], "swing": ["swinged"], "kneel": ["kneeled"], "leap": ["leaped"], "creep": ["creeped"],
    "jog": ["joging"], "bend": ["bended"], "wave": ["waiving", "waives"], "catch": ["catchs"],
    "crouch": ["crouchs"], "punch": ["punchs"], "sit": ["siting"], "put": ["puting"], "step": ["steping"],
}  # fmt: skip
_NEVER_VERBS = frozenset(
    {"hand", "hands", "head", "back", "face", "box", "place", "bat", "rest", "light", "rock", "shoulder", "down",
     "right", "left", "circle", "golf", "steps", "step", "button", "iron", "row", "fish"}
)  # fmt: skip
_LEG = ("leg", "foot", "knee", "heel", "toe", "thigh", "ankle")
_FORWARD_ANYWAY = frozenset({"forward", "in place"})  # directions that an action without directions implies
_BY_PLACE = frozenset({"pick up", "put down", "sit down", "sit", "stand up"})  # actions for which the floor is a height
_WITH_NOUNS = frozenset({"pick up", "put down", "pour", "drink"})  # actions whose verb any noun may follow


@cache
def rules() -> dict[str, tuple[tuple[re.Pattern[str], str | None, dict[str, str]], ...]]:
    """Lemma -> its rules, in order of precedence."""
    loaded = json.loads((PHRASES / "verbs.json").read_text(encoding="utf-8"))
    return {
        lemma: tuple((re.compile(rule[0]), rule[1], rule[2] if len(rule) > 2 else {}) for rule in entries)
        for lemma, entries in loaded.items()
    }


@cache
def lemmas() -> dict[str, str]:
    """Every form of every known verb -> its base form."""
    found: dict[str, str] = {}
    for lemma in rules():
        for form in (lemma, third_person(lemma), gerund(lemma), past(lemma), *_PARTICIPLES.get(lemma, ())):
            found.setdefault(form, lemma)
    found.update({"lays": "lay", "laid": "lay", "lying": "lie", "left": "", "saw": "look", "felt": "feel", "wound": ""})
    return {form: lemma for form, lemma in found.items() if lemma}


def is_verb(word: str) -> bool:
    """Whether a word after "and" starts a new clause."""
    return word in lemmas() and (word not in _NEVER_VERBS)


@dataclass(frozen=True)
class ClauseContext:
    """The state before a clause: the posture and the previous action ("" at the start)."""

    posture: str = ""
    action: str = ""
    turned: bool = False


def _needs_met(need: str, clause: str, found: ClauseAttributes, context: ClauseContext) -> bool:
    sides = [side for _, side in found.limbs]
    one = any(side in ("left", "right") for side in sides) or " one " in f" {clause} "
    return {
        "": True,
        "direction": "direction" in found.fields,
        "oneleg": one and "both" not in sides,
        "both": "both" in sides,
        "nodirection": found.fields.get("direction", "forward") == "forward",
        "leftright": found.fields.get("direction") in ("left", "right"),
        "around": found.fields.get("direction") in ("around", "clockwise", "counterclockwise", "forward", "backward"),
        "diagonal": found.fields.get("direction", "forward") in ("forward", "left", "right"),
        "front": found.front or found.fields.get("direction") == "forward",
        "nosideboth": "both" not in sides[:1],
        "nofoot": all(limb not in ("foot", "leg", "knee", "elbow") for limb, _ in found.limbs),
        "floor": context.posture == "floor",
        "ground": found.fields.get("height") == "floor" or bool(re.search(r"\b(?:lying|laying|bed)\b", clause)),
        "lying": context.posture in ("", "floor") and bool(re.search(r"\b(?:lying|laying)\b(?! down)", clause)),
        "crossed": {"left", "right"} <= set(sides) or bool(re.search(r"\b(?:opposite|other)\b", clause)),
        "walkish": context.action == "walk"
        or "rope" in clause
        or "beam" in clause
        or "line" in clause
        or "walk" in clause,
        "sideno": True,
        "turned": context.turned,
        "never": False,
    }.get(need, True)


def _count(found: ClauseAttributes, program: Program) -> int | None:
    """The count of the step, 0 if unspecified, None if the program does not support it."""
    named = int(found.fields.get("count", 0))
    if found.several and not named:
        return min(max(3, program.counts[0]), program.counts[1]) if program.counts else None
    if not named:
        return 0
    if program.counts and program.counts[0] <= named <= program.counts[1]:
        return named
    return 0 if named == 1 and not program.counts else None


def _direction(found: ClauseAttributes, program: Program) -> str | None:
    direction = found.fields.get("direction", "")
    if not direction or direction in program.directions:
        return direction
    if direction == "side to side" and "back and forth" in program.directions and program.name in ("sidestep", "sway"):
        return "back and forth"
    if direction in _FORWARD_ANYWAY and not program.directions:
        return ""
    return "" if direction == "in place" and program.group != "locomotion" else None


def _side(found: ClauseAttributes, program: Program) -> str | None:
    """The side of the limb that acts; None if the program uses another limb or not that side."""
    entry = entry_of(program.name)
    named = [(limb, side) for limb, side in found.limbs if side] or [("", "")]
    limb, side = next((pair for pair in named if entry is not None and pair[0] == entry.limb), named[0])
    if not side or (side == "both" and not program.sides):
        return ""
    by_leg = entry is not None and entry.limb in _LEG
    return side if side in program.sides and by_leg == (limb in _LEG) else None


def _legal(action: str, fields: dict[str, str], found: ClauseAttributes) -> ActionStep | None:
    """The step of an action with the clause's attributes; None if the program does not support one of them."""
    program = programs().get(action)
    if program is None:
        return None
    if fields.get("need") == "diagonal":
        way = found.fields.get("direction", "")
        found.fields["direction"] = "forward-right" if way == "right" else "forward-left"
    if fields.get("need") == "around" and found.fields["direction"] in ("around", "clockwise", "counterclockwise"):
        del found.fields["direction"]  # the sense of rotation is no direction of the program
    found.fields |= {name: value for name, value in fields.items() if name not in ("need", "arm", "spin", "lying")}
    if found.fields.get("height") == "high" and not program.heights and "up" in program.directions:
        found.fields.pop("height")  # "stretches the arms above the head"
        found.fields.setdefault("direction", "up")
    count, direction, side = _count(found, program), _direction(found, program), _side(found, program)
    if count is None or direction is None or side is None:
        return None
    height, amplitude = found.fields.get("height", ""), found.fields.get("amplitude", "")
    if height == "floor":
        height = "low" if action in _BY_PLACE else ""
    if height and height not in program.heights:
        if height != "middle":
            return None
        height = ""
    if amplitude == "slight":  # "walks slightly right" is no small step
        if program.group == "locomotion":
            return None
        amplitude = "small"
    speed, style, degrees = (found.fields.get(name, "") for name in ("speed", "style", "degrees"))
    if degrees == "360" and "clockwise" in program.directions and program.counts:
        count, degrees = count or 1, ""  # "spins 360 degrees"
    if degrees and int(degrees) not in program.degrees:
        return None
    if (amplitude and amplitude not in program.amplitudes) or (speed and speed not in program.speeds):
        return None
    if style and not program.styled:
        return None
    return ActionStep(action, side, direction, speed, amplitude, count, style, height, int(degrees or 0))


_COMPARISON = re.compile(r" ?(?:as if|as though|like|as) (?:[a-z']+ ?){1,8}$")
_COMPARABLE = frozenset({"gesture", "object", "sport"})  # but not "talk", which may be any gesture


def _without_comparison(rest: str) -> tuple[str, bool]:
    """The words before a comparison ("as if ...") and whether there was one: it does not change a gesture."""
    match = _COMPARISON.search(rest)
    if match is None or re.search(r"\b(?:hand|arm|leg|foot|left|right|head)\b", match[0]):
        return rest, False
    return rest[: match.start()].strip(), True


def _runs_on(rest: str) -> bool:
    """Whether a second verb follows without a conjunction: "picks up a cup pours a drink"."""
    return " and " not in rest and any(is_verb(word) and lemmas()[word] != word for word in rest.split())


def _pronoun_is_limb(action: str, clause: str, context: ClauseContext) -> bool:
    """Whether the object is only "it" or "them" and no object was handled before, so that a limb is meant."""
    if action not in ("lift", "put down", "carry", "pull") or not re.search(r"\b(?:it|them)\b", clause):
        return False
    before = programs().get(context.action)
    return before is None or before.group not in ("object", "sport")


def _take_number(lemma: str, found: ClauseAttributes) -> None:
    """Move the number of "does three kicks" to the count, in place."""
    number, _, rest = found.rest.partition(" ")
    value = NUMBER_VALUES.get(number, int(number) if number.isdecimal() else 0)
    if lemma in _LIGHT and value and rest and "count" not in found.fields:
        found.fields["count"], found.rest = str(value), rest


def step_of(lemma: str, clause: str, found: ClauseAttributes, context: ClauseContext) -> ActionStep | None:
    """The step for a verb and its attributes; None if no rule matches or the program does not support them."""
    _take_number(lemma, found)
    plain, compared = (
        _without_comparison(found.rest) if lemma not in ("look", "appear", "seem") else (found.rest, False)
    )
    for rest, mimed in ((found.rest, False), *([(plain, True)] if compared else [])):
        for pattern, action, conditions in rules().get(lemma, ()):
            program = programs().get(action or "")
            if (program is None and action is not None) or (
                mimed and (program is None or program.group not in _COMPARABLE or action == "talk")
            ):
                continue  # an unknown program, or one that a comparison would change
            if pattern.fullmatch(rest) and _needs_met(conditions.get("need", ""), clause, found, context):
                if (
                    action is None
                    or (action in _WITH_NOUNS and _runs_on(rest))
                    or _pronoun_is_limb(action, clause, context)
                ):
                    return None
                return _legal(action, dict(conditions), found)
    return None


def matches_some_rule(lemma: str, found: ClauseAttributes) -> bool:
    """Whether some rule of the verb matches these words, regardless of the attributes."""
    if not rules().get(lemma):
        return False
    if lemma not in _LIGHT:
        return True
    return any(
        action is not None
        and (
            pattern.fullmatch(found.rest) or (pattern.pattern and re.search(rf"\b(?:{pattern.pattern})\b", found.rest))
        )
        for pattern, action, _ in rules()[lemma]
    )


_LIGHT = frozenset(
    {"do", "make", "perform", "take", "play", "have", "give", "get", "practice", "complete", "execute", "hold"}
)
