"""Rankings that do not depend on how much of them is asked for.

What is cheap to propose is looked at closely in rounds of a fixed size, and each round's answers follow those of the
round before. The first ten answers are then the same whether ten are wanted or fifty, and pages of them never repeat or
miss one.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import TypeVar

T = TypeVar("T")


def rounds(proposed: Iterator[T], size: int) -> Iterator[list[T]]:
    """What is proposed, so many at a time, the last round shorter; no further than is asked for."""
    while batch := list(islice(proposed, size)):
        yield batch
