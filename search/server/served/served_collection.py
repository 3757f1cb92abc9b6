"""ServedCollection: a collection of Milvus that a server answers from, and whose changes it notices."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from encoders.errors import MotionSeekError
from encoders.protocol import Encoder
from indexer.store.clips import Clip
from indexer.vectors.blocks import IndexRows
from indexer.vectors.milvus.collection_schema import CLIPS
from indexer.vectors.milvus.milvus_address import MilvusAddress
from search.milvus_library import MilvusLibrary
from search.query.filters import FilterArguments
from search.server.served.served_library import ServedLibrary

#: Seconds between two looks for changes: an answer may be so much older than the collection.
_POLL_SECONDS = 2.0
#: Clips that the map shows.
_ON_MAP = 5000


@dataclass(frozen=True)
class CollectionState:
    """The state of a collection when it was last looked at."""

    generation: int
    count: int


class ServedCollection(MilvusLibrary, ServedLibrary):
    """A collection for a server. Safe to share between threads."""

    def __init__(
        self,
        address: MilvusAddress | str,
        *,
        bundle: Encoder | None = None,
        poses: str | PathLike[str] | None = None,
    ) -> None:
        super().__init__(address, bundle=bundle, poses=poses)
        self._error: MotionSeekError | None = None
        self._state = self._look()
        self.answer_cache.clear(self._state.generation)
        self._stop = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True, name="collection refresh")

    def start(self) -> None:
        """See `ServedLibrary.start`."""
        self._watcher.start()

    def close(self) -> None:
        """See `MilvusLibrary.close`."""
        self._stop.set()
        if self._watcher.is_alive():
            self._watcher.join()
        super().close()

    @property
    def snapshot(self) -> CollectionState:
        """See `ServedLibrary.snapshot`."""
        if self._error is not None:
            raise self._error
        return self._state

    def refresh(self) -> bool:
        """See `ServedLibrary.refresh`."""
        try:
            state = self._look()
        except MotionSeekError as error:
            self._error = error
            return True
        changed = self._error is not None or state.generation != self._state.generation
        if changed:
            self._state, self._error = state, None
            self.answer_cache.clear(state.generation)
        return changed

    def _look(self) -> CollectionState:
        return CollectionState(self.collection.generation(), self.collection.count(CLIPS))

    def _watch(self) -> None:
        while not self._stop.wait(_POLL_SECONDS):
            self.refresh()

    def page(
        self, filters: FilterArguments, first: int, count: int, seed: int | None = None, sort: str | None = None
    ) -> tuple[int, list[Clip]]:
        """See `ServedLibrary.page`: in an order that Milvus chooses, whatever the seed; none are sorted."""
        if sort is not None:
            self.sorted_ids(sort)
        total, clips = self.some_clips(filters, first, count)
        return total, list(clips)

    @property
    def previews(self) -> Path | None:
        """None: it is on no disk of this machine."""
        return None

    def clips_of_map(self) -> IndexRows:
        """A sample: a map of all would be a point or more for each dot of a screen."""
        rows = self.collection.rows(CLIPS, "", ("clip", "vector", "duration"), limit=_ON_MAP)
        if not rows:
            return IndexRows.none(self.collection.size)
        return IndexRows(
            np.array([row["clip"] for row in rows], np.int64),
            np.array([(0.0, row["duration"]) for row in rows], np.float32),
            np.array([row["vector"] for row in rows], np.float16),
        )
