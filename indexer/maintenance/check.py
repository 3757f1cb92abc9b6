"""Check a library: SQLite's own checks, the digest of every row, what belongs to each clip, and the vector files."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from encoders.errors import LibraryDamaged, LibraryNotFound
from indexer.ingest.scan import walk
from indexer.maintenance.row_sums import sum_of_rows
from indexer.maintenance.salvage import UNFINISHED
from indexer.store import poses, schema
from indexer.store.files import ARRAYS_ROOT
from indexer.store.library_reader import FILE
from indexer.store.marks import marks_file
from indexer.store.stored_library import StoredLibrary
from indexer.store.tables import digests
from indexer.store.tables.migrations import MIGRATIONS
from indexer.vectors.library_indexes import CLIPS, WINDOWS

#: Lines of SQLite's own check.
_LINES = 20
#: Tables that hold the content of a clip, and the column that names it.
_OF_CLIPS = {"clips": "id", "poses": "clip_id", "embeddings": "clip_id", "windows": "clip_id"}


class Fault(NamedTuple):
    """What is wrong with one thing: a clip by its path, a file of the library, or a caption."""

    what: str
    problem: str


@dataclass
class Findings:
    """What a check has found, and what a repair goes by.

    Attributes
    ----------
    faults : list of Fault
    database : bool
        Whether SQLite cannot read the file to its end.
    rows : dict
        Table -> numbers of the rows whose digest is wrong.
    poses, vectors : set of int
        Ids of the clips whose poses, or whose vectors alone, are not what was written.
    unfinished : bool
        Whether a repair was cut off before what it removed had been read again.
    indexes : bool
        Whether the vector files do not hold what the database does.
    marks : bool
        Whether the file of stars, tags and collections does not.
    unchecked : int
        Rows that were written before there were digests.
    """

    faults: list[Fault] = field(default_factory=list)
    database: bool = False
    rows: dict[str, list[int]] = field(default_factory=dict)
    poses: set[int] = field(default_factory=set)
    vectors: set[int] = field(default_factory=set)
    unfinished: bool = False
    indexes: bool = False
    marks: bool = False
    unchecked: int = 0


def check(folder: Path, *, sources: bool = False) -> Findings:
    """Check a library; nothing is changed.

    Parameters
    ----------
    folder : path
        The library folder.
    sources : bool
        Also compare every source file with the content that was read from it.

    Raises
    ------
    LibraryNotFound
        If there is no library.
    """
    found = Findings()
    if not (folder / FILE).is_file():
        raise LibraryNotFound(f"{folder}: no library here")
    try:
        with closing(schema.connect(folder / FILE, writable=False)) as connection:
            _check_structure(connection, found)
            if not found.database:
                _check_finished(connection, found)
                _check_rows(connection, found)
                _check_clips(connection, found)
                if marks_file.differs(folder, connection):
                    found.marks = True
                    found.faults.append(Fault(marks_file.FILE, "not as written"))
        if not found.database:
            with StoredLibrary.open(folder) as library:
                _check_indexes(library, found)
                found.faults += _changed_sources(library) if sources else []
    except (sqlite3.DatabaseError, LibraryDamaged) as error:
        _unreadable(found, str(error))
    return found


def _unreadable(found: Findings, problem: str) -> None:
    found.database = True
    found.faults.append(Fault(FILE, problem))


def _check_structure(connection: sqlite3.Connection, found: Findings) -> None:
    lines = [row[0] for row in connection.execute(f"PRAGMA integrity_check({_LINES})")]
    for line in lines if lines != ["ok"] else []:
        _unreadable(found, line)
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as fresh:
        schema.migrate(fresh)
        is_current = version == len(MIGRATIONS)
        for table in digests.COVERED if is_current else ():
            if _columns(connection, table) != _columns(fresh, table):
                _unreadable(found, f"the columns of {table} are not those that were made")
        if is_current and _triggers(connection) != _triggers(fresh):
            _unreadable(found, "its triggers are not those that were made")
    for table, rowid, parent, _ in connection.execute("PRAGMA foreign_key_check").fetchall():
        _unreadable(found, f"row {rowid} of {table} belongs to a row of {parent} that is not there")


def _columns(connection: sqlite3.Connection, table: str) -> set[str]:
    return {row[1] for row in connection.execute(f"PRAGMA main.table_info({table})")}


def _triggers(connection: sqlite3.Connection) -> dict[str, str]:
    """The triggers by name, each without spaces and quotes, which versions of sqlite-utils write differently."""
    rows = connection.execute("SELECT name, sql FROM main.sqlite_master WHERE type = 'trigger'")
    return {name: re.sub(r"[\s\"\[\]`]", "", sql) for name, sql in rows}


def _check_finished(connection: sqlite3.Connection, found: Findings) -> None:
    if connection.execute("SELECT 1 FROM settings WHERE key = ?", (UNFINISHED,)).fetchone():
        found.unfinished = True
        found.faults.append(Fault(FILE, "its repair was cut off, and clips may be missing"))


def _check_rows(connection: sqlite3.Connection, found: Findings) -> None:
    """Compare the content of every row with its digest."""
    for table in digests.COVERED:
        if not {"digest", *digests.COVERED[table]} <= _columns(connection, table):  # an earlier version, or half made
            found.unchecked += connection.execute(f"SELECT count(*) FROM {table}").fetchone()[0]
            continue
        found.unchecked += connection.execute(f"SELECT count(*) FROM {table} WHERE digest IS NULL").fetchone()[0]
        rows = digests.damaged_rows(connection, table)
        if not rows:
            continue
        found.rows[table] = rows
        if table in _OF_CLIPS:
            column = _OF_CLIPS[table]
            marks = ",".join(map(str, rows))
            ids = {row[0] for row in connection.execute(f"SELECT {column} FROM {table} WHERE rowid IN ({marks})")}
            (found.vectors if table in ("embeddings", "windows") else found.poses).update(ids)
        elif table == "files":
            marks = ",".join(map(str, rows))
            found.poses.update(row[0] for row in connection.execute(f"SELECT id FROM clips WHERE file_id IN ({marks})"))
            found.faults.append(Fault(FILE, f"{_count(rows, 'record')} of files not as written"))
        else:
            found.faults.append(Fault(FILE, f"{_count(rows, 'row')} of {table} not as written"))


def _check_clips(connection: sqlite3.Connection, found: Findings) -> None:
    """See that every clip has all its poses and vectors, and name those that have not what was written."""
    chunks = f"(SELECT count(*) FROM poses WHERE clip_id = clips.id) != (frames + {poses.CHUNK - 1}) / {poses.CHUNK}"
    live = "FROM clips JOIN files ON files.id = clips.file_id WHERE files.state = 'indexed'"
    model = "(SELECT value FROM settings WHERE key = 'model')"
    found.poses |= {row[0] for row in connection.execute(f"SELECT clips.id {live} AND {chunks}")}
    for table in ("embeddings", "windows"):
        has_none = f"clips.id NOT IN (SELECT clip_id FROM {table} WHERE model_id = {model})"
        found.vectors |= {row[0] for row in connection.execute(f"SELECT clips.id {live} AND {has_none}")}
    found.vectors -= found.poses
    for ids, problem in ((found.poses, "its stored poses are damaged"), (found.vectors, "its vectors are damaged")):
        found.faults += [Fault(path, problem) for path in _paths(connection, ids)]


def _paths(connection: sqlite3.Connection, ids: Iterable[int]) -> Iterator[str]:
    for clip_id in sorted(ids):
        row = connection.execute("SELECT clip_path FROM clips WHERE id = ?", (clip_id,)).fetchone()
        yield f"#{clip_id}" if row is None else str(row[0])


def _check_indexes(library: StoredLibrary, found: Findings) -> None:
    """Compare the vectors that are searched with those in the database."""
    with library.reading() as connection:
        for kind in (CLIPS, WINDOWS):
            held = library.indexes.current(kind, connection)
            if sum_of_rows(held.pieces()) != sum_of_rows(library.indexes.stored(kind, connection)):
                found.indexes = True
                found.faults.append(Fault(f"vectors/{kind.name}", "holds other vectors than the library"))


def _changed_sources(library: StoredLibrary) -> list[Fault]:
    """Source files that are not what was read."""
    recorded: dict[Path, dict[str, str]] = {}
    for root, path, digest in library.connection.execute(
        "SELECT roots.path, files.path, files.hash FROM files JOIN roots ON roots.id = files.root_id "
        "WHERE files.state = 'indexed' AND roots.path != ?",
        (ARRAYS_ROOT,),
    ):
        recorded.setdefault((library.folder / root).resolve(), {})[path] = digest
    return [
        Fault(path, problem) for root, files in recorded.items() for path, problem in _compared(root, files) if problem
    ]


def _compared(root: Path, recorded: dict[str, str]) -> Iterator[tuple[str, str]]:
    """Paths below a root and what is wrong with each; empty where nothing is."""
    try:
        found = {file.path: file for folder in walk(root).folders for file in folder.motions()}
    except OSError as error:
        yield str(root), f"cannot be listed ({(error.strerror or str(error)).lower()})"
        return
    for path, digest in sorted(recorded.items()):
        try:
            changed = path in found and found[path].hash(root) != digest
            yield path, "has changed since it was indexed" if changed else "" if path in found else "is gone"
        except OSError as error:
            yield path, f"cannot be read ({(error.strerror or str(error)).lower()})"


def _count(rows: list[int], name: str) -> str:
    return f"{len(rows)} {name}{' is' if len(rows) == 1 else 's are'}"
