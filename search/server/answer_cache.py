"""The answer cache: an answer stays valid while the library grows, until an added clip could change it.

An answer holds the best clips for a query vector. A clip that is added later and scores less than the last of them
cannot change it, and the scores of a batch of added clips for all cached queries are few matrix products.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from search.server.lru_cache import LruCache
from search.server.responses import JsonAnswer

Vectors = NDArray[np.float32]


@dataclass(frozen=True)
class StaleCriterion:
    """What makes an answer stale: an added clip that scores at least `threshold` for `query`, or a clip with the words.

    Attributes
    ----------
    query : float32 array (D,)
    threshold : float
    words : tuple of str
        Those by which clips are found as well; none where the question has none.
    """

    query: Vectors
    threshold: float
    words: tuple[str, ...] = ()


class AnswerCache:
    """Answers valid for one generation of a library, at most `size`, least recently used evicted first. Thread-safe."""

    def __init__(self, generation: int, size: int = 4096) -> None:
        self._generation = generation
        self._answers: LruCache[tuple[JsonAnswer, StaleCriterion]] = LruCache(size)
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._answers)

    def get(self, key: Hashable) -> JsonAnswer | None:
        """The cached answer, else None."""
        cached = self._answers.get(key)
        return None if cached is None else cached[0]

    def put(self, key: Hashable, answer: JsonAnswer, criterion: StaleCriterion, generation: int) -> None:
        """Cache an answer computed at a generation; ignored where the library has changed since."""
        with self._lock:
            if generation == self._generation:
                self._answers.put(key, (answer, criterion))

    def clear(self, generation: int) -> None:
        """Invalidate all answers; those to come are of `generation`."""
        with self._lock:
            self._generation = generation
            self._answers.clear()

    def grow(
        self,
        generation: int,
        highest: Callable[[Vectors], NDArray[np.floating]],
        has_words: Callable[[Sequence[str]], bool],
    ) -> None:
        """Invalidate the answers that become stale by a growth in which no clip was removed or changed.

        To be called before anything is answered from `generation`; concurrent reads are safe.

        Parameters
        ----------
        highest : callable
            Queries (Q, D) -> the highest score (Q,) of an added clip.
        has_words : callable
            Whether an added clip has all of some words.
        """
        with self._lock:
            self._generation = generation
            cached = [(key, criterion) for key, (_, criterion) in self._answers.items()]
        if not cached:
            return
        queries = np.stack([criterion.query for _, criterion in cached])
        thresholds = np.array([criterion.threshold for _, criterion in cached])
        stale = highest(queries) >= thresholds
        self._answers.drop(
            key
            for (key, criterion), is_stale in zip(cached, stale.tolist(), strict=True)
            if is_stale or has_words(criterion.words)
        )
