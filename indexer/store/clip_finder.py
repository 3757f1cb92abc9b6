"""ClipFinder: the clips of a library, by number, by path or name, and by condition."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Sequence
from os import PathLike, fspath
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import is_text, shown
from encoders.errors import ArgumentError, QueryError, UnknownClip
from indexer.argument_checks import checked_clip_id
from indexer.part_names import is_meant, splits
from indexer.store.clips import LIVE, ORDERS, Clip, root_names, select
from indexer.store.files import ARRAYS_ROOT
from indexer.store.library_reader import FileId, LibraryReader, one_snapshot
from indexer.store.spelling import composed

#: Characters of a name that an error shows.
_SHOWN = 200
#: Values bound in one statement, and clips read by one.
_VARIABLES, _CHUNK = 500, 1000
#: Errors of a statement that is wrong, or of values that cannot be bound.
_WRONG_STATEMENT = (
    sqlite3.OperationalError, sqlite3.ProgrammingError, sqlite3.InterfaceError, OverflowError, ValueError
)  # fmt: skip
#: The largest integer of SQLite.
_LARGEST_ID = 2**63 - 1


def storable_id(id: int) -> int:
    """The number of a clip as SQLite takes it: -1, which no clip has, where it is too large.

    Raises
    ------
    ArgumentError
        If it is no whole number.
    """
    number = checked_clip_id(id)
    return number if abs(number) <= _LARGEST_ID else -1


class ClipFinder(LibraryReader):
    """The indexed folders of a library and the clips in them."""

    #: How many clips there are, counted once for a state of the library.
    _counted: tuple[tuple[FileId, int], int] | None = None

    @property
    def roots(self) -> list[Path]:
        """The indexed folders."""
        return [root for root, _ in self._folders()]

    @property
    def root_names(self) -> list[str]:
        """The names of the indexed folders, unique in this library, in the order of `roots`."""
        return [name for _, name in self._folders()]

    @property
    def all_root_names(self) -> list[str]:
        """The names of all roots, that of clips added as arrays among them."""
        return [*root_names(self._roots()).values()]

    def _folders(self) -> list[tuple[Path, str]]:
        """The indexed folders with their names; the root of clips added as arrays is none."""
        roots, arrays = self._roots(), (self.folder / ARRAYS_ROOT).resolve()
        names = root_names(roots)
        return [(root, names[key]) for key, root in roots.items() if root != arrays]

    def _roots(self) -> dict[int, Path]:
        """Every root by its id, that of clips added as arrays among them."""
        rows = self.connection.execute("SELECT id, path FROM roots ORDER BY id")
        return {key: (self.folder / path).resolve() for key, path in rows}

    @one_snapshot
    def __len__(self) -> int:
        held, state = self._counted, self.state
        if held is None or held[0] != state:
            held = self._counted = state, int(self.connection.execute(f"SELECT count(*) {LIVE}").fetchone()[0])
        return held[1]

    def ids(self, where: str = "", values: Sequence[Any] = ()) -> NDArray[np.int64]:
        """Sorted ids of the clips that meet an SQL condition on the columns of `clips` and `files`, values bound.

        Raises
        ------
        QueryError
            If it is no condition.
        """
        condition = f" AND ({where})" if where else ""
        connection = self.connection
        try:
            rows = connection.execute(f"SELECT clips.id {LIVE}{condition} ORDER BY clips.id", values).fetchall()
        except _WRONG_STATEMENT as error:
            raise QueryError(
                f"where={shown(where)} with values={shown(values)}: no condition on clips ({error})"
            ) from error
        return np.array([row[0] for row in rows], np.int64)

    def sorted_ids(self, sort: str) -> NDArray[np.int64]:
        """Ids of all clips by one of `indexer.store.clips.ORDERS`.

        Raises
        ------
        ArgumentError
            If it is none of these.
        """
        if not is_text(sort) or sort not in ORDERS:
            raise ArgumentError(f"sort={shown(sort)} must be one of {', '.join(ORDERS)}")
        rows = self.connection.execute(f"SELECT clips.id {LIVE} ORDER BY {ORDERS[sort]}")
        return np.array([row[0] for row in rows], np.int64)

    @one_snapshot
    def clip(self, id: int) -> Clip:
        """One clip.

        Raises
        ------
        UnknownClip
            If there is none of that id.
        """
        found = self.clips_by_id([checked_clip_id(id)])
        if id not in found:
            raise UnknownClip(f"{self.folder}: no clip #{shown(id)}")
        return found[id]

    @one_snapshot
    def clips_by_id(self, ids: Iterable[int]) -> dict[int, Clip]:
        """The clips of these ids that exist, by id, in the order of the ids."""
        if not isinstance(ids, Iterable):
            raise ArgumentError(f"ids={shown(ids)} must be a list of numbers of clips")
        wanted = [i for i in dict.fromkeys(map(checked_clip_id, ids)) if abs(i) <= _LARGEST_ID]
        found: dict[int, Clip] = {}
        for first in range(0, len(wanted), _VARIABLES):
            part = wanted[first : first + _VARIABLES]
            marks = ",".join("?" * len(part))
            found |= {clip.id: clip for clip in self._select(f"clips.id IN ({marks})", part)}
        return {i: found[i] for i in wanted if i in found}

    def clips(self) -> Iterator[Clip]:
        """Every clip, in order of its id; read in chunks, so that memory does not grow with the library."""
        last = -1
        while chunk := select(self.connection, self._roots(), "clips.id > ?", [last], limit=_CHUNK):
            yield from chunk
            last = chunk[-1].id

    def _select(self, condition: str, values: Sequence[Any]) -> list[Clip]:
        return select(self.connection, self._roots(), condition, values)

    @one_snapshot
    def find(self, ref: str | PathLike[str]) -> Clip:
        """The clip that is meant; see `matches`.

        Raises
        ------
        UnknownClip
            If no clip or several are meant.
        ArgumentError
            If it is no string or path.
        """
        found = self.matches(ref)
        if len(found) > 1:
            some = ", ".join(f"{self.reference(clip.root_name, clip.path)} (#{clip.id})" for clip in found[:5])
            more = ", ..." if len(found) > 5 else ""
            raise UnknownClip(f"{ref!s}: {len(found)} clips are called so; name one of them: {some}{more}")
        if not found:
            kind = "number" if str(ref)[:1] == "#" and str(ref)[1:].isdecimal() else "path or name"
            named = str(ref) if len(str(ref)) <= _SHOWN else f"{str(ref)[:_SHOWN]}..."
            raise UnknownClip(f"{named}: no clip of that {kind} in {self.folder}")
        return found[0]

    @one_snapshot
    def matches(self, ref: str | PathLike[str]) -> list[Clip]:
        """The clips that a reference may mean, of the first reading that gives any.

        "#12"; the name of a root and a path in it, where there are several roots; a path in a root; an absolute path;
        a name. Where none is spelt so, the composed and decomposed forms of Unicode are one. A path may name one of
        several clips of a file, as "file#part".
        """
        text = fspath(ref) if isinstance(ref, (str, PathLike)) else None
        if not isinstance(text, str):
            raise ArgumentError(f"ref={ref!r} must be a path, a name or '#number' of a clip")
        if "\0" in text or not is_text(text):
            return []
        if text.startswith("#") and text[1:].isdecimal() and len(text) <= len(str(_LARGEST_ID)):
            return list(self.clips_by_id([int(text[1:])]).values())
        return self._named(text, str, "{}") or ([] if text.isascii() else self._named(text, composed, "nfc({})"))

    def _named(self, text: str, spelt: Callable[[str], str], column: str) -> list[Clip]:
        """As `matches`, of a path or name; paths and columns are compared as spelt in one way."""
        text, roots = spelt(text), self._roots()
        path = PurePosixPath(text.replace("\\", "/"))
        names = root_names(roots) if len(roots) > 1 else {}
        named = {key: PurePosixPath(spelt(name)) for key, name in names.items()}
        below = [(key, path.relative_to(name).as_posix()) for key, name in named.items() if path.is_relative_to(name)]
        return (
            self._at(below, column)
            or self._of_path(path.as_posix(), column)
            or self._at(self.places(text, spelt), column)
            or self._select(f"{column.format('clips.name')} = ?", [text])
        )

    def places(self, path: str | PathLike[str], spelt: Callable[[str], str] = str) -> list[tuple[int, str]]:
        """What a path of the file system is called in the roots: the root's id, and the path in it.

        More than one where a root lies in another, or where links lead from one name of a file to another.

        Parameters
        ----------
        spelt : callable
            How names are spelt that are compared; what is returned is spelt so.
        """
        roots = {spelt(str(root)): key for key, root in self._roots().items()}
        absolute, real = os.path.abspath(path), os.path.realpath(path)
        found = [(above, Path(real)) for above in Path(real).parents]
        if absolute != real:
            found += [(above, Path(absolute)) for above in Path(absolute).parents]
        named = [
            (roots[name], spelt(place.relative_to(above).as_posix()))
            for above, place in found
            if (name := spelt(os.path.realpath(above))) in roots
        ]
        return list(dict.fromkeys(named))

    def _at(self, places: list[tuple[int, str]], column: str) -> list[Clip]:
        """The clips at paths in roots."""
        return [clip for key, place in places for clip in self._of_path(place, column, "files.root_id = ?", key)]

    def _of_path(self, path: str, column: str, condition: str = "1", *values: Any) -> list[Clip]:
        """The clip at a path, all clips of the file there, or the one of them that `file#part` names."""
        for name in ("clips.clip_path", "files.path"):
            if found := self._select(f"{column.format(name)} = ? AND {condition}", [path, *values]):
                return found
        for file, part in splits(path):
            if found := self._select(f"{column.format('files.path')} = ? AND {condition}", [file, *values]):
                return [clip for clip in found if is_meant(part, clip.part, clip.take)]
        return []

    def reference(self, root: str, path: str) -> str:
        """What `find` takes for a clip of a root: the path, after the root's name where there are several roots."""
        return f"{root}/{path}" if root and len(self._roots()) > 1 else path

    def root_references(self) -> list[tuple[int, str]]:
        """What may stand before a path in a root, with the root's id: its place, and its name if there are several."""
        roots = self._roots()
        names = root_names(roots).items() if len(roots) > 1 else ()
        return [*names, *((key, root.as_posix()) for key, root in roots.items())]
