"""One writer at a time: a lock that dies with its process and names its holder."""

from __future__ import annotations

import os
import socket
import sqlite3
import threading
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

from encoders.errors import LibraryError, LibraryLocked

_threads: defaultdict[Path, threading.RLock] = defaultdict(threading.RLock)
_guard = threading.Lock()


@contextmanager
def _thread_lock(folder: Path) -> Iterator[None]:
    """Hold the folder against the other threads of this process; they wait."""
    with _guard:
        lock = _threads[folder.resolve()]
    with lock:
        yield


@contextmanager
def write_lock(folder: Path) -> Iterator[None]:
    """Hold the folder's write lock. Threads of one process wait for each other.

    The lock is SQLite's own, on an empty database beside the library: it works the same on every system, and the
    operating system releases it when the process ends, however it ends.

    Raises
    ------
    LibraryLocked
        If another process holds it, or this thread already does.
    LibraryError
        If the folder cannot be written.
    """
    holder = folder / "writer.txt"
    with _thread_lock(folder), _exclusive(folder, holder):
        try:
            with suppress(OSError):  # the name is a courtesy
                _name(holder)
            yield
        finally:
            with suppress(OSError):
                holder.unlink()


@contextmanager
def _exclusive(folder: Path, holder: Path) -> Iterator[None]:
    """SQLite's lock between processes."""
    connection = None
    try:
        connection = sqlite3.connect(folder / "writer.lock", timeout=0, isolation_level=None)
        connection.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError as error:
        if connection is not None:
            connection.close()
        if "locked" not in str(error):
            advice = "make room" if "full" in str(error) else "use another (library=, --library)"
            raise LibraryError(f"{folder}: cannot be written ({error}); {advice}") from error
        raise LibraryLocked(
            f"{folder}: being written by {_read(holder)}; wait until that is done, or end it"
        ) from error
    try:
        yield
    finally:
        connection.close()


def _name(holder: Path) -> None:
    """Record this process as the holder, whole or not at all."""
    since = datetime.now().isoformat(" ", "seconds")
    written = holder.with_suffix(".new")
    written.write_text(f"process {os.getpid()} on {socket.gethostname()} since {since}")
    written.replace(holder)


def _read(holder: Path) -> str:
    """Who holds the lock; the record is missing for a moment after the lock is taken and before it is released."""
    with suppress(OSError, UnicodeDecodeError):
        return holder.read_text()[:200].strip() or "another process"
    return "another process"
