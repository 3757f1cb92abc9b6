"""Names of several takes in one file, fit to stand after its path as `file#name`."""

from __future__ import annotations

from collections.abc import Sequence

MAX_LENGTH = 100
_OF_PATHS = str.maketrans({"/": "_", "\\": "_", "#": "_"})


def take_names(given: Sequence[object], what: str) -> list[str]:
    """Names that differ, in one printed line each, without the marks of paths.

    Parameters
    ----------
    given : sequence
        Names as the file has them; anything but text is no name.
    what : str
        What the takes are: one without a name is called by this and its number, from 1.
    """
    names: list[str] = []
    for number, name in enumerate(given, start=1):
        text = name if isinstance(name, str) else ""
        text = "".join(letter if letter.isprintable() else " " for letter in text.translate(_OF_PATHS))
        text = " ".join(text.split())[:MAX_LENGTH].strip() or f"{what} {number}"
        names.append(_unlike(text, set(names)))
    return names


def _unlike(name: str, others: set[str]) -> str:
    """The name, with the first number after it that makes it differ."""
    number, found = 1, name
    while found in others:
        number += 1
        found = f"{name} ({number})"
    return found
