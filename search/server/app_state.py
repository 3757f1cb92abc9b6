"""What the routes share: the library, uploads, cached responses, and the queues that limit concurrent work."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

import anyio
import numpy as np
from anyio.to_thread import run_sync
from numpy.typing import NDArray
from starlette.exceptions import HTTPException

from indexer.store.clips import Clip
from search.hits import Hits
from search.query.question import EncodedQuestion, Question
from search.server.lru_cache import LruCache
from search.server.microbatching import MicroBatcher, ServerBusy
from search.server.prometheus import Metrics
from search.server.responses import JsonAnswer
from search.server.served.served_library import SearchRequest, ServedLibrary
from search.server.uploads.upload_store import Upload, UploadLimits, UploadStore
from search.source import MotionSource

Value = TypeVar("Value")

#: Threads that search the vector indexes.
_SEARCH_WORKERS = 2
#: Slow requests processed at the same time, and queued.
_SLOW_AT_ONCE, _SLOW_QUEUE = 2, 64
_CACHED_RESPONSES = 4096


class AppState:
    """The state of one server."""

    def __init__(self, library: ServedLibrary, limits: UploadLimits | None = None, *, edit: bool = False) -> None:
        self.edit = edit
        self.library = library
        self.uploads = UploadStore(limits)
        self.metrics = Metrics()
        self.text_batches: MicroBatcher[str, NDArray[np.float32]] = MicroBatcher(library.encode_all)
        self.search_batches: MicroBatcher[SearchRequest, Hits] = MicroBatcher(
            library.search_all, workers=_SEARCH_WORKERS, max_batch=2
        )
        self._responses: LruCache[JsonAnswer] = LruCache(_CACHED_RESPONSES)
        self._slow = anyio.CapacityLimiter(_SLOW_AT_ONCE)
        self._looking = anyio.CapacityLimiter(1)

    def close(self) -> None:
        """End the threads and close the library."""
        self.text_batches.close()
        self.search_batches.close()
        self.library.close()

    async def encode(self, question: Question) -> EncodedQuestion:
        """The question with its query vectors.

        New sentences are encoded in batches of their own: that takes ten times as long as a search, and searches for
        known sentences need not wait for it.

        Raises
        ------
        ServerBusy
            If too many sentences are queued.
        """
        for sentence in question.sentences:
            if not self.library.is_encoded(sentence):
                await self.text_batches.submit(sentence)
        return self.library.encode(question)

    async def run_slow(self, work: Callable[[], Value]) -> Value:
        """The result of slow work on one snapshot of the library, run in a thread, only a few at the same time.

        Raises
        ------
        ServerBusy
            If too many are queued.
        """
        if self._slow.statistics().tasks_waiting >= _SLOW_QUEUE:
            raise ServerBusy
        return await run_sync(self._on_snapshot, work, limiter=self._slow)

    async def run_change(self, work: Callable[[], Value]) -> Value:
        """The result of work that changes the library, which sees what it has changed; queued as slow work is.

        Raises
        ------
        ServerBusy
            If too many are queued.
        """
        if self._slow.statistics().tasks_waiting >= _SLOW_QUEUE:
            raise ServerBusy
        return await run_sync(work, limiter=self._slow)

    def _on_snapshot(self, work: Callable[[], Value]) -> Value:
        with self.library.reading():
            return work()

    async def cached(self, key: Sequence[Hashable], make: Callable[[], JsonAnswer]) -> bytes:
        """The cached answer of the library's present generation, else `make()`, run as slow work."""
        full = (self.library.snapshot.generation, *key)
        answer = await self.still_true(self._responses.get(full))
        if answer is None:
            answer = await self.run_slow(make)
            self._responses.put(full, answer)
        return answer.data

    async def still_true(self, answer: JsonAnswer | None) -> JsonAnswer | None:
        """A cached answer, unless a file of its hits has changed, gone or come back since.

        Files of one answer are looked at at a time, as a disk may be slow; meanwhile others are given as they are.
        """
        if answer is None or answer.is_recent or not self._looking.available_tokens:
            return answer
        holds = await run_sync(self._on_snapshot, lambda: answer.holds(self.library), limiter=self._looking)
        return answer if holds else None

    def clip(self, ref: str) -> Clip | Upload:
        """The clip of a number ("12" or "#12"), or the upload of a key.

        Raises
        ------
        HTTPException
            404 if there is none.
        """
        if ref.startswith("u"):
            upload = self.uploads.get(ref)
            if upload is None:
                raise HTTPException(404, "this upload is no longer kept; upload the file again")
            return upload
        number = int(ref.removeprefix("#"))
        clip = self.library.clips_by_id([number]).get(number)
        if clip is None:
            raise HTTPException(404, f"no clip #{number}")
        return clip

    def source(self, ref: str) -> MotionSource:
        """The motion of a clip or an upload; see `clip`."""
        found = self.clip(ref)
        if isinstance(found, Upload):
            return found.source
        source = MotionSource.of_clip(self.library, found)
        # A symbolic link that leads out of the indexed folder is not followed.
        inside = found.file is None or found.file.resolve().is_relative_to(found.root)
        return source if inside else dataclasses.replace(source, file=None)
