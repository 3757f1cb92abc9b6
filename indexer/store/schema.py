"""Opening `library.sqlite`: connections, the missing migrations, transactions, and what is said where it fails."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from shlex import quote

from encoders.errors import LibraryDamaged, LibraryError, LibraryLocked, LibraryNotFound
from indexer.store.tables import digests
from indexer.store.tables.migrations import MIGRATIONS, show_as_of_today


def connect(path: Path, *, writable: bool) -> sqlite3.Connection:
    """A connection to a library's SQLite file; transactions are begun by hand (`transaction`).

    Raises
    ------
    LibraryNotFound
        If there is no such file.
    LibraryLocked
        If another process holds it.
    LibraryDamaged
        If it is no SQLite database or an empty one.
    LibraryError
        If it cannot be opened, or is of a version that this program does not know.
    """
    try:
        connection = _connect(path, "rwc" if writable else "ro")
        version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    except sqlite3.Error as error:
        raise cause(path, error) from error
    if version > len(MIGRATIONS):
        connection.close()
        raise LibraryError(f"{path}: written by a newer motionseek; update motionseek to open it")
    if version == 0 and not writable:
        connection.close()
        raise LibraryDamaged(
            f"{path}: not finished: nothing was written yet; run 'motionseek index' again, unless it is at work now"
        )
    digests.register(connection)
    if version < 8 and not writable:
        show_as_of_today(connection, version)
    return connection


def is_unfinished(path: Path) -> bool:
    """Whether a library's file was begun and nothing was written yet; False where that cannot be read."""
    try:
        with closing(_connect(path, "ro")) as connection:
            return bool(connection.execute("PRAGMA user_version").fetchone()[0] == 0)
    except sqlite3.Error:
        return False


def cause(path: Path, error: sqlite3.Error) -> LibraryError:
    """Why a library file cannot be opened or read."""
    if not path.parent.exists() or (not path.exists() and os.access(path.parent, os.W_OK)):
        return LibraryNotFound(f"{path}: there is no such file")
    if path.exists() and not os.access(path, os.R_OK):
        return LibraryError(f"{path}: permission denied; ask its owner to let you read it")
    if "locked" in str(error):
        return LibraryLocked(f"{path}: locked by another process; try again when it has ended")
    if "full" in str(error) or "I/O error" in str(error):
        return LibraryError(f"{path}: cannot be read now ({error}); make room, check the disk, and try again")
    kind = LibraryError if isinstance(error, sqlite3.OperationalError) else LibraryDamaged
    mended = f"motionseek check --repair {quote(str(path.parent))}"
    return kind(f"{path}: cannot be opened as a library ({error}); where it is damaged, run: {mended}")


class FrozenConnection(sqlite3.Connection):
    """A connection to a file that is taken not to change while it is open, without locks."""


def not_written(path: Path, error: sqlite3.OperationalError) -> LibraryError:
    """Why a library file cannot be written, and what to do."""
    if "full" in str(error):
        what = "the disk is full; make room"
    elif "I/O error" in str(error):
        what = f"the disk fails ({error}); check it and make room"
    else:
        what = f"cannot be written ({error}); see that it may be"
    return LibraryError(f"{path}: {what}, and run 'motionseek index' again: what was committed is kept")


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    uri = path.absolute().as_uri()
    try:
        connection = sqlite3.connect(
            f"{uri}?mode={mode}", uri=True, timeout=30, isolation_level=None, check_same_thread=False
        )
        connection.execute("PRAGMA user_version")
        return connection
    except sqlite3.OperationalError:
        # In a read-only folder the shared memory of the log cannot be made. SQLite can do without, but leaves out what
        # a killed writer or a copy has left in the log.
        if mode != "ro" or not os.access(path, os.R_OK) or os.access(path.parent, os.W_OK):
            raise
        log = path.with_name(f"{path.name}-wal")
        if log.exists() and log.stat().st_size:
            raise LibraryError(
                f"{path}: its last changes lie in {log.name}, which cannot be read in a read-only folder; "
                "copy the whole folder to where you may write and open it there"
            ) from None
        return sqlite3.connect(
            f"{uri}?immutable=1", uri=True, isolation_level=None, check_same_thread=False, factory=FrozenConnection
        )


def migrate(connection: sqlite3.Connection) -> None:
    """Bring the tables up to date: each missing step in a transaction of its own."""
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")
    connection.execute("PRAGMA foreign_keys=ON")
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    if version == len(MIGRATIONS):
        return
    from sqlite_utils import Database  # slow to import, and few commands need it

    for number, step in enumerate(MIGRATIONS[version:], start=version + 1):
        with transaction(connection):
            if connection.execute("PRAGMA user_version").fetchone()[0] < number:  # else another process was faster
                step(Database(connection))
                connection.execute(f"PRAGMA user_version={number}")


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """All or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:  # else SQLite has rolled back by itself, as where the disk is full
            connection.execute("ROLLBACK")
        raise
