"""The captions of a library, as SQL: rows that name a motion by root and path, and the clip they belong to.

A row belongs to the clip that lies at its path when it is read, and stays with the clip wherever that moves. Of a file
with several clips, a row that names the file alone belongs to the first.
The changes run inside a batch of the writer. Those that may alter what an existing clip shows record the batch's
generation, `generation`, so that caches of captions know when they are stale.
"""

from __future__ import annotations

import sqlite3
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple
from unicodedata import normalize

import numpy as np
from numpy.typing import NDArray

from indexer.part_names import splits
from indexer.store.files import File

_INDEXED = "clips JOIN files ON files.id = clips.file_id AND files.state = 'indexed'"
#: The clip that lies at a caption's path now; for the path of a file whose clips all have names, the first of them.
_CLIP_AT_PATH = (
    f"SELECT coalesce((SELECT clips.id FROM {_INDEXED} WHERE files.root_id = captions.root_id "
    f"AND clips.clip_path = captions.path), (SELECT min(clips.id) FROM {_INDEXED} "
    "WHERE files.root_id = captions.root_id AND files.path = captions.path))"
)
#: Rows that state how a file is to be read.
_STATES = "(fps IS NOT NULL OR up IS NOT NULL)"


@dataclass(frozen=True)
class CaptionRow:
    """What a side file says of the motion at `path` (relative to the root).

    A caption, its frame rate, the axis that is up, or its split.
    """

    path: str
    text: str | None = None
    start: float | None = None
    end: float | None = None
    fps: float | None = None
    up: str | None = None
    split: str | None = None


class Stated(NamedTuple):
    """How a file is to be read, as captions tables state it: its frame rate, and the axis that is up."""

    fps: float | None = None
    up: str | None = None

    def and_then(self, later: Stated) -> Stated:
        """What holds where a later row states more."""
        return Stated(later.fps or self.fps, later.up or self.up)


def generation(db: sqlite3.Connection) -> int:
    """The library's generation when a caption of a clip that was there before last changed; 0 if none ever has."""
    row = db.execute("SELECT value FROM settings WHERE key = 'captions_generation'").fetchone()
    return 0 if row is None else int(row[0])


def _record_change(db: sqlite3.Connection) -> None:
    db.execute(
        "INSERT OR REPLACE INTO settings(key, value) "
        "SELECT 'captions_generation', value FROM settings WHERE key = 'generation'"
    )


def attach(db: sqlite3.Connection, clip_id: int, root_id: int, path: str, *, is_new: bool) -> None:
    """Give a clip the captions that name its path and belong to no clip that is there.

    Those of a motion that was not there when they were read name it in Unicode's composed form.
    """
    attached = db.execute(
        "UPDATE captions SET clip_id = ?, path = ? WHERE root_id = ? AND path IN (?, ?) "
        "AND (clip_id IS NULL OR EXISTS (SELECT 1 FROM clips JOIN files ON files.id = clips.file_id "
        "WHERE clips.id = captions.clip_id AND files.state = 'gone'))",
        (clip_id, path, root_id, path, normalize("NFC", path)),
    )
    if attached.rowcount and not is_new:
        _record_change(db)


def replace_of_side_file(db: sqlite3.Connection, root_id: int, side_file_id: int, rows: Sequence[CaptionRow]) -> None:
    """Set the captions that a side file holds."""
    shown = _count_shown(db, "side_file_id", side_file_id)
    db.execute("DELETE FROM captions WHERE side_file_id = ?", (side_file_id,))
    _insert(db, root_id, rows, side_file_id=side_file_id)
    db.execute(f"UPDATE captions SET clip_id = ({_CLIP_AT_PATH}) WHERE side_file_id = ?", (side_file_id,))
    if shown or _count_shown(db, "side_file_id", side_file_id):
        _record_change(db)


def replace_of_clip(
    db: sqlite3.Connection, root_id: int, clip_id: int, rows: Sequence[CaptionRow], *, is_new: bool = False
) -> None:
    """Set the captions of a clip that no file describes; the rows name its path."""
    shown = _count_shown(db, "clip_id", clip_id)
    db.execute("DELETE FROM captions WHERE clip_id = ?", (clip_id,))
    _insert(db, root_id, rows, clip_id=clip_id)
    if shown or (rows and not is_new):
        _record_change(db)


def forget(db: sqlite3.Connection, clip_id: int) -> None:
    """Remove the captions of a clip; those of a side file wait for a clip to come back to its path."""
    if _count_shown(db, "clip_id", clip_id):
        _record_change(db)
    db.execute("DELETE FROM captions WHERE clip_id = ? AND side_file_id IS NULL", (clip_id,))
    db.execute("UPDATE captions SET clip_id = NULL WHERE clip_id = ?", (clip_id,))


def remove_side_files(db: sqlite3.Connection, side_file_ids: Iterable[int]) -> None:
    """Remove the captions of side files that have vanished.

    Those of a motion that lies elsewhere now, and has no others, stay with it.
    """
    for file_id in side_file_ids:
        shown = _count_shown(db, "side_file_id", file_id)
        db.execute(
            "UPDATE captions SET side_file_id = NULL WHERE side_file_id = ? AND clip_id IS NOT NULL "
            f"AND clip_id IS NOT ({_CLIP_AT_PATH}) AND NOT EXISTS (SELECT 1 FROM captions AS others "
            "WHERE others.clip_id = captions.clip_id AND others.side_file_id != captions.side_file_id)",
            (file_id,),
        )
        db.execute("DELETE FROM captions WHERE side_file_id = ?", (file_id,))
        db.execute("DELETE FROM side_files WHERE id = ?", (file_id,))
        if shown:
            _record_change(db)


def side_files(db: sqlite3.Connection, root_id: int) -> dict[str, tuple[int, int, int, str]]:
    """The side files of a root as they were read: path -> id, size, mtime_ns, hash."""
    rows = db.execute("SELECT path, id, size, mtime_ns, hash FROM side_files WHERE root_id = ?", (root_id,))
    return {path: (file_id, size, mtime_ns, digest) for path, file_id, size, mtime_ns, digest in rows}


def paths_named(db: sqlite3.Connection, root_id: int) -> dict[int | None, set[str]]:
    """Side file -> the paths of the motions that its captions were read for."""
    named: dict[int | None, set[str]] = defaultdict(set)
    for file_id, path in db.execute(
        "SELECT DISTINCT side_file_id, path FROM captions WHERE root_id = ? AND text_id IS NOT NULL", (root_id,)
    ):
        named[file_id].add(path)
    return named


def record_side_file(db: sqlite3.Connection, root_id: int, file: File, digest: str) -> int:
    """Record a side file as it is now; its id."""
    db.execute(
        "INSERT INTO side_files(root_id, path, size, mtime_ns, hash) VALUES (?, ?, ?, ?, ?) "
        "ON CONFLICT(root_id, path) DO UPDATE SET size = excluded.size, mtime_ns = excluded.mtime_ns, "
        "hash = excluded.hash",
        (root_id, file.path, file.size, file.mtime_ns, digest),
    )
    row = db.execute("SELECT id FROM side_files WHERE root_id = ? AND path = ?", (root_id, file.path)).fetchone()
    return int(row[0])


def stated_options(db: sqlite3.Connection, root_id: int, *, without: Iterable[int] = ()) -> dict[str, Stated]:
    """Path in composed form -> how it is to be read, by the captions tables of a root; `without` some side files."""
    left_out, stated = set(without), defaultdict[str, Stated](Stated)
    rows = db.execute(
        f"SELECT path, fps, up, side_file_id FROM captions WHERE root_id = ? AND {_STATES} ORDER BY id", (root_id,)
    )
    for path, fps, up, file_id in rows:
        if file_id not in left_out:
            path = normalize("NFC", path)
            stated[path] = stated[path].and_then(Stated(fps, up))
    return dict(stated)


def stated_option(db: sqlite3.Connection, root_id: int, path: str) -> Stated:
    """How one file is to be read, by the captions tables; the last row counts where there are several."""
    stated = Stated()
    for fps, up in db.execute(
        f"SELECT fps, up FROM captions WHERE root_id = ? AND path IN (?, ?) AND {_STATES} ORDER BY id",
        (root_id, path, normalize("NFC", path)),
    ):
        stated = stated.and_then(Stated(fps, up))
    return stated


def stated_of_parts(db: sqlite3.Connection, side_file_id: int) -> list[tuple[str, str]]:
    """The paths of parts of files, each with its file, for which a side file states how they are to be read.

    A file is read as a whole, so that nothing comes of it.
    """
    rows = db.execute(
        f"SELECT DISTINCT root_id, path FROM captions WHERE side_file_id = ? AND {_STATES} AND instr(path, '#') "
        "AND NOT EXISTS (SELECT 1 FROM files WHERE files.root_id = captions.root_id AND files.path = captions.path "
        "AND state != 'gone') ORDER BY path",
        (side_file_id,),
    ).fetchall()
    is_file = "SELECT 1 FROM files WHERE root_id = ? AND path = ? AND state != 'gone'"
    return [
        (path, file)
        for root_id, path in rows
        for file, _ in splits(path)
        if db.execute(is_file, (root_id, file)).fetchone() is not None
    ]


def without_clip(db: sqlite3.Connection, side_file_id: int) -> tuple[str, int, str | None]:
    """A side file's path, how many of its captions name no clip of the library, and a path that one of them names."""
    path, count, example = db.execute(
        "SELECT side_files.path, count(captions.id), min(captions.path) FROM side_files LEFT JOIN captions "
        "ON side_file_id = side_files.id AND clip_id IS NULL AND text_id IS NOT NULL WHERE side_files.id = ?",
        (side_file_id,),
    ).fetchone()
    return path, count, example


def of_several_clips(db: sqlite3.Connection, side_file_id: int) -> list[tuple[str, str]]:
    """The paths of files that a side file captions as such and that have several clips, none of which is called so.

    Each with the path of the clip that has the captions.
    """
    return db.execute(
        "SELECT DISTINCT captions.path, clips.clip_path FROM captions JOIN clips ON clips.id = captions.clip_id "
        "JOIN files ON files.id = clips.file_id WHERE side_file_id = ? AND text_id IS NOT NULL "
        "AND clips.part != '' AND captions.path = files.path ORDER BY 1",
        (side_file_id,),
    ).fetchall()


def texts_without_vectors(db: sqlite3.Connection, model_id: int) -> list[tuple[int, str]]:
    """Ids and texts of the captions that have no vector under a model."""
    return db.execute(
        "SELECT id, text FROM texts WHERE id IN (SELECT text_id FROM captions) "
        "AND id NOT IN (SELECT text_id FROM text_embeddings WHERE model_id = ?) ORDER BY id",
        (model_id,),
    ).fetchall()


def insert_text_vectors(
    db: sqlite3.Connection, model_id: int, text_ids: Sequence[int], vectors: NDArray[np.float16]
) -> None:
    """Store the vectors (N, D) of N texts under a model."""
    db.executemany(
        "INSERT INTO text_embeddings(text_id, model_id, vector) VALUES (?, ?, ?)",
        [(text_id, model_id, vector.tobytes()) for text_id, vector in zip(text_ids, vectors, strict=True)],
    )


def _insert(
    db: sqlite3.Connection,
    root_id: int,
    rows: Sequence[CaptionRow],
    *,
    side_file_id: int | None = None,
    clip_id: int | None = None,
) -> None:
    db.executemany(
        "INSERT OR IGNORE INTO texts(text) VALUES (?)", {(row.text,): None for row in rows if row.text is not None}
    )
    db.executemany(
        "INSERT INTO captions(side_file_id, clip_id, root_id, path, text_id, start, end, fps, up, split) "
        "VALUES (?, ?, ?, ?, (SELECT id FROM texts WHERE text = ?), ?, ?, ?, ?, ?)",
        [
            (side_file_id, clip_id, root_id, row.path, row.text, row.start, row.end, row.fps, row.up, row.split)
            for row in rows
        ],
    )


def _count_shown(db: sqlite3.Connection, column: str, value: int) -> int:
    """How many captions with a value in a column belong to a clip."""
    query = f"SELECT count(*) FROM captions WHERE {column} = ? AND clip_id IS NOT NULL"
    return int(db.execute(query, (value,)).fetchone()[0])
