"""One writer at a time: a lock that dies with its process and names its holder."""

from __future__ import annotations

import os
import socket
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from encoders.errors import LibraryError, LibraryLocked


@contextmanager
def write_lock(folder: Path) -> Iterator[None]:
    """Hold the folder's write lock.

    The lock is SQLite's own, on an empty database beside the library: it works the same on every system, and the
    operating system releases it when the process ends, however it ends.

    Raises
    ------
    LibraryLocked
        If another process holds it.
    LibraryError
        If the folder cannot be written.
    """
    holder = folder / "writer.txt"
    connection = sqlite3.connect(folder / "writer.lock", timeout=0, isolation_level=None)
    try:
        connection.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError as error:
        connection.close()
        if "locked" not in str(error):
            raise LibraryError(f"{folder}: cannot be written ({error}); use another folder: --library DIR") from error
        raise LibraryLocked(
            f"{folder}: being written by {_read(holder)}; wait until that is done, or end it"
        ) from error
    try:
        since = datetime.now().isoformat(" ", "seconds")
        holder.write_text(f"process {os.getpid()} on {socket.gethostname()} since {since}")
        yield
    finally:
        connection.close()


def _read(holder: Path) -> str:
    try:
        return holder.read_text()[:200]
    except OSError:
        return "another process"
