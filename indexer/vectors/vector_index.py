"""VectorIndex: what a library asks of an index over its unit vectors, whatever holds them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import IndexRows, SearchResult

if TYPE_CHECKING:
    from typing_extensions import Self


class VectorIndex(Protocol):
    """An immutable index: `update` gives a new one, so that searches in other threads never meet a change.

    `indexer.vectors.faiss_index.FaissIndex` is the embedded implementation.
    """

    @property
    def generation(self) -> int:
        """The library generation whose vectors this holds."""

    def __len__(self) -> int: ...

    def update(self, generation: int, *, remove: NDArray[np.int64], add: IndexRows) -> Self:
        """An index without the rows of the owners in `remove`, and then with the rows of `add`."""

    def rows_of(self, owners: NDArray[np.int64]) -> IndexRows:
        """All rows of some owners."""

    def search(self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None) -> SearchResult:
        """The k best rows by inner product for queries (Q, D): scores, owners, starts, ends, each (Q, k), best first.

        `allowed` (sorted owners) leaves all others out. Where fewer than k are left the owner is -1 and the
        score minus infinity.
        """
