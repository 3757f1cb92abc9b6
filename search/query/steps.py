"""Steps of a sentence: "walks, then sits" divides into "walks" and "sits"."""

from __future__ import annotations

import re

from search.query.languages import understood_language_of
from search.translation.concepts import stems_of

_ORDER = re.compile(
    r"\s*[,;.]?\s*\b(?:and\s+)?(?:then|after\s+that|afterwards?|next|finally|followed\s+by)\b\s*,?\s*(?:and\s+)?"
    r"|\s*[,;]?\s*\bbefore\s+(?=\w+ing\b)"
    r"|\s*;\s*",
    re.IGNORECASE,
)
_AFTER = re.compile(r"^\s*after\s+(?P<first>\w+ing\b[^,]*),\s*(?P<second>.+)$", re.IGNORECASE)
#: Words in -s that are no verbs: "slowly, as on ice", "walks, arms out".
_NO_VERBS = (
    "as|is|was|his|its|this|always|sometimes|perhaps|across|towards|[a-z]+wards|[a-z]+ways|hands|arms|legs|feet|knees|"
    "elbows|shoulders|hips|fists|eyes|times"
)
_LISTED = re.compile(rf"\s*,\s*(?:and\s+)?(?!(?:{_NO_VERBS})\b)(?=(?:\w+s|\w+ing)\b)", re.IGNORECASE)
_SUBJECT = re.compile(
    r"^\s*(?P<subject>(?:(?:a|an|the|one|this)\s+)?(?:\w+\s+)?(?:person|man|woman|figure|someone|somebody|human|guy|girl|boy|"
    r"character|actor|individual|he|she|they))\b\s+",
    re.IGNORECASE,
)
#: What links a subject to a step that begins so.
_LINKS = ((re.compile(r"\w+ing\b", re.IGNORECASE), "is "), (re.compile(r"(?:an?|the)\b", re.IGNORECASE), "does "))


def split(sentence: str) -> list[str]:
    """A sentence's steps in the order they happen: "walks, then sits" -> ["walks", "sits"]; one step where it has none.

    Words of order divide it ("then", "after that", "followed by", "before ...ing", "after ...ing,", a semicolon), and
    once one is there, commas before a verb do too. The subject of the first step is given to those without one. In
    another language, what its lexicon has for "then" and a semicolon divide, and no subject is added.
    """
    if language := understood_language_of(sentence):
        return _split_foreign(sentence, language)
    after = _AFTER.match(sentence)
    parts = [after["first"], *_ORDER.split(after["second"])] if after else _ORDER.split(sentence)
    if len(parts) > 1:
        parts = [step for part in parts for step in _LISTED.split(part)]
    steps = _bare(parts)
    subject = next((found["subject"] for found in map(_SUBJECT.match, steps) if found), "")
    return [_with_subject(step, subject) for step in steps] or [sentence]


def _split_foreign(sentence: str, language: str) -> list[str]:
    """A sentence's steps; "und" and its like stay at their ends, as they change no meaning."""
    words = (stem.replace("+", r"\s+").replace("_", r"\b") for stem in stems_of(language, "then"))
    spaced = r"\b" if sentence.count(" ") else ""
    return _bare(re.split(rf"{spaced}(?:{'|'.join(words)})|[;；]", sentence, flags=re.IGNORECASE)) or [sentence]


def _bare(parts: list[str]) -> list[str]:
    """What is left of parts without the marks around them, where there are words."""
    steps = [part.strip(" \t\n,;.，、。،") for part in parts]
    return [step for step in steps if any(character.isalnum() for character in step)]


def _with_subject(step: str, subject: str) -> str:
    if not subject or _SUBJECT.match(step):
        return step
    link = next((link for pattern, link in _LINKS if pattern.match(step)), "")
    return f"{subject} {link}{step}"
