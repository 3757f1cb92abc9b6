"""Amounts that a sentence asks for: how often something is done, and by how many degrees somebody turns."""

from __future__ import annotations

import re
from dataclasses import dataclass

from search.query.languages import understood_language_of
from search.translation.concepts import concept_names, concepts_of

_NUMBERS = {word: number for number, word in enumerate("one two three four five six seven eight nine ten".split(), 1)}
_NUMBER = rf"(?P<number>\d{{1,3}}|{'|'.join(_NUMBERS)})"
_ADVERBS = {"once": 1, "twice": 2, "thrice": 3}
_COUNTED = (
    "times|squats|jumps|hops|kicks|punches|claps|push-?ups|sit-?ups|jumping jacks|bows|nods|lunges|cartwheels|"
    "somersaults|spins|twirls|pirouettes|(?:full )?(?:turns|rotations|circles)"
)
_TIMES = re.compile(rf"\b(?:{_NUMBER}\s+(?:{_COUNTED})|(?P<adverb>{'|'.join(_ADVERBS)}))\b", re.IGNORECASE)
_TURNING = re.compile(r"\b(?:turn|spin|spun|rotat|pivot|twirl|whirl|revolv|pirouett)", re.IGNORECASE)
_WHOLE_TURNS = re.compile(r"\b(?:spin|spun|twirl|whirl|pirouett|full (?:turn|rotation|circle))", re.IGNORECASE)
_DEGREES = re.compile(
    r"(?P<number>\d{2,4})[\s-]*(?:°|degrees?|deg\b|grad|degrés|grados|gradi|graus|graden|stopni|градус|derece|درجة|度|도|องศา)",
    re.IGNORECASE,
)
_PARTS = (
    (re.compile(r"\bthree[- ]quarters?\b.*\bturn|\bturns? three[- ]quarters?\b", re.IGNORECASE), 270.0),
    (re.compile(r"\bquarter[- ]turn|\bturns? a quarter\b", re.IGNORECASE), 90.0),
    (re.compile(r"\bhalf[- ](?:a )?(?:turn|rotation|circle)|\bturns? half", re.IGNORECASE), 180.0),
    (
        re.compile(r"\b(?:full|whole|complete)[- ](?:turn|rotation|spin|circle)|\ball the way around", re.IGNORECASE),
        360.0,
    ),
)
_LEFT = re.compile(r"\b(?:left|counter-?clockwise|anti-?clockwise)", re.IGNORECASE)
_RIGHT = re.compile(r"\b(?:right|(?<!counter)(?<!counter-)(?<!anti)(?<!anti-)clockwise)", re.IGNORECASE)
_FOREIGN_TIMES = {"once": 1, "twice": 2, "thrice": 3, "four_times": 4}


@dataclass(frozen=True)
class Amounts:
    """What a sentence asks for; 0 where it does not.

    Attributes
    ----------
    times : int
        How often something is done.
    degrees : float
        By how much somebody turns.
    side : int
        The side that is turned to: 1 left, -1 right, 0 either.
    """

    times: int = 0
    degrees: float = 0.0
    side: int = 0

    def __bool__(self) -> bool:
        return bool(self.times or self.degrees)


def amounts_of(sentence: str) -> Amounts:
    """The amounts that a sentence asks for: "jumps three times", "turns 90 degrees to the left", "spins twice"."""
    if language := understood_language_of(sentence):
        return _foreign_amounts(sentence, language)
    times = _times(sentence)
    if not _TURNING.search(sentence):
        return Amounts(times)
    side = bool(_LEFT.search(sentence)) - bool(_RIGHT.search(sentence))
    if found := _DEGREES.search(sentence):
        return Amounts(0, float(found["number"]), side)
    if times and _WHOLE_TURNS.search(sentence):
        return Amounts(0, 360.0 * times, side)
    degrees = next((degrees for pattern, degrees in _PARTS if pattern.search(sentence)), 0.0)
    return Amounts(0, degrees, side) if degrees else Amounts(times)


def _times(sentence: str) -> int:
    found = _TIMES.search(sentence)
    if found is None:
        return 0
    if found["adverb"]:
        return _ADVERBS[found["adverb"].lower()]
    return _NUMBERS.get(found["number"].lower()) or int(found["number"])


def _foreign_amounts(sentence: str, language: str) -> Amounts:
    named = {concept_names()[number] for number in concepts_of(sentence, language)}
    if found := _DEGREES.search(sentence):
        return Amounts(0, float(found["number"]), ("left" in named) - ("right" in named))
    times = next((times for concept, times in _FOREIGN_TIMES.items() if concept in named), 0)
    return Amounts(0, 360.0 * times) if times and "spin" in named else Amounts(times)
