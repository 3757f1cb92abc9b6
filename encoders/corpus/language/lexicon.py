"""The phrases for each action, from the data files in `phrases/`.

An action's entry holds `verbs` (verb phrases in base form), `nouns` (labels), `parts` (clauses about one part of the
body), `as_if` (comparisons, as a gerund) and `cases`: further phrases for steps whose fields have the values under
`when`. A case with one value for a field mentions that field; with several it only permits them ("" is unspecified).
`limb` is what the side belongs to: "hand", "arm", "foot", "leg", or "heading". `never_mentioned` lists fields that
captions of the action omit; `modifiers` replaces or adds phrases for a field's values.

Slots in a phrase, filled from the step:

    {hand} {arm} {fist} {elbow} {shoulder} {foot} {leg} {knee} {hip}   with their side
    {side} {other}        the side and its opposite: only for steps with a side
    {dir}                 the direction, nothing if there is none
    {n}                   the count in words: only for steps with a count of two or more
    {n:step}              "a step", "three steps", or "a few steps" where the step has no count
    {p} {self} {they} {they_are} {they_have} {they_were}     in agreement with the subject

The first word is the verb. Otherwise, and for further verbs, verbs are marked "~": "reach out and ~shake hands".
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import Any

from encoders.corpus.scene import ActionStep

PHRASES = Path(__file__).parent / "phrases"
LIMBS = ("hand", "arm", "fist", "elbow", "shoulder", "foot", "leg", "knee", "hip", "heel", "wrist", "palm", "fingers")
_SLOT = re.compile(r"\{(\w+)(?::([^}]+))?\}")
#: Words that imply a field's value: not for steps with another value; enough for steps with this one.
_IMPLIES = {
    ("speed", "fast"): re.compile(r"\b(quick|fast|rapid|hurr|rush|dash|speed|swift|race|bolt|sudden|brisk|snap|zoom)"),
    ("speed", "slow"): re.compile(r"\b(slow|leisure|dawdle|inch|plod|trudge|gentl|softly)"),
    ("amplitude", "large"): re.compile(r"\b(big|wide|deep|far|full force|huge|long stride|as possible|all the way)"),
    ("amplitude", "small"): re.compile(r"\b(small|slight|little|tiny|bit|lightly|half)\b"),
    ("height", "high"): re.compile(r"\b(high|overhead|above|over \{p\} head|towards the ceiling)"),
    ("height", "low"): re.compile(r"\b(low|near the ground)\b"),
}  # fmt: skip
#: The fields of a step that captions can mention, in the order of random draws.
FIELDS = ("side", "direction", "speed", "amplitude", "count", "style", "height", "degrees")


@dataclass(frozen=True)
class Phrase:
    """One phrase for an action.

    Attributes
    ----------
    text : str
        With slots and marked verbs.
    mentions : frozenset of str
        The fields of the step that it mentions; others need modifiers.
    """

    text: str
    mentions: frozenset[str]

    @cached_property
    def implies(self) -> tuple[tuple[str, str], ...]:
        """Pairs of field and value that the words imply."""
        return tuple(pair for pair, words in _IMPLIES.items() if words.search(self.text))

    def mentioned_fields(self, step: ActionStep) -> frozenset[str]:
        """The fields of this step that the phrase mentions."""
        return self.mentions | {field for field, value in self.implies if getattr(step, field) == value}

    @property
    def slots(self) -> frozenset[str]:
        return frozenset(match[1] for match in _SLOT.finditer(self.text))

    def fits(self, step: ActionStep) -> bool:
        """Whether the fields that the slots need are specified and no word contradicts the step."""
        slots = self.slots
        if slots & {"side", "other"} and step.side not in ("left", "right"):
            return False
        if "n" in slots and step.count < 2 and "{n}" in self.text:
            return False
        values = {field: value for field, value in self.implies if field not in self.mentions}
        return all(getattr(step, field) in ("", value) for field, value in values.items())


@dataclass(frozen=True)
class ConditionalPhrases:
    """Phrases for steps whose fields have the values of `when`."""

    when: tuple[tuple[str, tuple[str, ...]], ...]
    phrases: Mapping[str, tuple[Phrase, ...]]

    def fits(self, step: ActionStep) -> bool:
        return all(str(getattr(step, name) or "") in values for name, values in self.when)


@dataclass(frozen=True)
class Entry:
    """All phrases of one action."""

    action: str
    limb: str
    never_mentioned: frozenset[str]
    modifiers: Mapping[str, Any]
    cases: tuple[ConditionalPhrases, ...]

    def phrases(self, kind: str) -> list[Phrase]:
        """Every phrase of a kind ("verbs", "nouns", "parts", "as_if"), whatever the step."""
        return [phrase for case in self.cases for phrase in case.phrases[kind]]


def _mentioned_by_slots(text: str) -> set[str]:
    slots = {match[1] for match in _SLOT.finditer(text)}
    mentioned = set()
    if slots & {*LIMBS, "side", "other"}:
        mentioned.add("side")
    if "dir" in slots:
        mentioned.add("direction")
    if "n" in slots:
        mentioned.add("count")
    return mentioned


def _case(when: Mapping[str, Any], body: Mapping[str, Any]) -> ConditionalPhrases:
    values = {name: tuple(v) if isinstance(v, list) else (str(v),) for name, v in when.items()}
    unknown = set(values) - set(FIELDS)
    if unknown:
        raise ValueError(f"phrases: no field {sorted(unknown)} in a step")
    mentioned = {name for name, v in values.items() if len(v) == 1 and v[0]} | set(body.get("mentions", ()))
    return ConditionalPhrases(
        when=tuple(values.items()),
        phrases={
            kind: tuple(Phrase(text, frozenset(mentioned | _mentioned_by_slots(text))) for text in body.get(kind, ()))
            for kind in ("verbs", "nouns", "parts", "as_if")
        },
    )


@cache
def entries() -> Mapping[str, Entry]:
    """Action name -> its entry, from every file of actions."""
    found: dict[str, Entry] = {}
    for path in sorted(PHRASES.glob("actions_*.json")):
        for action, body in json.loads(path.read_text(encoding="utf-8")).items():
            if action in found:
                raise ValueError(f"phrases: {action} is described twice, again in {path.name}")
            found[action] = Entry(
                action=action,
                limb=body.get("limb", "hand"),
                never_mentioned=frozenset(body.get("never_mentioned", ())),
                modifiers=body.get("modifiers", {}),
                cases=(_case({}, body), *(_case(case["when"], case) for case in body.get("cases", ()))),
            )
    return found


def entry_of(action: str) -> Entry | None:
    """The entry of an action, whether its name is written with spaces, hyphens or underscores; None without one."""
    return entries().get(action.replace(" ", "_").replace("-", "_"))


@cache
def modifiers() -> Mapping[str, Mapping[str, Mapping[str, list[str]]]]:
    """Field -> value -> position ("adverb", "after", "adjective") -> phrases."""
    loaded: dict[str, dict[str, dict[str, list[str]]]] = json.loads(
        (PHRASES / "modifiers.json").read_text(encoding="utf-8")
    )
    return loaded


def modifier(action: str, field: str, value: str) -> Mapping[str, list[str]]:
    """Position -> phrases for a field's value: the action's own, else the general ones."""
    entry = entry_of(action)
    own: Mapping[str, Mapping[str, list[str]]] = entry.modifiers.get(field, {}) if entry else {}
    if value in own:
        return own[value]
    return modifiers().get(field, {}).get(value, {})


@lru_cache(maxsize=20000)
def phrases_for(step: ActionStep, kind: str) -> tuple[tuple[Phrase, ...], ...]:
    """The phrases of a kind that fit `step`, one tuple per case, special cases first.

    Raises
    ------
    KeyError
        For an action without an entry.
    """
    entry = entry_of(step.action)
    if entry is None:
        raise KeyError(step.action)
    groups = []
    for case in reversed(entry.cases):
        if case.fits(step):
            fitting = tuple(phrase for phrase in case.phrases[kind] if phrase.fits(step))
            if fitting:
                groups.append(fitting)
    return tuple(groups)
