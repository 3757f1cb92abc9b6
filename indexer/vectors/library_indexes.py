"""The two vector indexes of a library, clips and windows, kept up to date with its SQLite file."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import ends_of
from indexer.vectors.blocks import IndexRows
from indexer.vectors.clustered_file import RowSource
from indexer.vectors.faiss_index import CLUSTERED_FROM, COMPACT_AT, COMPACT_AT_SERVING, FaissIndex
from indexer.vectors.index_files import build, load, save


@dataclass(frozen=True)
class IndexKind:
    """One of the indexes: its name, and how its rows are read; the query takes a model and a generation."""

    name: str
    query: str


# The few clips that changed come first, by their index, so that catching up never reads the whole library.
_CHANGED = (
    "JOIN clips ON clips.id = clip_id WHERE model_id = ? AND clip_id IN (SELECT clips.id FROM clips "
    "JOIN files ON files.id = clips.file_id WHERE files.state = 'indexed' AND clips.generation > ?) ORDER BY clip_id"
)
CLIPS = IndexKind(
    "clips", f"SELECT clip_id, duration, NULL AS length, NULL AS starts, vector FROM embeddings {_CHANGED}"
)
WINDOWS = IndexKind("windows", f"SELECT clip_id, duration, length, starts, vectors FROM windows {_CHANGED}, length")


#: Rows of a query that are read at a time: of clips, or of windows of one length.
_PIECE = 2048

#: Indexes of a kind in memory: the newest, and where both share their main block that of the generation before, which
#: another thread may be reading.
_HELD = 2


class LibraryIndexes:
    """The indexes of one library; brought up to date when they are requested."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = threading.Lock()
        self._held: dict[str, list[_Held]] = {CLIPS.name: [], WINDOWS.name: []}
        #: Why an index could not be saved, so that each process makes its own; empty if it could.
        self.unsaved = ""

    def current(self, kind: IndexKind, connection: sqlite3.Connection, *, serving: bool = False) -> FaissIndex:
        """The index of this kind as of the snapshot that the connection reads.

        It comes from memory, else from its file, caught up with what changed since.

        Parameters
        ----------
        connection : sqlite3.Connection
            In a transaction, so that all that is read is of one generation.
        serving : bool
            Prepare it for many searches (see `FaissIndex.for_serving`), and map no file.
        """
        assert connection.in_transaction
        state = _State.of(connection)
        with self._lock:
            held = next((held for held in self._held[kind.name] if held.is_known_to(state)), None)
            if held is None or held.index.generation < state.generation:
                held = self._refresh(kind, state, held, serving)
            return held.index

    def since(self, kind: IndexKind, connection: sqlite3.Connection, generation: int) -> IndexRows:
        """The rows of the live clips that came or changed after a generation."""
        return _rows(kind, _State.of(connection), generation)

    def stored(self, kind: IndexKind, connection: sqlite3.Connection) -> Iterator[IndexRows]:
        """The rows of all live clips in pieces, as the database has them."""
        return _pieces(kind, _State.of(connection), -1)

    def _refresh(self, kind: IndexKind, state: _State, held: _Held | None, serving: bool) -> _Held:
        """The index of a state, from an older one in memory or on disk; it is held from now on."""
        origin = state.origin_of(state.generation) or ""
        index = held.index if held else load(self._folder, kind.name, state.origin_of, state.size, mapped=not serving)
        compact_at = COMPACT_AT_SERVING if serving else COMPACT_AT
        if index is None:
            index = self._built(kind, state, origin, serving)
        elif index.generation < state.generation:
            most = compact_at * len(index.main)
            caught_up = None if _count(kind, state, index.generation) > most else _caught_up(kind, state, index)
            is_due = caught_up is None or caught_up.changes > most
            index = self._built(kind, state, origin, serving) if caught_up is None or is_due else caught_up
        fresh = _Held(origin, index.for_serving() if serving else index)
        before = [other for other in self._held[kind.name] if other.index.shares_block(fresh.index)]
        self._held[kind.name] = [fresh, *before][:_HELD]
        return fresh

    def _built(self, kind: IndexKind, state: _State, origin: str, serving: bool) -> FaissIndex:
        """An index of all rows. That of very many is written in pieces, so that memory does not grow with them."""
        if _count(kind, state, -1) >= CLUSTERED_FROM and os.access(self._folder.parent, os.W_OK):
            source = RowSource(state.size, lambda: _pieces(kind, state, -1))
            try:
                return build(source, self._folder, kind.name, state.generation, origin, mapped=not serving)
            except (OSError, RuntimeError) as error:
                self.unsaved = getattr(error, "strerror", None) or "a file cannot be written"
                return FaissIndex.of(state.generation, _rows(kind, state, -1))
        return self._saved(kind, origin, FaissIndex.of(state.generation, _rows(kind, state, -1)), serving)

    def _saved(self, kind: IndexKind, origin: str, index: FaissIndex, serving: bool) -> FaissIndex:
        """Save the index where the folder can be written; it is derived data, so elsewhere nothing is lost."""
        if len(index) and os.access(self._folder.parent, os.W_OK):
            try:
                return save(index, self._folder, kind.name, origin, mapped=not serving)
            except (OSError, RuntimeError) as error:  # FAISS raises RuntimeError where a file cannot be written
                self.unsaved = getattr(error, "strerror", None) or "a file cannot be written"
        return index


@dataclass(frozen=True)
class _State:
    """What a snapshot of the library says of its indexes: the generation, and the model whose vectors are searched."""

    connection: sqlite3.Connection
    generation: int
    identity: int
    fingerprint: str
    model_id: int
    size: int

    @classmethod
    def of(cls, connection: sqlite3.Connection) -> _State:
        settings = dict(connection.execute("SELECT key, value FROM settings").fetchall())
        model = connection.execute(
            "SELECT fingerprint, id, size FROM models WHERE id = ?", (settings.get("model"),)
        ).fetchone()
        return cls(connection, settings["generation"], settings["identity"], *(model or ("", -1, 1)))

    def origin_of(self, generation: int) -> str | None:
        """What the vectors of a generation are of; None where the library has not been through it.

        A library that is copied and goes on elsewhere comes to the same number of a generation with other content.
        """
        try:
            row = self.connection.execute(
                "SELECT stamp FROM generations WHERE generation = ?", (generation,)
            ).fetchone()
        except sqlite3.OperationalError:  # a library of an earlier version, which only `index` brings up to date
            row = (0,)
        return None if row is None else f"{self.identity:x} {row[0]:x} {self.fingerprint}"


@dataclass(frozen=True)
class _Held:
    """An index in memory, and what it was made from."""

    origin: str
    index: FaissIndex

    def is_known_to(self, state: _State) -> bool:
        return self.index.generation <= state.generation and self.origin == state.origin_of(self.index.generation)


def _caught_up(kind: IndexKind, state: _State, index: FaissIndex) -> FaissIndex:
    """The index with what changed since; nothing of it is in its main block."""
    changed = state.connection.execute("SELECT id FROM clips WHERE generation > ?", (index.generation,))
    remove = np.array([row[0] for row in changed], np.int64)
    return index.update(state.generation, remove=remove, add=_rows(kind, state, index.generation), compact_at=np.inf)


def _count(kind: IndexKind, state: _State, generation: int) -> int:
    """How many rows of live clips changed after `generation`."""
    query = f"SELECT total(ifnull(length(starts), 4) / 4) FROM ({kind.query})"
    return int(state.connection.execute(query, (state.model_id, generation)).fetchone()[0])


def _rows(kind: IndexKind, state: _State, generation: int) -> IndexRows:
    """The vectors of the live clips that changed after `generation`."""
    return IndexRows.join([IndexRows.none(state.size), *_pieces(kind, state, generation)])


def _pieces(kind: IndexKind, state: _State, generation: int) -> Iterator[IndexRows]:
    """The same in pieces."""
    rows = state.connection.execute(kind.query, (state.model_id, generation))
    while parts := list(_parts(rows.fetchmany(_PIECE))):
        counts = [len(starts) for _, starts, _, _ in parts]
        owners = np.repeat(np.array([owner for owner, *_ in parts], np.int64), counts)
        spans = np.stack([np.concatenate([part[column] for part in parts]) for column in (1, 2)], axis=1)
        packed = np.frombuffer(b"".join(part[3] for part in parts), np.float16).reshape(-1, state.size)
        yield IndexRows(owners, spans, packed)


def _parts(rows: Iterable[Any]) -> Iterator[tuple[int, NDArray[np.float32], NDArray[np.float32], bytes]]:
    for owner, duration, length, starts, packed in rows:
        if length is None:
            yield owner, np.zeros(1, np.float32), np.full(1, duration, np.float32), packed
        else:
            begin = np.frombuffer(starts, np.float32)
            yield owner, begin, ends_of(begin, length, duration), packed
