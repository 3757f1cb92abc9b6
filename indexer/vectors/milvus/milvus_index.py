"""MilvusIndex: a `VectorIndex` that is a part of a collection of Milvus, perhaps only the rows that pass a filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_count, checked_vectors
from indexer.vectors.blocks import IndexRows, SearchResult
from indexer.vectors.milvus.collection_schema import CLIPS, Row
from indexer.vectors.milvus.expressions import among, every
from indexer.vectors.milvus.milvus_collection import MOST_ROWS, MilvusCollection


class MilvusIndex:
    """The clips as wholes, or all windows; see `VectorIndex`.

    A search finds at most 16,384 rows, as many as Milvus gives. What other processes write is seen within the second or
    so that Milvus calls "bounded staleness"; a clip that changes meanwhile is found as it was or as it is.

    Parameters
    ----------
    collection : MilvusCollection
    part : str
        `CLIPS` or `WINDOWS`.
    condition : str
        An expression; only rows that meet it are searched.
    """

    def __init__(self, collection: MilvusCollection, part: str, condition: str = "") -> None:
        self._collection, self._part, self._condition = collection, part, condition

    @property
    def generation(self) -> int:
        """See `VectorIndex.generation`."""
        return self._collection.generation()

    def __len__(self) -> int:
        return self._collection.count(self._part, self._condition)

    def search(self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None) -> SearchResult:
        """See `VectorIndex.search`."""
        queries, k = checked_vectors("queries", queries, self._collection.size), checked_count(k)
        scores = np.full((len(queries), k), -np.inf, np.float32)
        owners = np.full(scores.shape, -1, np.int64)
        starts, ends = np.zeros(scores.shape, np.float32), np.zeros(scores.shape, np.float32)
        if allowed is not None and len(allowed) == 0:
            return scores, owners, starts, ends
        condition = every([self._condition, "" if allowed is None else among("clip", allowed.tolist())])
        for place, found in enumerate(self._nearest(queries, k, condition)):
            for array, field in ((scores, "distance"), (owners, "clip"), (starts, "start"), (ends, "end")):
                array[place, : len(found)] = [row[field] for row in found]
        return scores, owners, starts, ends

    def _nearest(self, queries: NDArray[np.float32], k: int, condition: str) -> list[list[Row]]:
        """The k nearest rows of each query that belong to a clip as it is; more are fetched where some do not."""
        count = min(k, MOST_ROWS)
        while True:
            fetched = self._collection.nearest(self._part, queries, count, condition)
            found = self._present(fetched)
            short = any(
                len(rows) == count and len(left) < min(k, count) for rows, left in zip(fetched, found, strict=True)
            )
            if not short or count == MOST_ROWS:
                return [rows[:k] for rows in found]
            count = min(2 * count, MOST_ROWS)

    def _present(self, fetched: list[list[Row]]) -> list[list[Row]]:
        """The windows that belong to clips as they are; of clips themselves all."""
        if self._part == CLIPS:
            return fetched
        versions = self._collection.versions(sorted({row["clip"] for rows in fetched for row in rows}))
        return [[row for row in rows if _is_of(versions, row)] for rows in fetched]

    def rows_of(self, owners: NDArray[np.int64]) -> IndexRows:
        """See `VectorIndex.rows_of`; in order of owners and starts."""
        wanted = np.unique(owners).tolist()
        if not wanted:
            return IndexRows.none(self._collection.size)
        rows = self._collection.rows_of(self._part, wanted)
        (rows,) = self._present([rows])
        return as_index_rows(rows, self._collection.size)


def as_index_rows(rows: list[Row], size: int) -> IndexRows:
    """Rows as arrays, in order of clips, lengths and starts."""
    if not rows:
        return IndexRows.none(size)
    rows = sorted(rows, key=lambda row: (row["clip"], row["length"], row["start"]))
    return IndexRows(
        np.array([row["clip"] for row in rows], np.int64),
        np.array([(row["start"], row["end"]) for row in rows], np.float32),
        np.array([row["vector"] for row in rows], np.float16),
    )


def _is_of(versions: dict[int, Row], row: Row) -> bool:
    """Whether a window is of its clip as it is."""
    clip = versions.get(row["clip"])
    return clip is not None and clip["version"] == row["version"]
