"""DistantLibrary: a `Library` whose database is not here; what needs it says so."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from encoders.errors import QueryError
from search.library import Library


class _NoDatabase:
    """What stands for the database: whatever is asked of it needs the library itself."""

    def __getattr__(self, name: str) -> NoReturn:
        _refuse("this")


class DistantLibrary(Library):
    """A library that is asked from afar."""

    @property
    def connection(self) -> NoReturn:
        """There is no database here."""
        _refuse("this")

    @contextmanager
    def reading(self) -> Iterator[Any]:
        """Nothing is held still: what others write is seen between two calls of Milvus."""
        yield _NoDatabase()

    def places(self, *_: Any) -> list[tuple[int, str]]:
        """No path of this machine is one of the library."""
        return []

    @property
    def roots(self) -> list[Path]:
        """None: no indexed folder is on this machine."""
        return []

    def failures(self) -> list[tuple[str, str]]:
        """None: what could not be read is known to the libraries alone."""
        return []

    def sorted_ids(self, sort: str) -> NoReturn:
        """It needs the library itself."""
        _refuse("sorting clips")

    def prepare(self) -> None:
        """Nothing is to be prepared."""

    def add_many(self, clips: Any) -> NoReturn:
        """It needs the library itself."""
        _refuse("adding clips")

    def remove(self, *ids: str) -> NoReturn:
        """It needs the library itself."""
        _refuse("removing clips")

    def duplicates(self, **_: Any) -> NoReturn:
        """It needs the library itself."""
        _refuse("finding stacks")

    def _change(self, *_: Any) -> NoReturn:
        _refuse("changing marks")


def _refuse(what: str) -> NoReturn:
    raise QueryError(f"{what} needs the library itself, on the machine that indexed it")
