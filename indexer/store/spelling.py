"""How names are spelt that are compared: in one form of Unicode, with or without case."""

from __future__ import annotations

import re
from unicodedata import normalize

#: The parts of a name: "HeroWalk2" is Hero, Walk and 2.
_PARTS = re.compile(r"[^\W\d_]+|\d+")
_HUMPS = re.compile(r"(?<=[a-z\u00df-\u00ff])(?=[A-Z\u00c0-\u00de])|(?<=[A-Z])(?=[A-Z][a-z])")


def composed(text: str) -> str:
    """A text with each character in Unicode's composed form, as most keyboards type it; Macs decompose names."""
    return text if text.isascii() else normalize("NFC", text)


def folded(text: str) -> str:
    """A text in composed form, for comparisons that take no notice of case."""
    return composed(text).casefold()


def path_words(path: str) -> str:
    """The words of a path as they are written, then their parts: "HeroWalk2_b" gives herowalk2 b hero walk 2."""
    words, parts = re.split(r"[\W_]+", composed(path)), []
    for word in words:
        found = [part for hump in _HUMPS.split(word) for part in _PARTS.findall(hump)]
        parts += found if len(found) > 1 else []
    return " ".join(filter(None, [*words, *parts])).lower()
