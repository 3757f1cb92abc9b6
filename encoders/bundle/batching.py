"""Sequences of mixed lengths as batches of about equal cost with little padding."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: A batch may cost this much more than its items without padding.
_MOST_PADDING = 1.15


def length_buckets(lengths: Sequence[int], budget: int) -> Iterator[NDArray[np.intp]]:
    """Indices of items of like length, longest first.

    Parameters
    ----------
    lengths : N positive lengths
    budget : int
        Largest batch size times padded length; a single longer item is a batch of its own.
    """
    order = np.argsort(lengths, kind="stable")[::-1]
    start = 0
    while start < len(order):
        longest = lengths[order[start]]
        stop, real = start, 0
        while stop < len(order):
            real += lengths[order[stop]]
            padded = (stop + 1 - start) * longest
            if stop > start and (padded > budget or padded > _MOST_PADDING * real):
                break
            stop += 1
        yield order[start:stop]
        start = stop


def pad(items: Sequence[NDArray[Any]]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Arrays (L_i, ...) -> one array (N, max L_i, ...), zero-padded, and the lengths (N,)."""
    lengths = np.array([len(item) for item in items], np.int64)
    padded = np.zeros((len(items), lengths.max(), *items[0].shape[1:]), items[0].dtype)
    for row, item in zip(padded, items, strict=True):
        row[: len(item)] = item
    return padded, lengths
