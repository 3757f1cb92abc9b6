"""A library for concurrent readers: indexes, rows and query vectors in memory, kept up to date in the background.

Searches run on a snapshot of the indexes. A thread replaces it when the library on disk has changed, so that no search
waits for an index to be updated.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import MotionSeekError
from encoders.protocol import Encoder
from indexer.store.clips import Caption, Clip
from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.library_indexes import CLIPS, WINDOWS
from search.hits import Hits
from search.library import Library
from search.query.encoding import encode_queries
from search.query.filters import FilterArguments
from search.query.question import EncodedQuestion, Question
from search.server.answer_cache import AnswerCache, StaleCriterion
from search.server.lru_cache import LruCache

Ids = NDArray[np.int64]
Vectors = NDArray[np.float32]

#: Seconds between two checks for changes on disk.
_POLL_SECONDS = 0.5
#: By how much a score may differ between two orders of summation.
_ROUNDING = 1e-5
_CHANGED = "SELECT id FROM clips WHERE generation > ?"
_NEWEST = "SELECT coalesce(max(id), 0) FROM clips WHERE generation <= ?"


@dataclass(frozen=True)
class Snapshot:
    """The indexes of one generation, the number of clips, the highest clip id, and the captions' generation."""

    generation: int
    clips: FaissIndex
    windows: FaissIndex
    count: int
    newest: int
    captions: int


@dataclass(frozen=True)
class SearchRequest:
    """A search of the whole library.

    Attributes
    ----------
    question : EncodedQuestion
    k : int
        The number of hits, at most.
    filters : FilterArguments
    """

    question: EncodedQuestion
    k: int
    filters: FilterArguments


class SnapshotLibrary(Library):
    """A `Library` for a server. Safe to share between threads."""

    def __init__(self, folder: Path, *, bundle: Encoder | None = None) -> None:
        super().__init__(folder, bundle=bundle)
        self._error: MotionSeekError | None = None
        self._query_cache: LruCache[Vectors] = LruCache(16_384)
        self._id_cache: LruCache[Ids] = LruCache(64)
        self._clip_cache: LruCache[Clip] = LruCache(20_000)
        self._caption_cache: LruCache[list[Caption]] = LruCache(20_000)
        self._snapshot = self._take_snapshot()
        self.answer_cache = AnswerCache(self._snapshot.generation)
        self._refreshing = threading.Lock()
        self._stop = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True, name="library refresh")

    def warm(self) -> None:
        """Load the model and search once, so that the first request does not wait for it."""
        self.search("a person walks", 1)

    def start(self) -> None:
        """Start the thread that watches for changes on disk."""
        self._watcher.start()

    def close(self) -> None:
        """See `Library.close`."""
        self._stop.set()
        if self._watcher.is_alive():
            self._watcher.join()
        super().close()

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot that is searched now.

        Raises
        ------
        BundleMismatch
            If the library was re-encoded with another model since it was opened.
        """
        if self._error is not None:
            raise self._error
        return self._snapshot

    def refresh(self) -> bool:
        """Catch up with the library on disk; whether it has changed."""
        with self._refreshing:
            if self.generation == self._snapshot.generation and self._error is None:
                return False
            try:
                self._check(self.bundle)
                new = self._take_snapshot()
                self._invalidate_answers(new.generation)
                before, self._snapshot = self._snapshot.generation, new
                self._clip_cache.drop(id for (id,) in self.connection.execute(_CHANGED, (before,)))
                self._error = None
            except MotionSeekError as error:
                self._error = error
            return True

    def _invalidate_answers(self, generation: int) -> None:
        """Drop the cached answers that may be stale in this generation."""
        before, connection = self._snapshot, self.connection
        if self.captions_generation > before.generation:
            self.answer_cache.clear(generation)  # a caption in an answer may have changed
            return
        if any(id <= before.newest for (id,) in connection.execute(_CHANGED, (before.generation,))):
            self.answer_cache.clear(generation)  # a clip that was removed or changed may have displaced another one
            return
        added = [self.indexes.since(kind, connection, before.generation).vectors for kind in (CLIPS, WINDOWS)]
        self.answer_cache.grow(generation, np.concatenate(added).astype(np.float32))

    def stale_criterion(self, request: SearchRequest, hits: Hits) -> StaleCriterion:
        """What makes the answer to a request stale: an added row that scores as much as its last hit."""
        threshold = hits[-1].score - _ROUNDING if len(hits) == request.k else -np.inf
        return StaleCriterion(request.question.vectors[0], threshold)

    def _take_snapshot(self) -> Snapshot:
        clips, windows = (self.indexes.current(kind, self.connection, serving=True) for kind in (CLIPS, WINDOWS))
        generation = min(clips.generation, windows.generation)
        (newest,) = self.connection.execute(_NEWEST, (generation,)).fetchone()
        return Snapshot(generation, clips, windows, len(clips), newest, self.captions_generation)

    def _watch(self) -> None:
        while not self._stop.wait(_POLL_SECONDS):
            try:
                self.refresh()
            except Exception as error:  # tried again at the next poll; the old snapshot is searched meanwhile
                self._error = error if isinstance(error, MotionSeekError) else self._error

    def __len__(self) -> int:
        return self.snapshot.count

    def nearest_clips(
        self, queries: Vectors, k: int, *, allowed: Ids | None = None
    ) -> tuple[Vectors, NDArray[np.int64]]:
        """See `Library.nearest_clips`."""
        return self.snapshot.clips.search(queries, k, allowed=allowed)[:2]

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: Ids | None = None
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """See `Library.nearest_windows`."""
        return self.snapshot.windows.search(queries, k, allowed=allowed)

    def ids(self, where: str = "", values: Sequence[Any] = ()) -> Ids:
        """See `Library.ids`."""
        key = (self.snapshot.generation, where, tuple(values))
        return self._id_cache.get_or(key, lambda: super(SnapshotLibrary, self).ids(where, values))

    def clips_by_id(self, ids: Iterable[int]) -> dict[int, Clip]:
        """See `StoredLibrary.clips_by_id`."""
        snapshot = self.snapshot
        cached = {int(i): self._clip_cache.get(int(i)) for i in ids}
        new = super().clips_by_id([i for i, clip in cached.items() if clip is None])
        for i, clip in new.items():
            if snapshot is self._snapshot:  # else it may have changed since it was read
                self._clip_cache.put(i, clip)
        found = {i: new.get(i) if clip is None else clip for i, clip in cached.items()}
        return {i: clip for i, clip in found.items() if clip is not None}

    def captions(self, id: int) -> list[Caption]:
        """See `Library.captions`."""
        key = (self.snapshot.captions, int(id))
        return self._caption_cache.get_or(key, lambda: super(SnapshotLibrary, self).captions(id))

    def is_encoded(self, sentence: str) -> bool:
        """Whether the query vector of a sentence is cached."""
        return self._query_cache.get(sentence) is not None

    def encode(self, question: Question) -> EncodedQuestion:
        """See `Library.encode`."""
        return EncodedQuestion(np.stack(self.encode_all(question.sentences)), question.sentences, question.how)

    def encode_all(self, sentences: Sequence[str]) -> list[Vectors]:
        """Query vectors (D,) of sentences; those that are not cached are encoded in one batch."""
        cached = {sentence: self._query_cache.get(sentence) for sentence in sentences}
        new = [sentence for sentence, vector in cached.items() if vector is None]
        encoded = dict(zip(new, encode_queries(self.bundle, new), strict=True)) if new else {}
        for sentence, vector in encoded.items():
            self._query_cache.put(sentence, vector)
        found = encoded | {sentence: vector for sentence, vector in cached.items() if vector is not None}
        return [found[sentence] for sentence in sentences]

    def search_all(self, requests: Sequence[SearchRequest]) -> list[Hits | Exception]:
        """The hits of each request, or the exception that `search` would raise."""
        return [self._hits_or_error(request) for request in requests]

    def _hits_or_error(self, request: SearchRequest) -> Hits | Exception:
        try:
            return self._search_once(request)
        except KeyError:  # a clip was removed after the snapshot
            self.refresh()
        except Exception as error:
            return error
        try:
            return self._search_once(request)
        except Exception as error:
            return error

    def _search_once(self, request: SearchRequest) -> Hits:
        self.snapshot  # noqa: B018  raises where the library cannot be searched
        return self.search_encoded(request.question, request.k, **request.filters)
