"""Repair a library: what can be made again is, from poses, from the source files, or from the captions files."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

from encoders.errors import LibraryError
from encoders.protocol import Encoder
from indexer.ingest import indexing
from indexer.ingest.encode import encode, encode_captions, use_model
from indexer.ingest.storing import Progress
from indexer.maintenance.check import Fault, Findings, check
from indexer.maintenance.salvage import UNFINISHED, rebuild_text_search, salvage
from indexer.store import models, poses
from indexer.store.files import ARRAYS_ROOT
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.marks import marks_file, marks_table
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import Writer, writing

#: Clips encoded at once.
_BATCH = 32


def repair(folder: Path, bundle: Encoder, *, progress: Progress | None = None) -> list[Fault]:
    """Check a library and mend what can be mended; the faults that are left.

    A database that SQLite cannot read is replaced by one with the rows that can be; the old one is kept as
    `library.sqlite.damaged`. Vectors are encoded again from the poses; poses and captions are read again from their
    files, for which the library is indexed anew.

    Raises
    ------
    LibraryError
        If there is no library, nothing of it can be read, or it is being written by another process.
    """
    found = check(folder)
    if found.database:
        salvage(folder)
        found = check(folder)
    left = _lost_marks(folder, found)
    try:
        read_again = _mend(folder, found, bundle)
    except sqlite3.Error:  # the database can be read, but not written: its schema is damaged
        salvage(folder)
        found = check(folder)
        read_again = _mend(folder, found, bundle)
    if found.indexes:
        shutil.rmtree(folder / "vectors", ignore_errors=True)
    if read_again:
        try:
            indexing.index(_lost_roots(folder), library=folder, bundle=bundle, progress=progress)
            _finish(folder)
        except LibraryError as error:  # a folder that is not there
            left.append(Fault(str(folder), f"cannot be read again ({error})"))
    with StoredLibrary.open(folder, bundle=bundle) as library:
        library.prepare()
    return left + check(folder).faults


def _mend(folder: Path, found: Findings, bundle: Encoder) -> bool:
    """Mend what lies in the database; whether files are to be read again."""
    read_again = found.unfinished
    with writing(folder) as writer:
        with writer.batch():
            rebuild_text_search(writer.connection)  # damage in it shows only in writing
        if found.faults:
            if "models" in found.rows:
                _take_model(writer, found, bundle)
            model_id = use_model(writer, bundle)
            read_again |= _mark(writer, found)
            _mend_marks(writer, found)
            _encode_again(writer, bundle, model_id, sorted(found.vectors - found.poses))
            encode_captions(writer, bundle, model_id)
    return read_again


def _lost_roots(folder: Path) -> list[Path]:
    """The indexed folder of a library that no longer says which it is; none where it does."""
    with StoredLibrary.open(folder) as library:
        if library.roots:
            return []
    if folder.name != FOLDER:
        raise LibraryError(f"{folder}: nothing of the library can be read; index its folders again with --library")
    return [folder.parent]


def _finish(folder: Path) -> None:
    """What was lost or removed has been read again."""
    with writing(folder) as writer:
        writer.connection.execute("DELETE FROM settings WHERE key = ?", (UNFINISHED,))


def _take_model(writer: Writer, found: Findings, bundle: Encoder) -> None:
    """Which model made the vectors is lost: it is this one from now on, and all vectors are made again."""
    with writer.batch():
        writer.connection.execute(
            f"UPDATE models SET fingerprint = ?, name = ?, size = ? WHERE rowid IN ({_list(found.rows['models'])})",
            (bundle.fingerprint, bundle.name, bundle.latent_size),
        )
        writer.connection.execute("DELETE FROM text_embeddings")
    found.vectors |= {row[0] for row in writer.connection.execute("SELECT DISTINCT clip_id FROM poses")}


def _mark(writer: Writer, found: Findings) -> bool:
    """Remove damaged rows, and have the files that they came from read again; whether there are any."""
    db, rows = writer.connection, {table: _list(ids) for table, ids in found.rows.items()}
    files = f"id IN (SELECT file_id FROM clips WHERE id IN ({_list(found.poses)}))"
    beside = "SELECT side_file_id FROM captions WHERE rowid IN ({}) OR text_id IN ({})"
    captions = (rows.get("captions", ""), rows.get("texts", ""))
    with writer.batch():
        again = db.execute(
            f"UPDATE files SET hash = '', size = -1 WHERE ({files} OR rowid IN ({rows.get('files', '')})) "
            "AND root_id NOT IN (SELECT id FROM roots WHERE path = ?)",
            (ARRAYS_ROOT,),
        ).rowcount
        again += db.execute(
            f"UPDATE side_files SET hash = '', size = -1 WHERE id IN ({beside.format(*captions)}) "
            f"OR rowid IN ({rows.get('side_files', '')})"
        ).rowcount
        db.execute("DELETE FROM captions WHERE rowid IN ({}) OR text_id IN ({})".format(*captions))
        db.execute(
            f"DELETE FROM text_embeddings WHERE text_id IN ({captions[1]}) "
            f"OR rowid IN ({rows.get('text_embeddings', '')})"
        )
        db.execute(f"DELETE FROM texts WHERE id IN ({captions[1]})")
        if again:
            db.execute("INSERT OR REPLACE INTO settings VALUES (?, 1)", (UNFINISHED,))
    return again > 0


def _lost_marks(folder: Path, found: Findings) -> list[Fault]:
    """Stars, tags and collections that neither the database nor the file beside it holds as they were written."""
    rows = found.rows.get("marks", [])
    lost = bool(rows) and marks_file.read(folder) is None
    return [Fault(FILE, f"{len(rows)} stars, tags or collections are lost")] if lost else []


def _mend_marks(writer: Writer, found: Findings) -> None:
    """Remove damaged stars, tags and collections, and bring back those of the file beside; or write this anew."""
    folder, rows = writer.folder, found.rows.get("marks", [])
    held = marks_file.read(folder)
    if rows:
        with writer.batch():
            writer.connection.execute(f"DELETE FROM marks WHERE rowid IN ({_list(rows)})")
            marks_table.restore(writer.connection, [] if held is None else held.rows)
    elif found.marks:
        marks_file.put_aside(folder)


def _encode_again(writer: Writer, bundle: Encoder, model_id: int, ids: Iterable[int]) -> None:
    """Vectors of clips from their poses."""
    left = iter(ids)
    while batch := list(islice(left, _BATCH)):
        encoded = encode(bundle, [poses.read(writer.connection, clip_id) for clip_id in batch])
        with writer.batch():
            for clip_id, vectors in zip(batch, encoded, strict=True):
                models.replace_vectors(writer.connection, clip_id, model_id, vectors)


def _list(ids: Iterable[int]) -> str:
    return ",".join(map(str, sorted(ids)))
