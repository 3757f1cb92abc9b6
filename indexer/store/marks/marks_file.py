"""The marks in a file of their own beside the database: people's work, which no motion file holds.

It is written after every change, and read where the database is damaged or was deleted. Its first line is a record of
the rest: the generation of the marks, and a digest.
"""

from __future__ import annotations

import json
import os
import sqlite3
from hashlib import blake2b
from pathlib import Path
from typing import NamedTuple

from encoders.errors import LibraryError
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import COLLECTION, STAR, TAG, MarkRow

FILE = "marks.jsonl"
#: Bytes of the largest file that is read, some hundred thousand marks.
_LARGEST = 1 << 28


class Held(NamedTuple):
    """What the file holds: the generation in which it was written, and the marks."""

    generation: int
    rows: list[MarkRow]


def read(folder: Path) -> Held | None:
    """What the file of a library holds; None where it is not there or not as written."""
    path = folder / FILE
    try:
        if path.stat().st_size > _LARGEST:
            return None
        head, _, rest = path.read_bytes().partition(b"\n")
        record = json.loads(head)
        if record["digest"] != _digest(rest) or not isinstance(record["generation"], int):
            return None
        found = [MarkRow(*map(str, json.loads(line))) for line in rest.splitlines()]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return Held(record["generation"], [row for row in found if row.kind in (STAR, TAG, COLLECTION)])


def update(folder: Path, db: sqlite3.Connection) -> None:
    """Write the file where marks have changed since.

    Raises
    ------
    LibraryError
        If it cannot be written.
    """
    generation = marks_table.generation(db)
    if generation == _written(folder):
        return
    rest = "".join(f"{json.dumps(row, ensure_ascii=True)}\n" for row in marks_table.rows(db)).encode()
    head = json.dumps({"generation": generation, "digest": _digest(rest)}).encode()
    path, fresh = folder / FILE, folder / f"{FILE}.new"
    try:
        with fresh.open("wb") as file:
            file.write(head + b"\n" + rest)
            file.flush()
            os.fsync(file.fileno())
        os.replace(fresh, path)
    except OSError as error:
        raise LibraryError(
            f"{path}: cannot be written ({error.strerror}); make room: the marks are in the library, and the next "
            "change writes this copy of them"
        ) from error


def to_recover(folder: Path, db: sqlite3.Connection) -> list[MarkRow]:
    """The marks that the file holds, where the database knows of no change of marks: it was deleted, or salvaged."""
    held = read(folder) if marks_table.generation(db) == 0 else None
    return [] if held is None else held.rows


def differs(folder: Path, db: sqlite3.Connection) -> bool:
    """Whether the file is not as written, or of the database's generation of marks and yet of other marks.

    An older one is only behind: the process ended that would have written it.
    """
    held = read(folder)
    if held is None:
        return (folder / FILE).exists()
    return held.generation == marks_table.generation(db) and sorted(held.rows) != sorted(marks_table.rows(db))


def put_aside(folder: Path) -> None:
    """Rename a file that is not as written, so that the next change, or `update`, writes another."""
    if (folder / FILE).exists():
        os.replace(folder / FILE, folder / f"{FILE}.damaged")


def _written(folder: Path) -> int:
    """The generation that the file names; 0 where there is no file, as if no mark had ever changed."""
    try:
        with (folder / FILE).open("rb") as file:
            return int(json.loads(file.readline(1000))["generation"])
    except FileNotFoundError:
        return 0
    except (OSError, ValueError, KeyError, TypeError):
        return -1


def _digest(rest: bytes) -> str:
    return blake2b(rest, digest_size=16).hexdigest()
