"""The marks of clips, as SQL: stars, tags and collections.

A mark belongs to a clip wherever that moves, and remembers the root and path where it lies. So a clip that is lost and
read again, in a repair or after its file could not be read for a while, has its marks again.
The changes run inside a batch of the writer and record its generation, so that caches know when they are stale.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import Any, NamedTuple
from unicodedata import normalize

from indexer.store.clips import LIVE
from indexer.store.spelling import folded
from indexer.store.tables.digests import COVERED

STAR, TAG, COLLECTION = "star", "tag", "collection"
#: The setting that holds the generation in which a mark last changed.
GENERATION = "marks_generation"

#: Values bound in one statement.
_VARIABLES = 500
_INSERT = (
    "INSERT OR IGNORE INTO marks(clip_id, root, path, kind, name, added) "
    "SELECT clips.id, roots.path, clip_path, ?, ?, ? "
    "FROM clips JOIN files ON files.id = clips.file_id JOIN roots ON roots.id = files.root_id WHERE clips.id = ?"
)


@dataclass(frozen=True)
class Marks:
    """What people have said of a clip.

    Attributes
    ----------
    starred : bool
    tags, collections : tuple of str
        In alphabetical order.
    """

    starred: bool = False
    tags: tuple[str, ...] = ()
    collections: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """The marks as plain data."""
        return {"starred": self.starred, "tags": list(self.tags), "collections": list(self.collections)}


NO_MARKS = Marks()


class MarkRow(NamedTuple):
    """One mark of the clip at `path` in `root`, the path of an indexed folder as the library stores it.

    `name` is that of the tag or collection, empty for a star; `added` is in UTC, ISO 8601.
    """

    root: str
    path: str
    kind: str
    name: str
    added: str


def generation(db: sqlite3.Connection) -> int:
    """The library's generation when a mark last changed; 0 if none ever has."""
    row = db.execute("SELECT value FROM settings WHERE key = ?", (GENERATION,)).fetchone()
    return 0 if row is None else int(row[0])


def record_change(db: sqlite3.Connection) -> None:
    """Marks have changed in this generation."""
    db.execute(
        "INSERT OR REPLACE INTO settings(key, value) SELECT ?, value FROM settings WHERE key = 'generation'",
        (GENERATION,),
    )


def add(db: sqlite3.Connection, clip_ids: Iterable[int], kind: str, name: str = "") -> None:
    """Mark clips; a name that is there in other case is spelt as it is there."""
    now = datetime.now(timezone.utc).isoformat(timespec="seconds")
    spelt = next((held for held in named(db, kind) if folded(held) == folded(name)), name)
    db.executemany(_INSERT, [(kind, spelt, now, clip_id) for clip_id in clip_ids])
    record_change(db)


def remove(db: sqlite3.Connection, clip_ids: Iterable[int], kind: str, name: str = "") -> None:
    """Take a mark from clips that have it, however its name is spelt."""
    for spelt in [held for held in named(db, kind) if folded(held) == folded(name)]:
        values = [(clip_id, kind, spelt) for clip_id in clip_ids]
        db.executemany("DELETE FROM marks WHERE clip_id = ? AND kind = ? AND name = ?", values)
    record_change(db)


def forget(db: sqlite3.Connection, clip_id: int) -> None:
    """Remove all marks of a clip."""
    if db.execute("DELETE FROM marks WHERE clip_id = ?", (clip_id,)).rowcount:
        record_change(db)


def attach(db: sqlite3.Connection, clip_id: int, root_id: int, path: str) -> None:
    """Give a clip that lies there now the marks of a lost one that lay there; its own remember the place."""
    (root,) = db.execute("SELECT path FROM roots WHERE id = ?", (root_id,)).fetchone()
    own = db.execute(
        "UPDATE marks SET root = ?, path = ? WHERE clip_id = ? AND (root, path) != (?, ?)",
        (root, path, clip_id, root, path),
    ).rowcount
    lost = db.execute(
        "UPDATE OR IGNORE marks SET clip_id = ?, path = ? WHERE root = ? AND path IN (?, ?) "
        "AND (clip_id IS NULL OR EXISTS (SELECT 1 FROM clips JOIN files ON files.id = clips.file_id "
        "WHERE clips.id = marks.clip_id AND files.state = 'gone'))",
        (clip_id, path, root, path, normalize("NFC", path)),
    ).rowcount
    if own or lost:
        record_change(db)


def of_clips(db: sqlite3.Connection, clip_ids: Sequence[int]) -> dict[int, Marks]:
    """The marks of clips that have some, by id."""
    found: dict[int, list[tuple[str, str]]] = {}
    for first in range(0, len(clip_ids), _VARIABLES):
        part = list(clip_ids[first : first + _VARIABLES])
        marks = ",".join("?" * len(part))
        query = f"SELECT clip_id, kind, name FROM marks WHERE clip_id IN ({marks}) ORDER BY name"
        for clip_id, kind, name in db.execute(query, part):
            found.setdefault(clip_id, []).append((kind, name))
    return {
        clip_id: Marks(
            any(kind == STAR for kind, _ in pairs),
            tuple(name for kind, name in pairs if kind == TAG),
            tuple(name for kind, name in pairs if kind == COLLECTION),
        )
        for clip_id, pairs in found.items()
    }


def counts(db: sqlite3.Connection, kind: str) -> dict[str, int]:
    """The names of a kind in alphabetical order, with how many clips that can be found have each."""
    query = f"SELECT name, count(*) FROM marks WHERE kind = ? AND clip_id IN (SELECT clips.id {LIVE}) GROUP BY name"
    return dict(sorted(db.execute(query, (kind,)).fetchall(), key=lambda row: (folded(row[0]), row[0])))


def named(db: sqlite3.Connection, kind: str) -> list[str]:
    """The names of a kind, also where the clips have gone."""
    return [name for (name,) in db.execute("SELECT DISTINCT name FROM marks WHERE kind = ?", (kind,))]


def rows(db: sqlite3.Connection) -> Iterator[MarkRow]:
    """Every mark, in the order in which they were made."""
    return map(MarkRow._make, db.execute("SELECT root, path, kind, name, added FROM marks ORDER BY id"))


def restore(db: sqlite3.Connection, lost: Iterable[MarkRow]) -> None:
    """Bring marks back that are not there; each belongs to the clip that lies at its place, or waits for one."""
    db.executemany(
        "INSERT OR IGNORE INTO marks(root, path, kind, name, added, clip_id) "
        "SELECT :root, :path, :kind, :name, :added, "
        "(SELECT clips.id FROM clips JOIN files ON files.id = clips.file_id "
        "JOIN roots ON roots.id = files.root_id "
        "WHERE files.state = 'indexed' AND roots.path = :root AND clip_path = :path) "
        "WHERE NOT EXISTS (SELECT 1 FROM marks WHERE (root, path, kind, name) = (:root, :path, :kind, :name))",
        [row._asdict() for row in lost],
    )
    record_change(db)


def detach_lost(db: sqlite3.Connection) -> None:
    """Let the marks of clips that are lost wait for these, and remove those that are not as written."""
    columns = ", ".join(COVERED["marks"])
    db.execute(f"DELETE FROM marks WHERE digest IS NOT digest({columns})")
    db.execute("UPDATE marks SET clip_id = NULL WHERE clip_id NOT IN (SELECT id FROM clips)")
    db.execute(f"UPDATE marks SET digest = digest({columns})")
