"""Milvus's filter expressions, put together from values of users, which are quoted and never pasted."""

from __future__ import annotations

import json
from collections.abc import Iterable


def quoted(text: str) -> str:
    """A text as an expression writes it."""
    return json.dumps(text, ensure_ascii=False)


def among(field: str, values: Iterable[int | str]) -> str:
    """Whether a field has one of some values; of no values, nothing passes."""
    listed = ", ".join(quoted(value) if isinstance(value, str) else str(int(value)) for value in values)
    return f"{field} in [{listed}]" if listed else nothing(field)


def nothing(field: str) -> str:
    """What no row passes, by a numeric field that is never negative."""
    return f"{field} < 0"


def every(conditions: Iterable[str]) -> str:
    """All conditions at once; empty ones do not count."""
    given = [condition for condition in conditions if condition]
    return given[0] if len(given) == 1 else " and ".join(f"({condition})" for condition in given)


def either(conditions: Iterable[str]) -> str:
    """One of the conditions at least."""
    given = list(conditions)
    return given[0] if len(given) == 1 else " or ".join(f"({condition})" for condition in given)


def like(field: str, literal: str, *, then_anything: bool = False) -> str:
    """Whether a field is a text, or begins with it; what stands for other characters in it is taken as it is."""
    if not then_anything:
        return f"{field} == {quoted(literal)}"
    return f"{field} like {quoted(escaped(literal) + '%')}"


def escaped(literal: str) -> str:
    """A text inside a pattern of `like`."""
    return "".join(f"\\{letter}" if letter in "\\%_" else letter for letter in literal)
