"""Moment retrieval in a library: every sentence is a query to all takes at once."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.long_takes import AnnotatedTake, Annotation
from encoders.protocol import Encoder
from indexer.vectors.blocks import IndexRows, SearchResult
from indexer.vectors.faiss_index import FaissIndex
from search.evaluate.moment_metrics import Overlaps, Spans, best_overlaps
from search.moments.across_library import moments_across
from search.query.question import EncodedQuestion
from search.source import MotionSource

Vectors = NDArray[np.float32]


class TakeGallery:
    """Takes whose windows lie in one index, as in a library; a take's id is its place."""

    def __init__(self, encoder: Encoder) -> None:
        self._encoder = encoder
        self._takes: list[AnnotatedTake] = []
        self._sources: list[MotionSource] = []
        self._numbers: dict[int, int] = {}  # of each source, by its identity
        self._queries: list[tuple[int, Annotation, Vectors]] = []
        self._index: FaissIndex | None = None

    def __len__(self) -> int:
        return len(self._takes)

    def add(self, take: AnnotatedTake, source: MotionSource, queries: Vectors) -> None:
        """Add a take with the unit vectors (Q, D) of its annotated sentences."""
        self._queries += [
            (len(self), annotation, query) for annotation, query in zip(take.annotations, queries, strict=True)
        ]
        self._numbers[id(source)] = len(self)
        self._takes.append(take)
        self._sources.append(source)
        self._index = None

    def nearest_windows(self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None) -> SearchResult:
        """See `indexer.store.stored_library.StoredLibrary.nearest_windows`."""
        if self._index is None:
            self._index = FaissIndex.of(0, IndexRows.join(list(self._rows())))
        return self._index.search(queries, k, allowed=allowed)

    def _rows(self) -> Iterator[IndexRows]:
        for number, source in enumerate(self._sources):
            for windows in source.windows(self._encoder):
                spans = np.stack([windows.starts, windows.ends], axis=1)
                yield IndexRows(np.full(len(spans), number, np.int64), spans, windows.vectors)

    def search(self, k: int) -> tuple[Overlaps, Overlaps]:
        """The first k moments for every sentence.

        Returns
        -------
        any_take, own_take : Overlaps
            Where moments are right in any take in which the sentence is known to be true, and where only in its own.
        """
        any_take, own_take = Overlaps(), Overlaps()
        for own, annotation, query in self._queries:
            answers = moments_across(self._encoder, self, self._sources.__getitem__, EncodedQuestion(query[None]))
            found = [(self._numbers[id(answer.source)], answer.moment) for answer in islice(answers, k)]
            overlaps = np.array(
                [
                    best_overlaps([(moment.start, moment.end)], self._truth(number, own, annotation))[0]
                    for number, moment in found
                ]
            )
            any_take.rows.append(overlaps)
            own_take.rows.append(np.where([number == own for number, _ in found], overlaps, 0.0))
        return any_take, own_take

    def _truth(self, number: int, own: int, annotation: Annotation) -> Spans:
        """The spans of take `number` in which a sentence annotated in take `own` is true."""
        return annotation.spans if number == own else self._takes[number].spans(annotation.meaning)
