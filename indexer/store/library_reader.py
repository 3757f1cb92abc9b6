"""LibraryReader: a library's SQLite file as its readers open it, and one snapshot of it at a time."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import wraps
from pathlib import Path
from stat import S_ISREG
from types import TracebackType
from typing import TYPE_CHECKING, Concatenate, ParamSpec, TypeVar

from encoders.errors import LibraryError, LibraryNotFound
from indexer.store import schema
from indexer.store.spelling import composed, folded

if TYPE_CHECKING:
    from typing_extensions import Self

P = ParamSpec("P")
R = TypeVar("R")
AnyReader = TypeVar("AnyReader", bound="LibraryReader")
#: Device, number and time of a file.
FileId = tuple[int, int, int]

#: The folder inside an indexed folder, and the file in it that is the truth.
FOLDER = ".motionseek"
FILE = "library.sqlite"


def library_folder(folder: Path) -> Path | None:
    """The library of an indexed folder, else the folder itself if it is a library; None where there is none.

    Raises
    ------
    LibraryError
        If one may lie there, in a folder that cannot be looked into.
    """
    return next((place for place in (folder / FOLDER, folder) if _is_file(place / FILE)), None)


def _is_file(path: Path) -> bool:
    try:
        return S_ISREG(path.stat().st_mode)
    except PermissionError:
        raise LibraryError(f"{path}: permission denied; ask its owner to let you read it") from None
    except (OSError, ValueError):  # such as names that are too long, or none
        return False


def one_snapshot(method: Callable[Concatenate[AnyReader, P], R]) -> Callable[Concatenate[AnyReader, P], R]:
    """A method of a library all of whose reading is of one snapshot; see `LibraryReader.reading`."""

    @wraps(method)
    def inside(self: AnyReader, /, *args: P.args, **kwargs: P.kwargs) -> R:
        with self.reading():
            return method(self, *args, **kwargs)

    return inside


class LibraryReader:
    """A library that is read. Safe to share between threads; what others write is seen at the next call."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._local = threading.local()
        self._closed = False
        self._connections: list[sqlite3.Connection] = []

    def close(self) -> None:
        """Close the files; later calls fail."""
        self._closed = True
        for connection in self._connections:
            connection.close()
        self._connections.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def connection(self) -> sqlite3.Connection:
        """This thread's connection; it can only read. A library that was put in place of the first one is opened anew.

        Raises
        ------
        LibraryNotFound
            If the library was removed.
        LibraryError
            If it is closed or cannot be opened.
        """
        if self._closed:
            raise LibraryError(f"{self.folder}: the library is closed")
        found: sqlite3.Connection | None = getattr(self._local, "connection", None)
        if found is not None and found.in_transaction:
            return found
        state = self._file_state()
        if found is not None and self._local.file == _file_id(state, found):
            return found
        if found is not None:
            self._connections.remove(found)
            found.close()
            self._local.connection = None
        found = self._local.connection = schema.connect(self.folder / FILE, writable=False)
        found.create_function("nfc", 1, composed, deterministic=True)
        found.create_function("folded", 1, folded, deterministic=True)
        self._local.file = _file_id(state, found)
        self._connections.append(found)
        return found

    def _writable(self) -> Path:
        """The folder, unless the library is closed."""
        self.connection  # noqa: B018  raises LibraryError
        return self.folder

    def _file_state(self) -> os.stat_result:
        try:
            return (self.folder / FILE).stat()
        except OSError as error:
            raise LibraryNotFound(f"{self.folder / FILE}: cannot be reached any more ({error.strerror})") from None

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """One snapshot of the library for all that this thread reads inside; inner ones are part of the outer one.

        Raises
        ------
        LibraryDamaged, LibraryError
            If it cannot be read.
        """
        connection = self.connection
        if connection.in_transaction:
            yield connection
            return
        connection.execute("BEGIN")
        try:
            yield connection
        except sqlite3.DatabaseError as error:
            raise schema.cause(self.folder / FILE, error) from error
        finally:
            with suppress(sqlite3.Error):  # closed meanwhile, or damaged
                connection.execute("ROLLBACK")  # nothing was written

    @property
    def state(self) -> tuple[FileId, int]:
        """The file that is read and its generation: what was computed from one holds as long as both are the same."""
        generation = self.generation  # by a connection that is opened if there is none yet
        return self._local.file, generation

    @property
    def generation(self) -> int:
        """Grows with every batch that is written."""
        row = self.connection.execute("SELECT value FROM settings WHERE key = 'generation'").fetchone()
        return int(row[0])


def _file_id(state: os.stat_result, connection: sqlite3.Connection) -> FileId:
    """What tells the file that a connection reads from one put in its place, or changed where it must not."""
    may_change = not isinstance(connection, schema.FrozenConnection)
    return state.st_dev, state.st_ino, 0 if may_change else state.st_mtime_ns
