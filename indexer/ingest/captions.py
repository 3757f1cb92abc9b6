"""The library's captions, kept in step with the side files of a folder.

A row of a side file names a motion by its path; it is attached to the clip of that path when there is one, and
stays with the clip wherever that moves.
"""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

import numpy as np

from encoders.protocol import Encoder
from indexer.ingest.caption_files import Row, Warn, read_lines, read_table
from indexer.ingest.scan import TABLES, File

if TYPE_CHECKING:
    from indexer.store.writer import Writer

_TEXTS_A_BATCH = 512

#: The clip that lies at a caption's path now.
_CLIP_THERE = (
    "SELECT clips.id FROM clips JOIN files ON files.id = clips.file_id "
    "WHERE files.root_id = captions.root_id AND files.path = captions.path AND files.state = 'indexed'"
)


@dataclass
class Synced:
    """The side files that were read in this run, and those that have vanished, by id."""

    read: list[int] = field(default_factory=list)
    vanished: list[int] = field(default_factory=list)


def sync(
    db: sqlite3.Connection, root: Path, root_id: int, side_files: list[tuple[File, list[str]]], warn: Warn
) -> Synced:
    """Read the side files that are new or changed; unchanged ones are not opened."""
    rows = db.execute("SELECT path, id, size, mtime_ns, hash FROM side_files WHERE root_id = ?", (root_id,))
    known = {row[0]: row[1:] for row in rows}
    synced = Synced()
    for file, targets in side_files:
        _, size, mtime_ns, old_hash = known.pop(file.path, (None, -1, -1, ""))
        if (size, mtime_ns) == (file.size, file.mtime_ns):
            continue
        try:
            digest = file.hash(root)
            captions = _read(root, file, targets, warn) if digest != old_hash else None
        except OSError as error:
            warn(f"{root / file.path}: {(error.strerror or str(error)).lower()}; its captions are left as they were")
            continue
        file_id = _remember(db, root_id, file, digest)
        if captions is not None:
            _replace(db, root_id, file_id, captions)
            synced.read.append(file_id)
    synced.vanished = [row[0] for row in known.values()]
    return synced


def rates(db: sqlite3.Connection, root_id: int, synced: Synced) -> dict[str, float]:
    """Path -> frame rate, as the captions tables state it."""
    rows = db.execute(
        "SELECT path, fps, side_file_id FROM captions WHERE root_id = ? AND fps IS NOT NULL ORDER BY id", (root_id,)
    )
    return {path: fps for path, fps, file_id in rows if file_id not in synced.vanished}


def attach(db: sqlite3.Connection, clip_id: int, root_id: int, path: str) -> None:
    """Give a clip the captions that wait for its path."""
    db.execute(
        "UPDATE captions SET clip_id = ? WHERE root_id = ? AND path = ? AND (clip_id IS NULL OR clip_id IN "
        "(SELECT clips.id FROM clips JOIN files ON files.id = clips.file_id WHERE files.state = 'gone'))",
        (clip_id, root_id, path),
    )


def forget(db: sqlite3.Connection, side_file_ids: list[int]) -> None:
    """Drop the captions of side files that have vanished.

    Those of a motion that lies elsewhere now, and has no others, stay with it.
    """
    for file_id in side_file_ids:
        db.execute(
            "UPDATE captions SET side_file_id = NULL WHERE side_file_id = ? AND clip_id IS NOT NULL "
            f"AND clip_id IS NOT ({_CLIP_THERE}) AND NOT EXISTS (SELECT 1 FROM captions AS others "
            "WHERE others.clip_id = captions.clip_id AND others.side_file_id != captions.side_file_id)",
            (file_id,),
        )
        db.execute("DELETE FROM captions WHERE side_file_id = ?", (file_id,))
        db.execute("DELETE FROM side_files WHERE id = ?", (file_id,))


def unmatched(db: sqlite3.Connection, root: Path, synced: Synced) -> list[str]:
    """What to tell of the side files just read that name motions which the library does not have."""
    told = []
    for file_id in synced.read:
        path, count, example = db.execute(
            "SELECT side_files.path, count(captions.id), min(captions.path) FROM side_files LEFT JOIN captions "
            "ON side_file_id = side_files.id AND clip_id IS NULL AND text_id IS NOT NULL WHERE side_files.id = ?",
            (file_id,),
        ).fetchone()
        if count:
            rows = f"{count} captions are" if count > 1 else "a caption is"
            told.append(f"{root / path}: {rows} of motions that are not indexed, such as {example!r}")
    return told


def encode_texts(writer: Writer, bundle: Encoder, model_id: int) -> None:
    """Vectors for the captions that have none under a model, in batches of their own."""
    db = writer.connection
    texts = db.execute(
        "SELECT id, text FROM texts WHERE id IN (SELECT text_id FROM captions) "
        "AND id NOT IN (SELECT text_id FROM text_embeddings WHERE model_id = ?) ORDER BY id",
        (model_id,),
    ).fetchall()
    for first in range(0, len(texts), _TEXTS_A_BATCH):
        part = texts[first : first + _TEXTS_A_BATCH]
        vectors = bundle.encode_texts([text for _, text in part]).astype(np.float16)
        with writer.batch():
            db.executemany(
                "INSERT INTO text_embeddings VALUES (?, ?, ?)",
                [(text_id, model_id, vector.tobytes()) for (text_id, _), vector in zip(part, vectors, strict=True)],
            )


def _read(root: Path, file: File, targets: list[str], warn: Warn) -> list[Row]:
    path = PurePosixPath(file.path)
    if path.name.lower() in TABLES:
        folder = "" if str(path.parent) == "." else str(path.parent)
        return read_table(root / file.path, folder, warn)
    return [Row(target, *caption) for caption in read_lines(root / file.path, warn) for target in targets]


def _remember(db: sqlite3.Connection, root_id: int, file: File, digest: str) -> int:
    db.execute(
        "INSERT INTO side_files(root_id, path, size, mtime_ns, hash) VALUES (?, ?, ?, ?, ?) "
        "ON CONFLICT(root_id, path) DO UPDATE SET size = excluded.size, mtime_ns = excluded.mtime_ns, "
        "hash = excluded.hash",
        (root_id, file.path, file.size, file.mtime_ns, digest),
    )
    row = db.execute("SELECT id FROM side_files WHERE root_id = ? AND path = ?", (root_id, file.path)).fetchone()
    return int(row[0])


def _replace(db: sqlite3.Connection, root_id: int, file_id: int, rows: list[Row]) -> None:
    db.execute("DELETE FROM captions WHERE side_file_id = ?", (file_id,))
    db.executemany(
        "INSERT OR IGNORE INTO texts(text) VALUES (?)", {(row.text,): None for row in rows if row.text is not None}
    )
    db.executemany(
        "INSERT INTO captions(side_file_id, root_id, path, text_id, start, end, fps) "
        "VALUES (?, ?, ?, (SELECT id FROM texts WHERE text = ?), ?, ?, ?)",
        [(file_id, root_id, row.path, row.text, row.start, row.end, row.fps) for row in rows],
    )
    db.execute(f"UPDATE captions SET clip_id = ({_CLIP_THERE}) WHERE side_file_id = ?", (file_id,))
