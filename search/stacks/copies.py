"""Copies: pairs of motions that show one performance, found among many by their shapes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from search.stacks.shapes import SIZE, mirrored

#: The cosine of two shapes from which on they show one performance, fitted to the training takes of CMU that exist in
#: several rigs; `python -m benchmarks.stacks` prints precision and recall of others.
COPIES_FROM = 0.89
#: By how much copies may differ in duration, in seconds, and in the way over the floor, as a share and in metres.
_SECONDS, _WAY, _METRES = 0.3, 0.1, 0.05
#: Shapes compared at once.
_BLOCK = 512


class Shapes(NamedTuple):
    """The shapes of N motions: unit vectors (N, SIZE), durations and ways (N,)."""

    vectors: NDArray[np.float16]
    durations: NDArray[np.float32]
    ways: NDArray[np.float32]


#: Rows of two motions each (P, 2), and whether one is the other mirrored (P,).
Pairs = tuple[NDArray[np.int64], NDArray[np.bool_]]
NO_PAIRS: Pairs = (np.empty((0, 2), np.int64), np.empty(0, np.bool_))


def pairs_of(
    new: NDArray[np.int64],
    shapes: Shapes,
    *,
    threshold: float = COPIES_FROM,
    progress: Callable[[int, int], None] | None = None,
) -> Pairs:
    """The pairs of copies of which at least one is among `new` rows (M,), the lower row first.

    Only motions of nearly one duration are compared, so that the cost of N motions that last anything from one second
    to a minute grows with a hundredth of N squared.
    """
    order = np.argsort(shapes.durations, kind="stable")
    durations = shapes.durations[order]
    new = new[np.argsort(shapes.durations[new], kind="stable")]
    is_new = np.zeros(len(order), bool)
    is_new[new] = True
    found, flags = [NO_PAIRS[0]], [NO_PAIRS[1]]
    done = 0
    for rows in _blocks(new, shapes.durations):
        low, high = shapes.durations[rows[0]] - _SECONDS, shapes.durations[rows[-1]] + _SECONDS
        near = order[np.searchsorted(durations, low) : np.searchsorted(durations, high, side="right")]
        near_vectors = shapes.vectors[near].astype(np.float32)
        queries = shapes.vectors[rows].astype(np.float32)
        possible = _may_be_copies(shapes, rows, near) & (~is_new[near] | (rows[:, None] < near))
        for flipped, vectors in ((False, queries), (True, mirrored(queries))):
            a, b = np.nonzero((vectors @ near_vectors.T >= threshold) & possible)
            found.append(np.sort(np.stack([rows[a], near[b]], axis=1), axis=1))
            flags.append(np.full(len(a), flipped))
        done += len(rows)
        if progress is not None:
            progress(done, len(new))
    return np.concatenate(found), np.concatenate(flags)


def _blocks(rows: NDArray[np.int64], durations: NDArray[np.float32]) -> list[NDArray[np.int64]]:
    """Rows in order of their durations, in blocks whose durations are near each other."""
    near = np.split(rows, np.flatnonzero(np.diff(durations[rows] // _SECONDS)) + 1)
    return [block[first : first + _BLOCK] for block in near for first in range(0, len(block), _BLOCK)]


def _may_be_copies(shapes: Shapes, rows: NDArray[np.int64], others: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether two motions last as long and go as far, but for little; (rows, others)."""
    apart = np.abs(shapes.durations[rows][:, None] - shapes.durations[others])
    a, b = shapes.ways[rows][:, None], shapes.ways[others]
    near: NDArray[np.bool_] = np.abs(a - b) <= np.maximum(_WAY * np.maximum(a, b), _METRES)
    near &= apart <= _SECONDS + 1e-6
    return near


def leaders(count: int, pairs: Pairs) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The first motion of the stack of each of `count` motions, itself where it has none, and whether it is mirrored.

    A motion joins the first one before it that is its copy and leads a stack, so that none is in a stack whose first it
    is no copy of: copies of copies do not add up to chains.
    """
    rows, flags = pairs
    order = np.lexsort((flags, rows[:, 0], rows[:, 1]))
    lead, flipped = np.arange(count), np.zeros(count, bool)
    for (first, later), flag in zip(rows[order].tolist(), flags[order].tolist(), strict=True):
        if lead[later] == later and lead[first] == first and first != later:
            lead[later], flipped[later] = first, flag
    return lead, flipped


def blank(count: int) -> Shapes:
    """The shapes of motions in which nothing moves, which are like no others."""
    return Shapes(np.zeros((count, SIZE), np.float16), np.zeros(count, np.float32), np.zeros(count, np.float32))
