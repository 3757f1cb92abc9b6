"""Every sentence asked of all takes at once, as of a library."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.long_takes import AnnotatedTake, Annotation
from encoders.protocol import Encoder
from indexer.vectors.flat import FlatVectors, Found, Rows
from search.evaluate.moment_metrics import Overlaps, best_overlaps
from search.moments.across_clips import best_moments
from search.moments.window_scores import Vectors
from search.source import MotionSource


class Gallery:
    """Takes whose windows lie in one index, as in a library; a take's id is its place."""

    def __init__(self, bundle: Encoder) -> None:
        self._bundle = bundle
        self.takes: list[AnnotatedTake] = []
        self.sources: list[MotionSource] = []
        self._asked: list[tuple[int, Annotation, Vectors]] = []
        self._index: FlatVectors | None = None

    def __len__(self) -> int:
        return len(self.takes)

    def add(self, take: AnnotatedTake, source: MotionSource, queries: Vectors) -> None:
        """A take with the unit vectors (Q, D) of its marked sentences."""
        self._asked += [
            (len(self.takes), marked, query) for marked, query in zip(take.annotations, queries, strict=True)
        ]
        self.takes.append(take)
        self.sources.append(source)
        self._index = None

    def nearest_windows(self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None) -> Found:
        """See `indexer.store.stored_library.Library.nearest_windows`."""
        if self._index is None:
            self._index = FlatVectors.of(0, Rows.join(list(self._rows())))
        return self._index.search(queries, k, allowed=allowed)

    def _rows(self) -> Iterator[Rows]:
        for number, source in enumerate(self.sources):
            for windows in source.windows(self._bundle):
                spans = np.stack([windows.starts, windows.ends], axis=1)
                yield Rows(np.full(len(spans), number, np.int64), spans, windows.vectors)

    def ask(self, k: int = 10) -> tuple[Overlaps, Overlaps]:
        """All sentences: answers right in any take in which they are known to be true, and in their own take alone."""
        anywhere, own = Overlaps(), Overlaps()
        for number, marked, query in self._asked:
            found = best_moments(self._bundle, self, self.sources.__getitem__, query[None], k)
            overlaps = [
                float(best_overlaps([(moment.start, moment.end)], self._truth(place, number, marked))[0])
                for place, moment in found
            ]
            at_home = [overlap if place == number else 0.0 for (place, _), overlap in zip(found, overlaps, strict=True)]
            anywhere.rows.append(np.array(overlaps))
            own.rows.append(np.array(at_home))
        return anywhere, own

    def _truth(self, place: int, home: int, marked: Annotation) -> list[tuple[float, float]]:
        """Where in a take a sentence is true that was marked in the take `home`."""
        return list(marked.spans) if place == home else self.takes[place].spans(marked.meaning)
