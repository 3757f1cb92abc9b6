"""Candidates in batches of a fixed size, so that a ranking does not depend on how many answers are wanted.

What is cheap to rank is refined batch by batch, and the answers of each batch follow those of the one before. The first
ten answers are then the same whether ten are wanted or fifty, and pages of them neither repeat nor miss one.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import TypeVar

T = TypeVar("T")


def batched(candidates: Iterator[T], size: int) -> Iterator[list[T]]:
    """Lists of `size` candidates, the last one shorter, consumed no further than needed (`itertools.batched`)."""
    while batch := list(islice(candidates, size)):
        yield batch
