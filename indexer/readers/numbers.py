"""Long runs of numbers in text, read fast."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray


def parse_numbers(text: bytes | memoryview) -> NDArray[np.float64]:
    """All numbers of a text, separated by spaces, tabs, commas or line ends.

    Raises
    ------
    ValueError
        If something in it is no number; names it.
    """
    data = bytes(text).replace(b",", b" ").replace(b";", b" ")
    if not data.strip():
        return np.empty(0)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(data, dtype=np.float64, sep=" ")
        except (DeprecationWarning, ValueError):
            raise ValueError(f"{_first_non_number(data)!r} is no number") from None


def _first_non_number(data: bytes) -> str:
    for word in data.split():
        try:
            float(word)
        except ValueError:
            return word[:40].decode("latin-1")
    return ""
