"""How names are spelt that are compared: in one form of Unicode, with or without case."""

from __future__ import annotations

from unicodedata import normalize


def composed(text: str) -> str:
    """A text with each character in Unicode's composed form, as most keyboards type it; Macs decompose names."""
    return text if text.isascii() else normalize("NFC", text)


def folded(text: str) -> str:
    """A text in composed form, for comparisons that take no notice of case."""
    return composed(text).casefold()
