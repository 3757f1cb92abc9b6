"""What the routes share: the library, what was uploaded, what was answered, and how much is done at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

import anyio
import numpy as np
from anyio.to_thread import run_sync
from numpy.typing import NDArray

from indexer.store.clips import Clip
from search.hits import Hit
from search.query.question import Question
from search.server.cache import Cache
from search.server.exception_handlers import Refused
from search.server.microbatching import MicroBatcher, ServerBusy
from search.server.prometheus import Metrics
from search.server.snapshot_library import SearchRequest, SnapshotLibrary
from search.server.uploads import Upload, UploadLimits, UploadStore
from search.source import MotionSource

Value = TypeVar("Value")

#: Threads that compare vectors.
_SEARCHERS = 2
#: Long questions answered at once, and waiting.
_AT_ONCE, _WAITING = 2, 64
_REMEMBERED = 4096


class AppState:
    """One server's state."""

    def __init__(self, library: SnapshotLibrary, limits: UploadLimits | None = None) -> None:
        self.library = library
        self.uploads = UploadStore(limits)
        self.metrics = Metrics()
        self.sentences: MicroBatcher[str, NDArray[np.float32]] = MicroBatcher(library.encode_all)
        self.searches: MicroBatcher[SearchRequest, list[Hit]] = MicroBatcher(
            library.search_all, workers=_SEARCHERS, largest=2
        )
        self.answers: Cache[bytes] = Cache(_REMEMBERED)
        self._room = anyio.CapacityLimiter(_AT_ONCE)

    def close(self) -> None:
        """Let go of threads and files."""
        self.sentences.close()
        self.searches.close()
        self.library.close()

    async def search(self, question: SearchRequest) -> list[Hit]:
        """The answer to a search.

        Sentences that nobody has asked before are encoded together, apart from the searches: encoding takes ten times
        as long, and whoever asks what is known need not wait for it.

        Raises
        ------
        QueryError
            If the sentence is empty or a filter makes no sense.
        ServerBusy
            If too many wait already.
        """
        Question.of(question.text, split_steps=False)
        if not self.library.knows(question.text):
            await self.sentences.ask(question.text)
        return await self.searches.ask(question)

    async def at_length(self, work: Callable[[], Value]) -> Value:
        """The result of work that takes a while, done in a thread, only a few at once.

        Raises
        ------
        ServerBusy
            If too many wait already.
        """
        if self._room.statistics().tasks_waiting >= _WAITING:
            raise ServerBusy
        return await run_sync(work, limiter=self._room)

    async def remembered(self, key: Sequence[Hashable], make: Callable[[], bytes]) -> bytes:
        """An answer given before to the same question of the same state of the library, or made at length."""
        full = (self.library.snapshot.generation, *key)
        document = self.answers.get(full)
        if document is None:
            document = await self.at_length(make)
            self.answers.put(full, document)
        return document

    def clip(self, ref: str) -> Clip | Upload:
        """The clip or upload that is meant.

        Raises
        ------
        Refused
            404 if there is none.
        """
        found = self.uploads.get(ref) if ref.startswith("u") else self.library.clips([int(ref)]).get(int(ref))
        if found is None:
            said = "this upload is no longer here; drop the file again" if ref.startswith("u") else f"no clip #{ref}"
            raise Refused(404, said)
        return found

    def source(self, ref: str) -> MotionSource:
        """The motion that is meant, with what is known of it; see `clip`."""
        found = self.clip(ref)
        if isinstance(found, Upload):
            return found.source
        source = MotionSource.of_clip(self.library, found)
        # A link that now leads out of the indexed folder is not followed.
        inside = found.file.resolve().is_relative_to(found.root)
        return source if inside else dataclasses.replace(source, file=None)
