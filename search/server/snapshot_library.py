"""A library that many ask at once: its indexes held ready, its answers remembered, its growth seen.

Questions are answered from a snapshot. A thread replaces it when the library on disk has grown, so that no question
ever waits for an index to be caught up.
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
from indexer.vectors.flat import FlatVectors
from indexer.vectors.sync import CLIPS, WINDOWS
from search.hits import Hit
from search.library import Library, Ref
from search.query.encoding import encode_queries
from search.query.question import Question
from search.server.answer_cache import AnswerCache, StaleCriterion
from search.server.cache import Cache
from search.source import MotionSource

Ids = NDArray[np.int64]
Vectors = NDArray[np.float32]

#: Seconds between two looks at whether the library has grown.
_LOOK_EVERY = 0.5
#: By how much the same score may differ from one way of adding up to another.
_ROUNDING = 1e-5
_CHANGED = "SELECT id FROM clips WHERE generation > ?"
# Each caption as a number, so mixed that exchanging anything between two of them changes the sum. Without a limit
# SQLite would work each of them out twice.
_SAID_OF = (
    "SELECT count(*), total(mixed * mixed % 2147483629) FROM (SELECT (id * 31 + clip_id * 1000003 + "
    "coalesce(text_id, 0) * 10007 + CAST(coalesce(captions.start, -1) * 1000 AS INT) * 101 + "
    "CAST(coalesce(captions.end, -1) * 1000 AS INT) * 211) % 2147483647 AS mixed FROM captions WHERE {} LIMIT -1)"
)
_SAID = _SAID_OF.format("clip_id IS NOT NULL")
_SAID_BEFORE = _SAID_OF.format(f"clip_id NOT IN ({_CHANGED})")
_NEWEST = "SELECT coalesce(max(id), 0) FROM clips WHERE generation <= ?"


@dataclass(frozen=True)
class Snapshot:
    """The vectors of one generation, the number of clips, the newest one, and numbers that change with any caption."""

    generation: int
    clips: FlatVectors
    windows: FlatVectors
    count: int
    newest: int
    said: tuple[float, ...]


@dataclass(frozen=True)
class SearchRequest:
    """A question to the whole library; `filters` as pairs, so that it can be remembered."""

    text: str
    k: int
    filters: tuple[tuple[str, Any], ...] = ()


class SnapshotLibrary(Library):
    """A `Library` for a server. Safe to share between threads."""

    def __init__(self, folder: Path, *, bundle: Encoder | None = None) -> None:
        super().__init__(folder, bundle=bundle)
        self._trouble: MotionSeekError | None = None
        self._held_queries: Cache[Vectors] = Cache(16_384)
        self._held_ids: Cache[Ids] = Cache(64)
        self._held_clips: Cache[Clip] = Cache(20_000)
        self._held_captions: Cache[list[Caption]] = Cache(20_000)
        self._snapshot = self._look()
        self.standing = AnswerCache(self._snapshot.generation)
        self._refreshing = threading.Lock()
        self._stop = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True, name="watching the library")

    def warm(self) -> None:
        """Load the model and answer once, so that the first who asks need not wait for it."""
        self.search_all([SearchRequest("a person walks", 1)])

    def start(self) -> None:
        """Begin to watch for growth."""
        self._watcher.start()

    def close(self) -> None:
        """See `Library.close`."""
        self._stop.set()
        if self._watcher.is_alive():
            self._watcher.join()
        super().close()

    @property
    def snapshot(self) -> Snapshot:
        """What is answered from now.

        Raises
        ------
        BundleMismatch
            If the library was re-encoded with another model since it was opened.
        """
        if self._trouble is not None:
            raise self._trouble
        return self._snapshot

    def refresh(self) -> bool:
        """Catch up with the library on disk; whether there was anything new."""
        with self._refreshing:
            if self.generation == self._snapshot.generation and self._trouble is None:
                return False
            try:
                self._check(self.bundle)
                new = self._look()
                self._let_stand(new.generation)
                before, self._snapshot = self._snapshot.generation, new
                self._held_clips.drop(id for (id,) in self.connection.execute(_CHANGED, (before,)))
                self._trouble = None
            except MotionSeekError as error:
                self._trouble = error
            return True

    def _let_stand(self, generation: int) -> None:
        """Keep the answers that are right in this generation, too."""
        before, connection = self._snapshot, self.connection
        if connection.execute(_SAID_BEFORE, (before.generation,)).fetchone() != before.said:
            self.standing.clear(generation)  # a caption that is shown may have changed
            return
        if any(id <= before.newest for (id,) in connection.execute(_CHANGED, (before.generation,))):
            self.standing.clear(generation)  # what went or changed may have kept something else out of an answer
            return
        added = [self._galleries.since(kind, connection, before.generation).vectors for kind in (CLIPS, WINDOWS)]
        self.standing.grow(generation, np.concatenate(added).astype(np.float32))

    def grounds(self, question: SearchRequest, hits: Sequence[Hit]) -> StaleCriterion:
        """What the answer to a question stands on: what no clip and no window may reach that comes later."""
        floor = hits[-1].score - _ROUNDING if len(hits) == question.k else -np.inf
        return StaleCriterion(self.encode_all([question.text])[0], floor)

    def _look(self) -> Snapshot:
        clips, windows = (self._galleries.current(kind, self.connection, often=True) for kind in (CLIPS, WINDOWS))
        said = self.connection.execute(_SAID).fetchone()
        generation = min(clips.generation, windows.generation)
        (newest,) = self.connection.execute(_NEWEST, (generation,)).fetchone()
        return Snapshot(generation, clips, windows, len(clips), newest, said)

    def _watch(self) -> None:
        while not self._stop.wait(_LOOK_EVERY):
            try:
                self.refresh()
            except Exception as error:  # a look that fails is tried again; questions are answered meanwhile
                self._trouble = error if isinstance(error, MotionSeekError) else self._trouble

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
        return self._held_ids.get_or(key, lambda: super(SnapshotLibrary, self).ids(where, values))

    def clips(self, ids: Iterable[int]) -> dict[int, Clip]:
        """See `Library.clips`."""
        asked = self.snapshot
        held = {int(i): self._held_clips.get(int(i)) for i in ids}
        new = super().clips([i for i, clip in held.items() if clip is None])
        for i, clip in new.items():
            if asked is self._snapshot:  # else it may have changed since it was read
                self._held_clips.put(i, clip)
        found = {i: new.get(i) if clip is None else clip for i, clip in held.items()}
        return {i: clip for i, clip in found.items() if clip is not None}

    def captions(self, id: int) -> list[Caption]:
        """See `Library.captions`."""
        key = (self.snapshot.said, int(id))
        return self._held_captions.get_or(key, lambda: super(SnapshotLibrary, self).captions(id))

    def source(self, ref: Ref | MotionSource) -> MotionSource:
        """See `Library.source`; a source is itself."""
        return ref if isinstance(ref, MotionSource) else super().source(ref)

    def knows(self, sentence: str) -> bool:
        """Whether a sentence's query vector is at hand."""
        return self._held_queries.get(sentence) is not None

    def encode_all(self, sentences: Sequence[str]) -> list[Vectors]:
        """Query vectors (D,) of sentences, encoded together and remembered."""
        vectors = self._encoded(set(sentences))
        return [vectors[sentence] for sentence in sentences]

    def search_all(self, questions: Sequence[SearchRequest]) -> list[list[Hit] | Exception]:
        """Answer many questions; an answer is what `search` gives or raises."""
        answers: list[list[Hit] | Exception] = [self._askable(question) or [] for question in questions]
        sound = [i for i, answer in enumerate(answers) if not isinstance(answer, Exception)]
        vectors = self._encoded({questions[i].text for i in sound})
        for i in sound:
            answers[i] = self._answered(questions[i], vectors[questions[i].text])
        return answers

    def _encoded(self, sentences: set[str]) -> dict[str, Vectors]:
        """The query vectors of sentences, encoded now where they are not remembered."""
        held = {sentence: self._held_queries.get(sentence) for sentence in sentences}
        new = [sentence for sentence, vector in held.items() if vector is None]
        found = dict(zip(new, encode_queries(self.bundle, new), strict=True)) if new else {}
        for sentence, vector in found.items():
            self._held_queries.put(sentence, vector)
        return found | {sentence: vector for sentence, vector in held.items() if vector is not None}

    def _askable(self, question: SearchRequest) -> Exception | None:
        try:
            Question.of(question.text, split_steps=False)
            self.snapshot  # noqa: B018  raises where the library cannot be asked
        except MotionSeekError as error:
            return error
        return None

    def _answered(self, question: SearchRequest, vector: Vectors) -> list[Hit] | Exception:
        try:
            return self._found(question, vector)
        except KeyError:  # a clip has gone since the snapshot
            self.refresh()
        except Exception as error:
            return error
        try:
            return self._found(question, vector)
        except Exception as error:
            return error

    def _found(self, question: SearchRequest, vector: Vectors) -> list[Hit]:
        return self._sentence_hits(question.text, vector, question.k, dict(question.filters))
