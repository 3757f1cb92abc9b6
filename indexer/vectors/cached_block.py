"""A block that caches its results: it is immutable, so the same query has the same result.

Where a library grows while many ask much the same, only the added blocks have to be searched again.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import MaskedBlock, SearchResult

#: Results that are cached; one of 160 rows for a vector of 256 numbers takes 5 kB.
_CACHED = 4096


@dataclass(frozen=True)
class CachedBlock(MaskedBlock):
    """A masked block with an LRU cache of its results for single queries over all rows."""

    _cached: Any = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_cached", lru_cache(_CACHED)(self._search_one))

    def search(
        self, queries: NDArray[np.float32], k: int, allowed: NDArray[np.int64] | None, *, exact: bool = False
    ) -> SearchResult:
        """See `MaskedBlock.search`; the arrays are read-only."""
        if allowed is not None or len(queries) != 1 or exact:
            return super().search(queries, k, allowed, exact=exact)
        found: SearchResult = self._cached(queries.tobytes(), k)
        return found

    def without(self, owners: NDArray[np.int64]) -> MaskedBlock:
        """See `MaskedBlock.without`; the cache of what is left is empty."""
        left = super().without(owners)
        return left if left is self else CachedBlock(left.block, left.mask)

    def _search_one(self, query: bytes, k: int) -> SearchResult:
        found = super().search(np.frombuffer(query, np.float32)[None], k, None)
        for values in found:
            values.flags.writeable = False
        return found
