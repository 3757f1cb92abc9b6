"""Long runs of decimal numbers in text, read fast."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

_CHUNK = 1 << 20  # small enough for the masks over a chunk to stay in the processor's cache
_SEPARATORS = bytes.maketrans(b",;", b"  ")
_MAX_DIGITS = 18  # an int64 holds any number of 18 digits
_EXACT = 2**53  # below this an integer over a power of ten up to 22 is rounded once, hence correctly
_POWERS = 10.0 ** np.arange(_MAX_DIGITS + 1)


def parse_numbers(text: bytes) -> NDArray[np.float64]:
    """All numbers of a text, separated by spaces, tabs, commas, semicolons or line ends; as exact as `float`.

    Raises
    ------
    ValueError
        If something in it is no number; names it.
    """
    chunks = []
    at = 0
    while at < len(text):
        end = text.find(b"\n", at + _CHUNK)
        end = len(text) if end < 0 else end + 1
        chunk = text[at:end]
        if b"," in chunk or b";" in chunk:
            chunk = chunk.translate(_SEPARATORS)
        plain = _parse_plain(chunk)
        chunks.append(_parse_any(chunk) if plain is None else plain)
        at = end
    return np.concatenate(chunks) if chunks else np.empty(0)


def _parse_plain(text: bytes) -> NDArray[np.float64] | None:
    """Numbers without exponents: digits read as integers, the points' places counted apart. None where that fails."""
    letters = np.frombuffer(text, np.uint8)
    ink = np.zeros(len(letters) + 2, np.bool_)
    np.greater(letters, ord(" "), out=ink[1:-1])
    edges = np.flatnonzero(ink[1:] != ink[:-1])
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return np.empty(0)
    if (ends - starts).max() > _MAX_DIGITS:
        return None
    points = np.flatnonzero(letters == ord("."))
    if len(points) == len(starts) and (starts <= points).all() and (points < ends).all():
        decimals = ends - points - 1
    else:
        owners = np.searchsorted(starts, points, side="right") - 1
        if len(points) and (np.diff(owners) == 0).any():
            return None
        decimals = np.zeros(len(starts), np.int64)
        decimals[owners] = ends[owners] - points - 1
    whole = _fromstring(text.replace(b".", b""), np.int64)
    if whole is None or len(whole) != len(starts) or np.abs(whole).max() >= _EXACT:
        return None
    values: NDArray[np.float64] = whole / _POWERS[decimals]
    return values


def _parse_any(text: bytes) -> NDArray[np.float64]:
    """Numbers of any form."""
    words = text.split()
    values = _fromstring(text, np.float64)
    if values is not None and len(values) == len(words):
        return values
    for word in words:
        if not _is_number(word):
            raise ValueError(f"{word[:40].decode('latin-1')!r} is no number")
    return np.array([float(word) for word in words])


def _is_number(word: bytes) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return b"_" not in word  # which Python would take between digits


def _fromstring(text: bytes, dtype: type[np.generic]) -> NDArray[np.float64] | None:
    """The numbers of a text, or None where it holds something else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=dtype, sep=" ")
        except (DeprecationWarning, ValueError):
            return None
