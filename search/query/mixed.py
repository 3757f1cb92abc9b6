"""A sentence and a motion asked for together: "like this but slower"."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_number
from encoders.errors import ArgumentError
from search.query.question import EncodedQuestion

#: How much of a question is its sentence, where nothing else is said.
WEIGHT = 0.5
_LIKE = re.compile(
    r"^\s*(?:just\s+)?(?:(?:like|as)\s+(?:this|that|it)(?:\s+one)?|(?:about\s+)?the\s+same)\b[\s,]*(?:but|only|and)?\s+",
    re.IGNORECASE,
)
_COMPARED = {
    "slower": "slowly",
    "faster": "fast",
    "quicker": "quickly",
    "higher": "high",
    "lower": "low",
    "wider": "wide",
    "bigger": "big",
    "smaller": "small",
    "softer": "softly",
}
_COMPARATIVE = re.compile(rf"\b(?:{'|'.join(_COMPARED)})\b", re.IGNORECASE)


def checked_weight(value: object) -> float:
    """The share of the sentence, 0 to 1.

    Raises
    ------
    ArgumentError
        If it is not such a number.
    """
    weight = checked_number("weight", value)
    if not 0 <= weight <= 1:
        raise ArgumentError(f"weight={weight:g} must be from 0, the motion alone, to 1, the sentence alone")
    return weight


def difference_of(sentence: str) -> str:
    """What a sentence says beyond "like this but", as a description: "like this but slower" -> "slowly"."""
    return _COMPARATIVE.sub(lambda found: _COMPARED[found[0].lower()], _LIKE.sub("", sentence, count=1))


def mixed(question: EncodedQuestion, motion: NDArray[np.float32], weight: float) -> EncodedQuestion:
    """A question with the mean of its vector and that of a motion (D,), the sentence's counted `weight`."""
    vector = weight * question.vectors[0] + (1 - weight) * motion
    kind = {0.0: "motion", 1.0: "sentence"}.get(weight, "mixed")
    return EncodedQuestion((vector / np.linalg.norm(vector))[None].astype(np.float32), kind=kind)
