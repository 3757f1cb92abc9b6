"""Arguments, checked: each check returns the value in its plain type, or raises `ArgumentError` with its name."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from math import isfinite
from numbers import Integral, Real
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.errors import ArgumentError

Kind = TypeVar("Kind")

#: The largest count, of hits or of pixels.
MOST = 2**31 - 1
#: Characters of the longest sentence: a model reads some fifty words, and a caption has no more, either.
LONGEST_SENTENCE = 2000
#: Characters of a rejected value that a message shows.
_SHOWN = 80


def finite_number(value: Any) -> float | None:
    """A finite real number, of Python or numpy, as a float; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if isfinite(number) else None


def whole_number(value: Any) -> int | None:
    """A whole number, of Python or numpy, as an int; None for anything else."""
    return None if isinstance(value, bool) or not isinstance(value, Integral) else int(value)


def checked_count(k: Any, name: str = "k") -> int:
    """A whole number from 1 to `MOST`."""
    count = whole_number(k)
    if count is None or not 1 <= count <= MOST:
        raise ArgumentError(f"{name}={shown(k)} must be a whole number from 1 to {MOST}")
    return count


def checked_number(name: str, value: Any) -> float:
    """A finite number."""
    number = finite_number(value)
    if number is None:
        raise ArgumentError(f"{name}={shown(value)} must be a finite number")
    return number


def optional_number(name: str, value: Any) -> float | None:
    """A finite number, or None."""
    return None if value is None else checked_number(name, value)


def checked_span(start: Any, end: Any) -> tuple[float | None, float | None]:
    """Start and end of a span in seconds, each a finite number or None; the start not below 0, the end after it."""
    first, last = optional_number("start", start), optional_number("end", end)
    if first is not None and first < 0:
        raise ArgumentError(f"start={first:g} must be 0 or more seconds")
    if last is not None and last <= (first or 0.0):
        raise ArgumentError(f"end={last:g} must be after start={first or 0:g}, in seconds")
    return first, last


def checked_flag(name: str, value: Any) -> bool:
    """True or False, of Python or numpy."""
    if not isinstance(value, (bool, np.bool_)):
        raise ArgumentError(f"{name}={shown(value)} must be True or False")
    return bool(value)


def checked_text(name: str, value: Any) -> str:
    """A string of valid Unicode."""
    if not isinstance(value, str) or not is_text(value):
        raise ArgumentError(f"{name}={shown(value)} must be a string of valid Unicode")
    return value


def is_text(value: str) -> bool:
    """Whether a string is valid Unicode, without lone surrogates."""
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


def checked_path(name: str, value: Any) -> Path:
    """A path that is not empty; whether there is such a file is not looked at."""
    try:
        encoded = os.fsencode(value) if isinstance(value, (str, os.PathLike)) else b"\0"
    except (TypeError, UnicodeEncodeError):
        encoded = b"\0"
    if not encoded or b"\0" in encoded:
        raise ArgumentError(f"{name}={shown(value)} must be a path")
    return Path(value)


def checked_sentences(name: str, sentences: Any) -> list[str]:
    """A list of sentences of at most `LONGEST_SENTENCE` characters; one string is not one."""
    if isinstance(sentences, (str, bytes)) or not isinstance(sentences, (Sequence, np.ndarray)):
        raise ArgumentError(f"{name}={shown(sentences)} must be a list of sentences, such as ['a person waves']")
    for sentence in sentences:
        if len(checked_text(name, sentence)) > LONGEST_SENTENCE:
            raise ArgumentError(
                f"{name}={shown(sentence[:_SHOWN])} has {len(sentence)} characters; ask in at most {LONGEST_SENTENCE}"
            )
    return list(sentences)


def checked_list(name: str, values: Any, kind: type[Kind]) -> list[Kind]:
    """A list of objects of one kind."""
    items = list(values) if isinstance(values, Iterable) else [values]
    if not isinstance(values, Iterable) or not all(isinstance(item, kind) for item in items):
        found = ", ".join(sorted({type(item).__name__ for item in items}))
        raise ArgumentError(f"{name} must be a list of {kind.__name__}, not of {found}")
    return items


def checked_vectors(name: str, vectors: Any, size: int) -> NDArray[np.float32]:
    """Vectors (N, D) of `size` numbers each, contiguous in memory."""
    array = _numbers(vectors)
    if array is None or array.ndim != 2 or array.shape[1] != size:
        shape = None if array is None else array.shape
        raise ArgumentError(f"{name} of shape {shape} must be numbers of shape (N, {size})")
    return np.ascontiguousarray(array, np.float32)


def unit_vector(vector: ArrayLike, size: int) -> NDArray[np.float32]:
    """A query vector, (D,) or (1, D), of any length but 0 as a unit vector (D,)."""
    values = _numbers(vector)
    if values is None or values.shape not in ((size,), (1, size)) or not np.isfinite(values).all():
        shape = "" if values is None else f" of shape {values.shape}"
        raise ArgumentError(f"a query{shape} must be a sentence, or a vector of {size} finite numbers")
    values = values.reshape(size).astype(np.float64)
    largest = np.abs(values).max()
    if largest == 0:
        raise ArgumentError("a query vector of zeros has no direction")
    return np.asarray(values / largest / np.linalg.norm(values / largest), np.float32)


def _numbers(values: Any) -> NDArray[Any] | None:
    """An array of real numbers; None for anything else."""
    try:
        array = np.asarray(values)
    except ValueError:  # lists of different lengths
        return None
    return array if array.dtype.kind in "fiu" else None


def shown(value: Any) -> str:
    """A value as a message shows it: its start where it is long."""
    try:
        text = repr(value)
    except ValueError:  # an integer of very many digits
        return f"{type(value).__name__} of very many digits"
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
