"""A part that remembers what it answered: a block never changes, so the same question has the same answer.

Where a library grows under many who ask much the same, only what came later has to be searched again.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import Found, Part

#: Answers held; one of 160 rows for a vector of 256 numbers takes 5 kB.
_HELD = 4096


@dataclass(frozen=True)
class MemoisedPart(Part):
    """A part whose answers to single queries among all rows are held; those used least lately go first."""

    _remembered: Any = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_remembered", lru_cache(_HELD)(self._answer))

    def search(self, queries: NDArray[np.float32], k: int, allowed: NDArray[np.int64] | None) -> Found:
        """See `Part.search`; the arrays cannot be written to."""
        if allowed is not None or len(queries) != 1:
            return super().search(queries, k, allowed)
        found: Found = self._remembered(queries.tobytes(), k)
        return found

    def without(self, owners: NDArray[np.int64]) -> Part:
        """See `Part.without`; what is left remembers nothing yet."""
        left = super().without(owners)
        return left if left is self else MemoisedPart(left.block, left.kept)

    def _answer(self, query: bytes, k: int) -> Found:
        found = super().search(np.frombuffer(query, np.float32)[None], k, None)
        for values in found:
            values.flags.writeable = False
        return found
