"""A digest for each row of a library, written with it: it tells of damage that SQLite itself does not see."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from hashlib import blake2b
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sqlite_utils import Database

#: Table -> the columns that its digest covers.
COVERED = {
    "roots": ("id", "path"),
    "files": ("id", "root_id", "path", "size", "mtime_ns", "hash", "recipe", "state", "reason"),
    "clips": (
        "id", "file_id", "clip_path", "part", "name", "format", "rig", "fps", "frames", "duration", "added", "take",
        "up", "up_reason", "start", "source_fps", "source_frames", "warnings", "words",
    ),
    "poses": ("clip_id", "chunk", "data"),
    "models": ("id", "fingerprint", "name", "size"),
    "embeddings": ("clip_id", "model_id", "vector"),
    "windows": ("clip_id", "model_id", "length", "starts", "vectors"),
    "side_files": ("id", "root_id", "path", "size", "mtime_ns", "hash"),
    "texts": ("id", "text"),
    "text_embeddings": ("text_id", "model_id", "vector"),
    "captions": ("id", "side_file_id", "root_id", "path", "clip_id", "text_id", "start", "end", "fps", "up", "split"),
    "marks": ("id", "clip_id", "root", "path", "kind", "name", "added"),
}  # fmt: skip


def digest(*values: object) -> int:
    """The digest of a row's values, as a number of 63 bits; numbers count by their value, whatever their type."""
    hashed = blake2b(digest_size=8)
    for value in values:
        exact = int(value) if isinstance(value, float) and value.is_integer() else value
        content = exact if isinstance(exact, bytes) else repr(exact).encode("utf-8", "surrogatepass")
        hashed.update(len(content).to_bytes(8, "little") + content)
    return int.from_bytes(hashed.digest(), "little") >> 1


def add_columns(db: Database, tables: Iterable[str]) -> None:
    """Give tables a digest; rows that are there already have none."""
    for table in tables:
        db.execute(f"ALTER TABLE {table} ADD COLUMN digest INTEGER")


def register(connection: sqlite3.Connection) -> None:
    """Let statements on a connection call `digest`."""
    connection.create_function("digest", -1, digest, deterministic=True)


def keep(connection: sqlite3.Connection) -> None:
    """Have a writing connection bring the digest of each row up to date that it inserts or changes.

    The triggers are the connection's own, so that a change by any other program shows.
    """
    for table, columns in COVERED.items():
        row, covered = ", ".join(f'NEW."{column}"' for column in columns), ", ".join(_quoted(columns))
        update = f"UPDATE {table} SET digest = digest({row}) WHERE rowid = NEW.rowid"
        for name, event in (("inserted", "INSERT"), ("changed", f"UPDATE OF {covered}")):
            connection.execute(f"CREATE TEMP TRIGGER {table}_{name} AFTER {event} ON main.{table} BEGIN {update}; END")


def damaged_rows(connection: sqlite3.Connection, table: str) -> list[int]:
    """The numbers of the rows of a table whose content is not what was written.

    Raises
    ------
    sqlite3.DatabaseError
        If the table cannot be read to its end.
    """
    columns = ", ".join(_quoted(COVERED[table]))
    query = f"SELECT rowid FROM {table} WHERE digest IS NOT NULL AND digest != digest({columns})"
    return [row[0] for row in connection.execute(query)]


def _quoted(columns: tuple[str, ...]) -> list[str]:
    return [f'"{column}"' for column in columns]
