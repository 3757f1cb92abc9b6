"""Answers that stand while a library grows: one is dropped only where something that was added could change it.

An answer holds the best clips for a query vector. A clip or a window that came later and scores less than the last of
them changes nothing, and what a batch of added rows scores for every held answer is one matrix product.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vectors = NDArray[np.float32]

#: Added rows that are compared at once.
_CHUNK = 1024


@dataclass(frozen=True)
class StaleCriterion:
    """What an answer stands on.

    Attributes
    ----------
    vector : (D,)
        The query.
    floor : float
        What scores less for it changes nothing.
    """

    vector: Vectors
    floor: float


class AnswerCache:
    """Finished answers of one generation of a library, at most `size`; the least used go first. Thread-safe."""

    def __init__(self, generation: int, size: int = 4096) -> None:
        self._generation = generation
        self._size = size
        self._held: OrderedDict[Hashable, tuple[bytes, StaleCriterion]] = OrderedDict()
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._held)

    def get(self, key: Hashable) -> bytes | None:
        """The answer, None where there is none."""
        with self._lock:
            if key not in self._held:
                return None
            self._held.move_to_end(key)
            return self._held[key][0]

    def put(self, key: Hashable, answer: bytes, grounds: StaleCriterion, generation: int) -> None:
        """Remember an answer that was found in this generation of the library; if it has grown since, do not."""
        with self._lock:
            if generation != self._generation:
                return
            self._held[key] = answer, grounds
            self._held.move_to_end(key)
            while len(self._held) > self._size:
                self._held.popitem(last=False)

    def clear(self, generation: int) -> None:
        """Forget all answers; those to come are of this generation."""
        with self._lock:
            self._generation = generation
            self._held.clear()

    def grow(self, generation: int, added: Vectors) -> None:
        """Drop what a growth to a generation, in which nothing went or changed, could change.

        To be called before anything is answered from that generation. Answers are given meanwhile.

        Parameters
        ----------
        added : (N, D)
            Vectors of what came: whole clips and windows.
        """
        with self._lock:
            self._generation = generation
            held = [(key, grounds) for key, (_, grounds) in self._held.items()]
        if not held:
            return
        queries = np.stack([grounds.vector for _, grounds in held])
        floors = np.array([grounds.floor for _, grounds in held])
        shaken = _best(queries, added) >= floors
        with self._lock:
            for (key, _), drop in zip(held, shaken.tolist(), strict=True):
                if drop:
                    self._held.pop(key, None)


def _best(queries: Vectors, rows: Vectors) -> Vectors:
    """The best score (Q,) among rows (N, D) for each query (Q, D); minus infinity where there are none."""
    best = np.full(len(queries), -np.inf, np.float32)
    for first in range(0, len(rows), _CHUNK):
        np.maximum(best, (queries @ rows[first : first + _CHUNK].T).max(axis=1), out=best)
    return best
