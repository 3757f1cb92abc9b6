"""Normalisation of human sentences: lower case, typos corrected, fixed phrases as one word, subject removed."""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

from encoders.corpus.language.lexicon import PHRASES


@cache
def patterns() -> dict[str, Any]:
    """The parser's tables: `corrections`, `attributes` and `styles` of `phrases/patterns.json`."""
    loaded: dict[str, Any] = json.loads((PHRASES / "patterns.json").read_text(encoding="utf-8"))
    return loaded


@cache
def _corrections() -> tuple[tuple[re.Pattern[str], str], ...]:
    """(pattern, replacement), applied in order to a lower-case sentence."""
    return tuple((re.compile(pattern), to) for pattern, to in patterns()["corrections"])


_SUBJECT = re.compile(
    r"^(?:(?:in|on) (?:the|this) (?:video|clip|picture),? )?(?:(?:first|initially|at first),? )?"
    r"(?:(?:the|a|an|this|one|i|some|same|another) )?"
    r"(?:(?:stick|human|male|female|sim|toon|young|computer|animated|3d|skeleton|standing|single|faceless|red|blue) )*"
    r"(?:person|man|woman|figure|figurine|someone|somebody|human|individual|subject|character|guy|sim|toon|dude|actor|"
    r"body|boy|girl|lady|performer|people|user|model|skeleton|avatar|player|he|she|they|it|him|robot)\b"
    r"(?:'s)?(?: (?:that|who|which))?\b"
)
_AUXILIARY = re.compile(
    r"^(?:who |that |which |then |he |she |they |it |the person |the man |person |a person |also |now |just |again |"
    r"and |to |"
    r"is |are |was |were |be |being |been |has |had |will |"
    r"(?:appear|seem|look)(?:s|ed|ing)? (?:as if |as though |like )?(?:(?:he|she|they|it)(?: is| are|'s|'re) )?"
    r"(?:to )?(?:be )?(?=\w+ing\b|to\b)|"
    r"(?:appear|seem)(?:s|ed)? to (?:be )?(?:have )?|"
    r"(?:starts?|started|starting|begins?|began|beginning|continues?|continued|continuing|proceeds?|proceeded|"
    r"proceeding|pretends?|pretended|pretending|tries|tried|trying|attempts?|attempting|decides?|goes on|prepares|"
    r"gets ready|goes) (?:to (?=\w)|(?=\w+ing\b))|"
    r"(?:keeps?|kept) (?:on )?(?=\w+ing\b)|"
    r"(?:finally|next|lastly|eventually|afterward|immediately|simultaneously|once more) )+"
)


_IMPERSONAL = re.compile(r"^(?:it|this) (?:looks?|seems?|appears?|is) (?:like|as if|as though|that)? ?(?:if )?")
_INSTRUMENT = re.compile(
    r"\bus(?:es|ed|ing|e) ((?:(?:his|her|their|the|both|a|one|left|right) )+(?:hands?|arms?|legs?|foot|feet|fists?)) "
    r"to (\w+(?: (?!and |then |before |while )\w+)*)"
)
_NOMINALISED = re.compile(
    r"\b(?:makes?|made|making|does|did|doing|do|performs?|performing|performed) "
    r"(?:an? |some |several |the |small |big |few |quick |slow |repeated )*(\w+ing)(?: type)? "
    r"(?:motions?|gestures?|movements?|actions?|moves?|exercises?)\b"
)


def normalise(sentence: str) -> str:
    """Lower case, single spaces, no full stop, typos corrected, fixed phrases as one word."""
    text = " ".join(sentence.lower().replace("_", " ").split()).strip(" .!\"'")
    for pattern, to in _corrections():
        text = pattern.sub(to, text)
    text = re.sub(r"\s*([,;.])\s*", r"\1 ", text).replace(";", ",").replace(". ", ", then ")
    text = " ".join(re.sub(r"[^a-z0-9,'\- ]", " ", text).split()).strip(" ,")
    text = _IMPERSONAL.sub("", text)
    text = _NOMINALISED.sub(r"\1", text)  # "makes a throwing motion" -> "throwing"
    return _INSTRUMENT.sub(r"\2 with \1", text)  # "uses the left hand to wave" -> "wave with the left hand"


def drop_subject(clause: str) -> str:
    """The clause without its subject."""
    return _SUBJECT.sub("", clause, count=1).strip(" ,")


def drop_auxiliaries(clause: str) -> str:
    """The clause from its main verb on: without "is", "starts to", "appears to be", "then"."""
    while True:
        shorter = _AUXILIARY.sub("", clause, count=1).strip(" ,")
        if shorter == clause:
            return clause
        clause = shorter
