"""Galleries: what is ranked, the vectors of many clips and of their windows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from indexer.store.stored_library import StoredLibrary
from indexer.vectors.blocks import IndexRows

Vectors = NDArray[np.float32]

#: The most windows that are fetched for a query.
MOST_WINDOWS = 16384


class WindowGallery(Protocol):
    """The windows of many clips, as `indexer.store.stored_library.StoredLibrary` has them."""

    def __len__(self) -> int:
        """How many clips."""

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """Scores, clip ids, starts and ends, each (Q, k); id -1 where there are fewer."""


class ClipGallery(WindowGallery, Protocol):
    """The whole-clip vectors, too."""

    def nearest_clips(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64]]:
        """Scores and clip ids, each (Q, k); id -1 where there are fewer."""

    def vectors_of(self, ids: NDArray[np.int64]) -> tuple[IndexRows, IndexRows]:
        """The vectors of clips, of each as a whole, and of all their windows."""


@dataclass(frozen=True)
class ExactGallery:
    """The vectors of a library, each of which is compared: clusters would miss a few."""

    library: StoredLibrary

    def __len__(self) -> int:
        return len(self.library)

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """See `WindowGallery`."""
        return self.library.nearest_windows(queries, k, allowed=allowed, exact=True)

    def nearest_clips(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64]]:
        """See `ClipGallery`."""
        return self.library.nearest_clips(queries, k, allowed=allowed, exact=True)

    def vectors_of(self, ids: NDArray[np.int64]) -> tuple[IndexRows, IndexRows]:
        """See `ClipGallery`."""
        return self.library.vectors_of(ids)
