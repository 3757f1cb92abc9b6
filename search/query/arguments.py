"""Arguments of queries, checked: numbers of Python and numpy, refused by name where they make no sense."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.errors import ArgumentError


def checked_count(k: Any, name: str = "k") -> int:
    """A number of hits, at least 1.

    Raises
    ------
    ArgumentError
        If it is none.
    """
    if isinstance(k, bool) or not isinstance(k, Integral) or int(k) < 1:
        raise ArgumentError(f"{name}={k!r} must be a whole number, 1 or more")
    return int(k)


def checked_number(name: str, value: Any) -> float:
    """A finite number.

    Raises
    ------
    ArgumentError
        If it is none.
    """
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Real) or not isfinite(float(value)):
        raise ArgumentError(f"{name}={value!r} must be a finite number")
    return float(value)


def optional_number(name: str, value: Any) -> float | None:
    """A finite number, or None; see `checked_number`."""
    return None if value is None else checked_number(name, value)


def checked_span(start: Any, end: Any) -> tuple[float | None, float | None]:
    """Start and end of a span in seconds, each a finite number or None.

    Raises
    ------
    ArgumentError
        If one is no number.
    """
    return optional_number("start", start), optional_number("end", end)


def checked_sentences(name: str, sentences: Any) -> list[str]:
    """A list of sentences.

    Raises
    ------
    ArgumentError
        If it is one string, or holds something else than strings.
    """
    if isinstance(sentences, (str, bytes)) or not isinstance(sentences, Sequence):
        raise ArgumentError(f"{name}={sentences!r} must be a list of sentences, such as {name}=['a person waves']")
    for sentence in sentences:
        if not isinstance(sentence, str):
            raise ArgumentError(f"{name}: a sentence must be a string, not {sentence!r}")
    return list(sentences)


def unit_vector(vector: ArrayLike, size: int) -> NDArray[np.float32]:
    """A query vector (D,) scaled to length 1.

    Raises
    ------
    ArgumentError
        If it has another size, is zero or not finite.
    """
    values = np.asarray(vector)
    if values.shape != (size,) or not np.issubdtype(values.dtype, np.number) or not np.isfinite(values).all():
        raise ArgumentError(f"a query vector of shape {values.shape} must be {size} finite numbers")
    length = float(np.linalg.norm(values.astype(np.float64)))
    if length == 0:
        raise ArgumentError("a query vector of zeros has no direction")
    return (values / length).astype(np.float32)
