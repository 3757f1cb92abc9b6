"""The rows of files: what a library has recorded of each. The changes run inside a batch of the writer."""

from __future__ import annotations

import sqlite3
from dataclasses import replace

from indexer.store.files import FAILED, GONE, INDEXED, File, FileVersion, KnownFile
from indexer.store.read_options import ReadOptions

#: A file that is not gone: there is an index of those alone, without which each file would cost a look at all others.
AT_PATH = f"files.root_id = ? AND files.path = ? AND files.state != '{GONE}' AND files.state = ?"

#: What the digest of a file begins with that failed once, and that is tried again as the digest is not its own.
_ONCE = "once "


def known(db: sqlite3.Connection, root_id: int) -> dict[str, KnownFile]:
    """The files of a root that were there when it was last indexed, by path."""
    rows = db.execute(
        "SELECT id, path, size, mtime_ns, hash, recipe, state FROM files WHERE root_id = ? AND state != ?",
        (root_id, GONE),
    )
    return {
        path: KnownFile(file_id, path, size, mtime_ns, digest, ReadOptions.of(recipe), state)
        for file_id, path, size, mtime_ns, digest, recipe, state in rows
    }


def same_content(db: sqlite3.Connection, digest: str) -> list[tuple[int, int, str, str, ReadOptions]]:
    """Indexed or gone files of that content: id, root id, path, state, options."""
    rows = db.execute(
        "SELECT id, root_id, path, state, recipe FROM files WHERE hash = ? AND state != ? ORDER BY id",
        (digest, FAILED),
    )
    return [(*row[:4], ReadOptions.of(row[4])) for row in rows]


def has_failed(db: sqlite3.Connection, source: FileVersion) -> bool:
    """Whether this content could not be read when it was last tried."""
    where, once = (source.root_id, source.file.path), _ONCE + source.hash
    rows = (
        db.execute(f"SELECT hash FROM files WHERE {AT_PATH}", (*where, state)).fetchone() for state in (FAILED, INDEXED)
    )
    failed, indexed = (row and row[0] for row in rows)
    return failed in (source.hash, once) or indexed == once


def fail_once(db: sqlite3.Connection, source: FileVersion, reason: str) -> None:
    """Record that a file cannot be read so that it is tried again; the clips of an earlier version of it stay."""
    once = _ONCE + source.hash
    where = (source.root_id, source.file.path, INDEXED)
    kept = db.execute(f"UPDATE files SET hash = ?, size = -1 WHERE {AT_PATH}", (once, *where))
    if not kept.rowcount:
        insert(db, replace(source, hash=once, file=replace(source.file, size=-1)), FAILED, reason)


def update_time(db: sqlite3.Connection, file_id: int, file: File) -> None:
    """A file has a new time and the old content."""
    db.execute("UPDATE files SET size = ?, mtime_ns = ? WHERE id = ?", (file.size, file.mtime_ns, file_id))


def put(db: sqlite3.Connection, source: FileVersion) -> int:
    """The id of an indexed file, whose row is inserted or updated."""
    row = db.execute(f"SELECT id FROM files WHERE {AT_PATH}", (source.root_id, source.file.path, INDEXED)).fetchone()
    if row is None:
        return insert(db, source, INDEXED, None)
    db.execute(
        "UPDATE files SET size = ?, mtime_ns = ?, hash = ?, recipe = ? WHERE id = ?",
        (source.file.size, source.file.mtime_ns, source.hash, source.options.text(), row[0]),
    )
    return int(row[0])


def insert(db: sqlite3.Connection, source: FileVersion, state: str, reason: str | None) -> int:
    """Insert a row in place of one that says that the file failed; its id."""
    file = source.file
    db.execute(f"DELETE FROM files WHERE {AT_PATH}", (source.root_id, file.path, FAILED))
    cursor = db.execute(
        "INSERT INTO files(root_id, path, size, mtime_ns, hash, recipe, state, reason) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        (source.root_id, file.path, file.size, file.mtime_ns, source.hash, source.options.text(), state, reason),
    )
    return int(cursor.lastrowid or 0)
