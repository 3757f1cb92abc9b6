"""A library for concurrent readers: indexes, rows and query vectors in memory, kept up to date in the background.

Searches run on a snapshot of the indexes. A thread replaces it when the library on disk has changed, so that no search
waits for an index to be updated: while clips were only added, an answer without them is one of the generation before.
Where a clip was changed or removed, the question that comes first catches up.
"""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import MotionSeekError
from encoders.protocol import Encoder
from indexer.store.clips import Caption, Clip
from indexer.store.library_reader import FileId
from indexer.store.marks.marks_table import Marks
from indexer.vectors.blocks import IndexRows
from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.library_indexes import CLIPS, WINDOWS
from search.query.filters import FilterArguments, Filters
from search.ranking.clip_scores import highest_scores
from search.ranking.variety import varied
from search.server.added_text import AddedText
from search.server.lru_cache import LruCache
from search.server.served.served_library import ServedLibrary

if TYPE_CHECKING:
    from typing_extensions import Unpack

Ids = NDArray[np.int64]
Vectors = NDArray[np.float32]

#: Clips that the map shows: with more, it would take longer to send than to look at.
_ON_MAP = 100_000
#: Seconds between two checks for changes on disk.
_POLL_SECONDS = 0.5
#: How often a question waits for the library to be caught up with before it reads what it needs for itself.
_ATTEMPTS = 3
_CHANGED = "SELECT id FROM clips WHERE generation > ?"


@dataclass(frozen=True)
class Snapshot:
    """The indexes of one generation, the number of clips, the highest id, the generations of captions and marks."""

    file: FileId
    generation: int
    clips: FaissIndex
    windows: FaissIndex
    count: int
    newest: int
    captions: int
    marks: int


class SnapshotLibrary(ServedLibrary):
    """A library on disk for a server. Safe to share between threads."""

    def __init__(self, folder: Path, *, bundle: Encoder | None = None) -> None:
        super().__init__(folder, bundle=bundle)
        self._error: MotionSeekError | None = None
        self._id_cache: LruCache[Ids] = LruCache(64)
        self._clip_cache: LruCache[Clip] = LruCache(20_000)
        self._caption_cache: LruCache[list[Caption]] = LruCache(20_000)
        self._mark_cache: LruCache[Marks] = LruCache(20_000)
        with super().reading():
            self._snapshot = self._take_snapshot()
        self.answer_cache.clear(self._snapshot.generation)
        self._refreshing, self._caching = threading.Lock(), threading.Lock()
        self._stop = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True, name="library refresh")

    def start(self) -> None:
        """See `ServedLibrary.start`."""
        self._watcher.start()

    def close(self) -> None:
        """See `Library.close`."""
        self._stop.set()
        if self._watcher.is_alive():
            self._watcher.join()
        super().close()

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot that is searched now; inside `reading` always the same.

        Raises
        ------
        MotionSeekError
            If the library cannot be searched: it was removed, or re-encoded with another model since it was opened.
        """
        if self._error is not None:
            raise self._error
        pinned: Snapshot | None = getattr(self._local, "snapshot", None)
        return pinned or self._snapshot

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """See `StoredLibrary.reading`; the indexes are those of the same generation, but for clips added since."""
        if getattr(self._local, "snapshot", None) is not None:
            with super().reading() as connection:
                yield connection
            return
        for _ in range(_ATTEMPTS):
            with super().reading() as connection:
                snapshot = self._snapshot
                if not self._is_outdated(snapshot):
                    with self._pinned(snapshot):
                        yield connection
                    return
            self.refresh()
        with super().reading() as connection, self._pinned(self._take_snapshot()):
            yield connection

    @contextmanager
    def _pinned(self, snapshot: Snapshot) -> Iterator[None]:
        """Let this thread see that snapshot."""
        self._local.snapshot = snapshot
        try:
            yield
        finally:
            self._local.snapshot = None

    def _is_outdated(self, snapshot: Snapshot) -> bool:
        """Whether a clip of the snapshot was changed or removed, or a caption, in the state that is read."""
        return (
            self._local.file != snapshot.file
            or self.generation < snapshot.generation
            or max(self.captions_generation, self.marks_generation) > snapshot.generation
            or any(id <= snapshot.newest for (id,) in self.connection.execute(_CHANGED, (snapshot.generation,)))
        )

    def refresh(self) -> bool:
        """See `ServedLibrary.refresh`."""
        with self._refreshing:
            try:
                with super().reading():
                    if self._error is None and self.state == (self._snapshot.file, self._snapshot.generation):
                        return False
                    self._catch_up()
            except MotionSeekError as error:
                self._error = error
            return True

    def _catch_up(self) -> None:
        before = self._snapshot
        self._check(self.bundle)
        new = self._take_snapshot()
        if new.file != before.file or new.generation < before.generation:
            self._replace(before, new, self._id_cache, self._clip_cache, self._caption_cache, self._mark_cache)
        elif self._is_outdated(before):
            self._replace(before, new)
        else:
            added = [self.indexes.since(kind, self.connection, before.generation) for kind in (CLIPS, WINDOWS)]
            has_words = AddedText(self.connection, before.newest).has
            self.answer_cache.grow(new.generation, lambda queries: highest_scores(queries, *added), has_words)
            self._snapshot = new
        self._error = None

    def _replace(self, before: Snapshot, new: Snapshot, *caches: LruCache[Any]) -> None:
        """Search another snapshot, in which what was cached may be wrong."""
        with self._caching:
            self._snapshot = new
            self._clip_cache.drop(id for (id,) in self.connection.execute(_CHANGED, (before.generation,)))
            for cache in caches:
                cache.clear()
        self.answer_cache.clear(new.generation)

    def _take_snapshot(self) -> Snapshot:
        clips, windows = (self.indexes.current(kind, self.connection, serving=True) for kind in (CLIPS, WINDOWS))
        (newest,) = self.connection.execute("SELECT coalesce(max(id), 0) FROM clips").fetchone()
        changed = self.captions_generation, self.marks_generation
        return Snapshot(*self.state, clips, windows, len(clips), newest, *changed)

    def _watch(self) -> None:
        while not self._stop.wait(_POLL_SECONDS):
            try:
                self.refresh()
            except Exception as error:  # tried again at the next poll; the old snapshot is searched meanwhile
                self._error = error if isinstance(error, MotionSeekError) else self._error

    def __len__(self) -> int:
        return self.snapshot.count

    def nearest_clips(
        self, queries: Vectors, k: int, *, allowed: Ids | None = None, exact: bool = False
    ) -> tuple[Vectors, NDArray[np.int64]]:
        """See `Library.nearest_clips`."""
        return self.snapshot.clips.search(queries, k, allowed=allowed, exact=exact)[:2]

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: Ids | None = None, exact: bool = False
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """See `Library.nearest_windows`."""
        return self.snapshot.windows.search(queries, k, allowed=allowed, exact=exact)

    def vectors_of(self, ids: Ids) -> tuple[IndexRows, IndexRows]:
        """See `Library.vectors_of`."""
        return self.snapshot.clips.rows_of(ids), self.snapshot.windows.rows_of(ids)

    def allowed(self, **filters: Unpack[FilterArguments]) -> Ids | None:
        """See `Library.allowed`; what `ids` gives is cached for the snapshot."""
        return Filters.of(filters).ids(self)

    def ids(self, where: str = "", values: Sequence[Any] = ()) -> Ids:
        """See `Library.ids`."""
        key = (self.snapshot.generation, where, tuple(values))
        return self._id_cache.get_or(key, lambda: super(SnapshotLibrary, self).ids(where, values))

    def clips_by_id(self, ids: Iterable[int]) -> dict[int, Clip]:
        """See `StoredLibrary.clips_by_id`."""
        snapshot = self.snapshot
        cached = {int(i): self._clip_cache.get(int(i)) for i in ids}
        new = super().clips_by_id([i for i, clip in cached.items() if clip is None])
        with self._caching:
            if snapshot is self._snapshot:  # else they may have changed since they were read
                for i, clip in new.items():
                    self._clip_cache.put(i, clip)
        found = {i: new.get(i) if clip is None else clip for i, clip in cached.items()}
        return {i: clip for i, clip in found.items() if clip is not None}

    def captions(self, id: int) -> list[Caption]:
        """See `Library.captions`."""
        key = (self.snapshot.captions, int(id))
        return self._caption_cache.get_or(key, lambda: super(SnapshotLibrary, self).captions(id))

    def marks(self, id: int) -> Marks:
        """See `Library.marks`."""
        key = (self.snapshot.marks, int(id))
        return self._mark_cache.get_or(key, lambda: super(SnapshotLibrary, self).marks(id))

    def page(
        self, filters: FilterArguments, first: int, count: int, seed: int | None = None, sort: str | None = None
    ) -> tuple[int, list[Clip]]:
        """See `ServedLibrary.page`; else in order of their numbers."""
        allowed = self.allowed(**filters)
        ids = self.ids() if allowed is None else allowed
        if sort is not None:
            ids = self.sorted_among(sort, allowed)
        elif seed is not None:
            rows = self.snapshot.clips.rows
            passing = np.flatnonzero(np.isin(rows.owners, ids))
            ids = rows.owners[passing[varied(rows.vectors[passing], seed)]]
        return len(ids), list(self.clips_by_id(ids[first : first + count].tolist()).values())

    def clips_of_map(self) -> IndexRows:
        """See `ServedLibrary.clips_of_map`: all of them, or a sample where there are very many."""
        rows = self.snapshot.clips.rows
        if len(rows) <= _ON_MAP:
            return rows
        chosen = np.zeros(len(rows), np.bool_)
        chosen[np.random.default_rng(0).choice(len(rows), _ON_MAP, replace=False)] = True
        return rows[chosen]
