"""Sums over the rows of an index, by which two are compared whose rows lie in different orders."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import IndexRows

#: Rows that are looked at together, so that memory does not grow with them.
_ROWS = 1 << 12
#: Constants of the finaliser of splitmix64 (Steele, Lea and Flood, OOPSLA 2014).
_MIX = ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB))


def sum_of_rows(pieces: Iterable[IndexRows]) -> tuple[int, int, int]:
    """The number of rows, and two sums over the hashes of all, each of 64 bits.

    Equal for the same rows in any order. Rows that differ in one word never have the same sum, as each hash is the sum
    of the words times odd numbers and then a bijection; any others have by a chance of some 2**-128. Of damaged rows,
    where there are not as many vectors as spans, the sums are -1.
    """
    count, sums = 0, np.zeros(2, np.uint64)
    for piece in pieces:
        if not len(piece.owners) == len(piece.spans) == len(piece.vectors):
            return len(piece), -1, -1
        count += len(piece)
        for first in range(0, len(piece), _ROWS):
            part = slice(first, first + _ROWS)
            sums += _hashes(piece.owners[part], piece.spans[part], piece.vectors[part]).sum(axis=0, dtype=np.uint64)
    return count, int(sums[0]), int(sums[1])


def _hashes(owners: NDArray[np.int64], spans: NDArray[np.float32], vectors: NDArray[np.float16]) -> NDArray[np.uint64]:
    """Two hashes (n, 2) of each row."""
    parts = [np.ascontiguousarray(part).view(np.uint16).reshape(len(owners), -1) for part in (owners, spans, vectors)]
    words = np.concatenate(parts, axis=1).astype(np.uint64)
    factors = np.random.default_rng(0).integers(0, 1 << 63, (words.shape[1], 2), np.uint64) * np.uint64(2) + np.uint64(
        1
    )
    hashes: NDArray[np.uint64] = words @ factors
    for shift, factor in _MIX:
        hashes = (hashes ^ (hashes >> np.uint64(shift))) * np.uint64(factor)
    hashes ^= hashes >> np.uint64(31)
    return hashes
