"""VectorIndex: what a library asks of an index over its unit vectors, whatever holds them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import IndexRows, SearchResult


class VectorIndex(Protocol):
    """An index that is searched. How rows come into it is its own affair, and differs.

    `indexer.vectors.faiss_index.FaissIndex` is the one in the box: files beside the library, an immutable snapshot of
    one generation. `indexer.vectors.milvus.milvus_index.MilvusIndex` asks a Milvus server, where clips come and go
    between two calls.
    """

    @property
    def generation(self) -> int:
        """Which state of the vectors this is: another number whenever they have changed."""

    def __len__(self) -> int: ...

    def rows_of(self, owners: NDArray[np.int64]) -> IndexRows:
        """All rows of some owners."""

    def search(self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None) -> SearchResult:
        """The k best rows by inner product for queries (Q, D): scores, owners, starts, ends, each (Q, k), best first.

        `allowed` (sorted owners) leaves all others out. Where fewer than k are left the owner is -1 and the
        score minus infinity.
        """
