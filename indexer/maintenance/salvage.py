"""Salvage: whatever rows of a damaged database can still be read, in a new one put in its place."""

from __future__ import annotations

import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from encoders.errors import LibraryError
from indexer.store import schema
from indexer.store.files import ARRAYS_ROOT, INDEXED
from indexer.store.library_reader import FILE
from indexer.store.lock import write_lock
from indexer.store.marks import marks_table
from indexer.store.tables import digests

#: What a damaged database is renamed to.
DAMAGED = f"{FILE}.damaged"
#: The setting of a library that is being repaired, until what it lacks has been read again.
UNFINISHED = "repair unfinished"
#: Rows read at once.
_ROWS = 200
#: Tables in the order in which rows may name each other.
_TABLES = ("settings", "generations", *digests.COVERED)


def salvage(folder: Path) -> None:
    """Put a sound database in the place of a damaged one, with all rows that can be read; the old one is kept beside.

    There is a database at every instant, the damaged one with its log or the new one.

    Raises
    ------
    LibraryLocked
        If another process is writing the library.
    LibraryError
        If the folder cannot be written.
    """
    with write_lock(folder):
        _salvage(folder)


def _salvage(folder: Path) -> None:
    fresh, old = folder / f"{FILE}.new", folder / FILE
    try:
        _remove(fresh)
        with suppress(sqlite3.DatabaseError), closing(sqlite3.connect(old)) as source:
            source.execute("PRAGMA wal_checkpoint(TRUNCATE)")  # so that the log can be taken away before the file
        with closing(schema.connect(fresh, writable=True)) as target:
            schema.migrate(target)
            with _opened(old) as source:
                if source is not None:
                    for table in _TABLES:
                        _copy(source, target, table)
            _make_consistent(target)
            target.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        for suffix in ("-wal", "-shm"):
            with suppress(FileNotFoundError):
                os.replace(folder / f"{FILE}{suffix}", folder / f"{DAMAGED}{suffix}")
        shutil.copy2(old, kept := folder / f"{DAMAGED}.new")
        os.replace(kept, folder / DAMAGED)
        os.replace(fresh, old)
        _remove(fresh)
    except OSError as error:
        raise LibraryError(f"{folder}: cannot be written ({error.strerror})") from error
    except sqlite3.Error as error:
        raise LibraryError(f"{fresh}: cannot be written ({error}); make room, and repair again") from error


@contextmanager
def _opened(file: Path) -> Iterator[sqlite3.Connection | None]:
    """A database to read from, None where it cannot be opened."""
    try:
        connection = schema.connect(file, writable=False)
    except (sqlite3.DatabaseError, LibraryError):
        yield None
        return
    with closing(connection):
        yield connection


def _remove(file: Path) -> None:
    for suffix in ("", "-wal", "-shm"):
        file.with_name(file.name + suffix).unlink(missing_ok=True)


def _copy(source: sqlite3.Connection, target: sqlite3.Connection, table: str) -> None:
    """Copy the rows of a table: from its beginning to the first damage, and from its end to the last."""
    columns = [row[1] for row in target.execute(f"PRAGMA table_info({table})")]
    with suppress(sqlite3.DatabaseError):
        held = {row[1] for row in source.execute(f"PRAGMA table_info({table})")}
        columns = [column for column in columns if column in held] or columns
    named = ", ".join(f'"{column}"' for column in columns)
    insert = f"INSERT OR REPLACE INTO {table}(rowid, {named}) VALUES ({', '.join('?' * (len(columns) + 1))})"
    target.execute("PRAGMA foreign_keys=OFF")
    for order in ("ASC", "DESC"):
        with schema.transaction(target):
            rows = _rows(source, f"SELECT rowid, {named} FROM {table}", order)
            while True:
                try:
                    row = next(rows, None)
                except sqlite3.DatabaseError:
                    break
                if row is None:
                    return
                with suppress(sqlite3.IntegrityError):  # a row that damage has made unlike any that was written
                    target.execute(insert, row)


def _rows(source: sqlite3.Connection, query: str, order: str) -> Iterator[Any]:
    """Rows in order of their numbers, up to one that cannot be read."""
    last, sign = (-(2**63), ">") if order == "ASC" else (2**63 - 1, "<")
    while True:
        page = f"{query} WHERE rowid {sign} ? ORDER BY rowid {order} LIMIT {_ROWS}"
        count = 0
        for row in source.execute(page, (last,)):
            last, count = row[0], count + 1
            yield row
        if count < _ROWS:
            return


def _make_consistent(target: sqlite3.Connection) -> None:
    """Remove the rows that name others that are lost, and find out the settings from what there is."""
    with schema.transaction(target):
        marks_table.detach_lost(target)
        # those that were lost are recovered from the file beside; see `marks_file`
        target.execute("DELETE FROM settings WHERE key = ?", (marks_table.GENERATION,))
        while broken := target.execute("PRAGMA foreign_key_check").fetchall():
            for table, rowid, *_ in broken:
                target.execute(f"DELETE FROM {table} WHERE rowid = ?", (rowid,))
        (newest,) = target.execute("SELECT coalesce(max(generation), 0) FROM clips").fetchone()
        target.execute("UPDATE settings SET value = max(value, ?) + 1 WHERE key = 'generation'", (newest,))
        target.execute(
            "INSERT OR REPLACE INTO generations SELECT value, random() FROM settings WHERE key = 'generation'"
        )
        target.execute("INSERT OR REPLACE INTO settings VALUES (?, 1)", (UNFINISHED,))
        # which clips and captions of a file are lost is not known: all files are to be read again
        target.execute("UPDATE side_files SET hash = '', size = -1")
        target.execute(
            "UPDATE files SET hash = '', size = -1 WHERE state = ? "
            "AND root_id NOT IN (SELECT id FROM roots WHERE path = ?)",
            (INDEXED, ARRAYS_ROOT),
        )
        rebuild_text_search(target)


def rebuild_text_search(connection: sqlite3.Connection) -> None:
    """Make the full-text tables of names and captions again from the tables that they follow."""
    for table in ("clips", "texts"):
        connection.execute(f"INSERT INTO {table}_fts({table}_fts) VALUES ('rebuild')")
