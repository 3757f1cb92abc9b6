"""The two vector indexes of a library, clips and windows, kept up to date with its SQLite file."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import ends_of
from indexer.vectors.blocks import IndexRows
from indexer.vectors.faiss_index import COMPACT_AT, COMPACT_AT_SERVING, FaissIndex
from indexer.vectors.index_files import load, save


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
CLIPS = IndexKind("clips", f"SELECT clip_id, duration, NULL, NULL, vector FROM embeddings {_CHANGED}")
WINDOWS = IndexKind("windows", f"SELECT clip_id, duration, length, starts, vectors FROM windows {_CHANGED}, length")


class LibraryIndexes:
    """The indexes of one library; brought up to date when they are requested."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = threading.Lock()
        self._held: dict[str, tuple[str, FaissIndex]] = {}

    def current(self, kind: IndexKind, connection: sqlite3.Connection, *, serving: bool = False) -> FaissIndex:
        """The index of this kind as of now: from memory, else from its file, caught up with what changed since.

        With `serving` it is prepared for many searches; see `FaissIndex.for_serving`.
        """
        held = self._held.get(kind.name)
        if held is not None and _state(connection)[:2] == (held[1].generation, held[0]):
            return held[1]
        with self._lock:
            connection.execute("BEGIN")  # one snapshot for all that is read
            try:
                index = self._refresh(kind, connection, serving)
            finally:
                connection.execute("COMMIT")
        return index

    def since(self, kind: IndexKind, connection: sqlite3.Connection, generation: int) -> IndexRows:
        """The rows of the live clips that came or changed after a generation."""
        _, _, model_id, size = _state(connection)
        return _rows(connection, kind, model_id, generation, size)

    def _refresh(self, kind: IndexKind, connection: sqlite3.Connection, serving: bool) -> FaissIndex:
        generation, model, model_id, size = _state(connection)
        known, index = self._held.get(kind.name, ("", None))
        if index is None or known != model or index.generation > generation:
            index = load(self._folder, kind.name, model, size)
        if index is None or index.generation > generation:
            rows = _rows(connection, kind, model_id, -1, size)
            index = self._saved(kind, model, FaissIndex.of(generation, rows))
        elif index.generation < generation:
            changed = connection.execute("SELECT id FROM clips WHERE generation > ?", (index.generation,))
            remove = np.array([row[0] for row in changed], np.int64)
            added = _rows(connection, kind, model_id, index.generation, size)
            compact_at = COMPACT_AT_SERVING if serving else COMPACT_AT
            caught_up = index.update(generation, remove=remove, add=added, compact_at=compact_at)
            index = caught_up if caught_up.shares_block(index) else self._saved(kind, model, caught_up)
        index = index.for_serving() if serving else index
        self._held[kind.name] = (model, index)
        return index

    def _saved(self, kind: IndexKind, model: str, index: FaissIndex) -> FaissIndex:
        """Save the index where the folder can be written; it is derived data, so elsewhere nothing is lost."""
        if len(index) and os.access(self._folder.parent, os.W_OK):
            try:
                return save(index, self._folder, kind.name, model)
            except (OSError, RuntimeError):  # FAISS raises RuntimeError where another reader has replaced the file
                pass
        return index


def _state(connection: sqlite3.Connection) -> tuple[int, str, int, int]:
    """The library's generation; what its vectors are of (library and model); the model's id and vector size."""
    settings = dict(connection.execute("SELECT key, value FROM settings").fetchall())
    model = connection.execute(
        "SELECT fingerprint, id, size FROM models WHERE id = ?", (settings.get("model"),)
    ).fetchone()
    fingerprint, model_id, size = model or ("", -1, 1)
    return settings["generation"], f"{settings['identity']:x} {fingerprint}", model_id, size


def _rows(connection: sqlite3.Connection, kind: IndexKind, model_id: int, generation: int, size: int) -> IndexRows:
    """The vectors of the live clips that changed after `generation`."""
    parts = list(_parts(connection.execute(kind.query, (model_id, generation))))
    if not parts:
        return IndexRows.none(size)
    counts = [len(starts) for _, starts, _, _ in parts]
    owners = np.repeat(np.array([owner for owner, *_ in parts], np.int64), counts)
    spans = np.stack([np.concatenate([part[column] for part in parts]) for column in (1, 2)], axis=1)
    packed = np.frombuffer(b"".join(part[3] for part in parts), np.float16).reshape(-1, size)
    return IndexRows(owners, spans, packed)


def _parts(rows: sqlite3.Cursor) -> Iterator[tuple[int, NDArray[np.float32], NDArray[np.float32], bytes]]:
    for owner, duration, length, starts, packed in rows:
        if length is None:
            yield owner, np.zeros(1, np.float32), np.full(1, duration, np.float32), packed
        else:
            begin = np.frombuffer(starts, np.float32)
            yield owner, begin, ends_of(begin, length, duration), packed
