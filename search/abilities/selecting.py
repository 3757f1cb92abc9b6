"""SelectableLibrary: which clips filters mean, and which motion a reference means."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_span
from encoders.motion import Motion
from indexer.argument_checks import checked_rate, checked_up
from indexer.store.clips import Clip
from indexer.store.library_reader import one_snapshot
from indexer.store.stored_library import StoredLibrary
from search.query.filters import FilterArguments, Filters
from search.references import Ref, source_of, span_of
from search.source import MotionSource

if TYPE_CHECKING:
    from typing_extensions import Self, Unpack

Ids = NDArray[np.int64]

#: Clips read at once.
_CHUNK = 1000
#: Filters whose clips are cached: of a million clips at most 8 MB each.
_FILTERS = 16


class SelectableLibrary(StoredLibrary):
    """A library whose clips are chosen by filters, and whose motions by references."""

    def clips(self, sort: str | None = None, **filters: Unpack[FilterArguments]) -> Iterator[Clip]:
        """The clips, read in chunks, so that memory does not grow with the library.

        Parameters
        ----------
        sort : str, optional
            "name", "longest", "shortest" or "newest"; in order of their numbers if not given.
        """
        allowed = self.allowed(**filters)
        if sort is not None:
            return self._chunks(self.sorted_among(sort, allowed))
        return super().clips() if allowed is None else self._chunks(allowed)

    def sorted_among(self, sort: str, allowed: Ids | None) -> Ids:
        """Those of some ids, or of all, that are clips, by an order of `clips`."""
        ids = self.sorted_ids(sort)
        return ids if allowed is None else ids[np.isin(ids, allowed)]

    def _chunks(self, ids: Ids) -> Iterator[Clip]:
        for first in range(0, len(ids), _CHUNK):
            yield from self.clips_by_id(ids[first : first + _CHUNK].tolist()).values()

    def source(self, ref: Ref, *, fps: float | None = None, up: str | None = None) -> MotionSource:
        """The motion that a reference means, with what the library knows of it."""
        return source_of(ref, self, fps=checked_rate(fps), up=checked_up(up))

    @one_snapshot
    def allowed(self, **filters: Unpack[FilterArguments]) -> Ids | None:
        """The ids of the clips that pass the filters, sorted; None for all. Recent ones are cached: do not change."""
        return self._passing(self.state, Filters.of(filters))

    @cached_property
    def _passing(self) -> Callable[[object, Filters], Ids | None]:
        return lru_cache(_FILTERS)(lambda state, filters: filters.ids(self))

    def narrowed(self, filters: FilterArguments, *, without: int = -1) -> tuple[Self, Ids | None]:
        """What is searched where filters are given and one clip is left out: a library, and the ids as of `allowed`."""
        allowed = self.allowed(**filters)
        if without < 0:
            return self, allowed
        return self, np.setdiff1d(self.ids() if allowed is None else allowed, [without])

    def _cut(self, ref: Ref, start: float | None, end: float | None, fps: float | None, up: str | None) -> Motion:
        return self.source(ref, fps=fps, up=up).cut(*checked_span(*span_of(ref, start, end)))
