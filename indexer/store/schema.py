"""The tables of `library.sqlite`, as numbered migrations that run when a library is opened for writing."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import randbits
from typing import TYPE_CHECKING, Any

from encoders.errors import LibraryDamaged, LibraryError, LibraryLocked, LibraryNotFound
from indexer.store import digests
from indexer.store.spelling import path_words

if TYPE_CHECKING:
    from sqlite_utils import Database

Migration = Callable[[Any], None]
MIGRATIONS: list[Migration] = []


def migration(step: Migration) -> Migration:
    """Register the next step; a step that has been released is never changed again."""
    MIGRATIONS.append(step)
    return step


@migration
def m001_first_tables(db: Database) -> None:
    """Files, clips, poses and captions, and the vectors of clips and captions."""
    # identity: tells this library's derived files from those of one that lay here before;
    # generation: grows with every batch; model: whose vectors are searched.
    db.table("settings").create({"key": str, "value": int}, pk="key")
    db.table("settings").insert_all([{"key": "identity", "value": randbits(62)}, {"key": "generation", "value": 0}])
    db.table("models").create(
        {"id": int, "fingerprint": str, "name": str, "size": int},
        pk="id",
        not_null={"fingerprint", "name", "size"},
    )
    db.table("models").create_index(["fingerprint"], unique=True)
    db.table("roots").create({"id": int, "path": str}, pk="id", not_null={"path"})
    db.table("roots").create_index(["path"], unique=True)

    # state: indexed, failed or gone. recipe: what besides the content decides how the file is read.
    db.table("files").create(
        {
            "id": int,
            "root_id": int,
            "path": str,
            "size": int,
            "mtime_ns": int,
            "hash": str,
            "recipe": str,
            "state": str,
            "reason": str,
        },
        pk="id",
        not_null={"root_id", "path", "size", "mtime_ns", "hash", "recipe", "state"},
        foreign_keys=[("root_id", "roots", "id")],
    )
    db.execute("CREATE UNIQUE INDEX files_present ON files(root_id, path) WHERE state != 'gone'")
    db.table("files").create_index(["hash"])

    # generation: the library's generation when the clip's vectors were last written or it came or went.
    db.table("clips").create(
        {
            "id": int,
            "file_id": int,
            "name": str,
            "format": str,
            "rig": str,
            "fps": float,
            "frames": int,
            "duration": float,
            "added": str,
            "generation": int,
        },
        pk="id",
        not_null={"file_id", "name", "format", "rig", "fps", "frames", "duration", "added", "generation"},
        foreign_keys=[("file_id", "files", "id")],
    )
    db.table("clips").create_index(["file_id"], unique=True)
    db.table("clips").create_index(["generation"])
    db.table("clips").create_index(["name"])
    db.table("clips").enable_fts(["name"], create_triggers=True)

    db.table("poses").create(
        {"clip_id": int, "chunk": int, "data": bytes},
        pk=("clip_id", "chunk"),
        not_null={"data"},
        foreign_keys=[("clip_id", "clips", "id")],
    )
    db.table("embeddings").create(
        {"clip_id": int, "model_id": int, "vector": bytes},
        pk=("clip_id", "model_id"),
        not_null={"vector"},
        foreign_keys=[("clip_id", "clips", "id"), ("model_id", "models", "id")],
    )
    db.table("windows").create(
        {"clip_id": int, "model_id": int, "length": float, "starts": bytes, "vectors": bytes},
        pk=("clip_id", "model_id", "length"),
        not_null={"starts", "vectors"},
        foreign_keys=[("clip_id", "clips", "id"), ("model_id", "models", "id")],
    )

    db.table("texts").create({"id": int, "text": str}, pk="id", not_null={"text"})
    db.table("texts").create_index(["text"], unique=True)
    db.table("texts").enable_fts(["text"], create_triggers=True)
    db.table("text_embeddings").create(
        {"text_id": int, "model_id": int, "vector": bytes},
        pk=("text_id", "model_id"),
        not_null={"vector"},
        foreign_keys=[("text_id", "texts", "id"), ("model_id", "models", "id")],
    )
    db.table("side_files").create(
        {"id": int, "root_id": int, "path": str, "size": int, "mtime_ns": int, "hash": str},
        pk="id",
        not_null={"root_id", "path", "size", "mtime_ns", "hash"},
        foreign_keys=[("root_id", "roots", "id")],
    )
    db.table("side_files").create_index(["root_id", "path"], unique=True)
    # root_id and path say what the side file names; clip_id is filled once that is indexed.
    # text_id is empty on a row that only states a frame rate.
    db.table("captions").create(
        {
            "id": int,
            "side_file_id": int,
            "root_id": int,
            "path": str,
            "clip_id": int,
            "text_id": int,
            "start": float,
            "end": float,
            "fps": float,
        },
        pk="id",
        foreign_keys=[
            ("side_file_id", "side_files", "id"),
            ("root_id", "roots", "id"),
            ("clip_id", "clips", "id"),
            ("text_id", "texts", "id"),
        ],
    )
    for columns in (["clip_id"], ["root_id", "path"], ["side_file_id"], ["text_id"]):
        db.table("captions").create_index(columns)


@migration
def m002_stamped_generations(db: Database) -> None:
    """A random number for each generation, which a copy that goes on elsewhere does not share."""
    db.table("generations").create({"generation": int, "stamp": int}, pk="generation", not_null={"stamp"})
    db.execute("INSERT INTO generations SELECT value, random() FROM settings WHERE key = 'generation'")


@migration
def m003_splits(db: Database) -> None:
    """Rows of captions that state the split of a data set that a clip is in."""
    db.execute("ALTER TABLE captions ADD COLUMN split TEXT")
    db.execute("CREATE INDEX captions_split ON captions(split) WHERE split IS NOT NULL")


#: The tables that `m005_digests` gives a digest.
_WITH_DIGESTS = (
    "roots", "files", "clips", "poses", "models", "embeddings", "windows", "side_files", "texts", "text_embeddings",
    "captions",
)  # fmt: skip
#: What `m004_several_clips_a_file` adds to `clips`: name, type, and the value for clips that were there before.
_READING = (
    ("part", "TEXT", "''"),
    ("take", "TEXT", "''"),
    ("up", "TEXT", "''"),
    ("up_reason", "TEXT", "''"),
    ("start", "REAL", "0.0"),
    ("source_fps", "REAL", "0.0"),
    ("source_frames", "INTEGER", "0"),
    ("warnings", "TEXT", "'[]'"),
)


@migration
def m004_several_clips_a_file(db: Database) -> None:
    """Clips that are parts of a file, and how each was read."""
    for name, kind, value in _READING:
        db.execute(f"ALTER TABLE clips ADD COLUMN {name} {kind} NOT NULL DEFAULT {value}")
    # clip_path: that of the file, with the part; relative to the root.
    db.execute("ALTER TABLE clips ADD COLUMN clip_path TEXT NOT NULL DEFAULT ''")
    db.execute("UPDATE clips SET clip_path = (SELECT path FROM files WHERE files.id = file_id)")
    db.execute("DROP INDEX idx_clips_file_id")
    db.table("clips").create_index(["file_id", "part"], unique=True)
    db.table("clips").create_index(["clip_path"])


@migration
def m005_digests(db: Database) -> None:
    """A digest of each row. To write it must not touch the full-text tables, so they follow their own column alone."""
    digests.add_columns(db, _WITH_DIGESTS)
    for table, column in (("clips", "name"), ("texts", "text")):
        _follow_alone(db, table, column)


def _follow_alone(db: Database, table: str, column: str) -> None:
    """Let a full-text table follow changes of its own column alone."""
    (trigger,) = (trigger for trigger in db.table(table).triggers if trigger.name == f"{table}_au")
    db.execute(f"DROP TRIGGER {trigger.name}")
    db.execute(trigger.sql.replace("AFTER UPDATE ON", f"AFTER UPDATE OF {column} ON"))


@migration
def m006_stated_axes(db: Database) -> None:
    """Rows of captions that state which axis of a file is up."""
    db.execute("ALTER TABLE captions ADD COLUMN up TEXT")
    digests.register(db.conn)
    row = 'id, side_file_id, root_id, path, clip_id, text_id, start, "end", fps'
    db.execute(f"UPDATE captions SET digest = digest({row}, up, split) WHERE digest = digest({row}, split)")


@migration
def m007_marks(db: Database) -> None:
    """Stars, tags and collections. root and path say where the clip lies; clip_id is empty where it is lost."""
    db.table("marks").create(
        {
            "id": int,
            "clip_id": int,
            "root": str,
            "path": str,
            "kind": str,
            "name": str,
            "added": str,
            "digest": int,
        },
        pk="id",
        not_null={"root", "path", "kind", "name", "added"},
        foreign_keys=[("clip_id", "clips", "id")],
    )
    db.table("marks").create_index(["clip_id", "kind", "name"], unique=True)
    for columns in (["root", "path"], ["kind", "name"]):
        db.table("marks").create_index(columns)


@migration
def m008_words_of_paths(db: Database) -> None:
    """The words of paths, and with captions in their stems, to be found by."""
    db.execute("ALTER TABLE clips ADD COLUMN words TEXT NOT NULL DEFAULT ''")
    db.conn.create_function("path_words", 1, path_words, deterministic=True)
    digests.register(db.conn)
    db.execute("UPDATE clips SET words = path_words(clip_path)")
    row = ", ".join(f'"{column}"' for column in digests.COVERED["clips"] if column != "words")
    db.execute(f"UPDATE clips SET digest = digest({row}, words) WHERE digest = digest({row})")
    for table, column in (("clips", "words"), ("texts", "text")):
        db.table(table).disable_fts()
        stems = "porter unicode61 remove_diacritics 2"
        db.table(table).enable_fts([column], create_triggers=True, tokenize=stems)
        _follow_alone(db, table, column)


def _as_of_today(connection: sqlite3.Connection, version: int) -> None:
    """Show the tables of an older library, which is only read, with what they lack."""
    if version == 7:
        return
    empty = "SELECT 0 AS clip_id, '' AS root, '' AS path, '' AS kind, '' AS name, '' AS added, 0 AS id WHERE 0"
    connection.execute(f"CREATE TEMP VIEW marks AS {empty}")
    if version < 4:
        defaults = ", ".join(f"{value} AS {name}" for name, _, value in _READING)
        path = "(SELECT path FROM main.files WHERE files.id = file_id) AS clip_path"
        connection.execute(f"CREATE TEMP VIEW clips AS SELECT *, {defaults}, {path} FROM main.clips")
    if version < 6:
        split = "" if version >= 3 else ", NULL AS split"
        connection.execute(f"CREATE TEMP VIEW captions AS SELECT *{split}, NULL AS up FROM main.captions")


def connect(path: Path, *, writable: bool) -> sqlite3.Connection:
    """A connection to a library's SQLite file; transactions are begun by hand (`transaction`).

    Raises
    ------
    LibraryNotFound
        If there is no such file.
    LibraryLocked
        If another process holds it.
    LibraryDamaged
        If it is no SQLite database or an empty one.
    LibraryError
        If it cannot be opened, or is of a version that this program does not know.
    """
    try:
        connection = _connect(path, "rwc" if writable else "ro")
        version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    except sqlite3.Error as error:
        raise cause(path, error) from error
    if version > len(MIGRATIONS):
        connection.close()
        raise LibraryError(f"{path}: written by a newer motionseek; update motionseek to open it")
    if version == 0 and not writable:
        connection.close()
        raise LibraryDamaged(
            f"{path}: not finished: it was begun, and nothing was written yet; run 'motionseek index' again"
        )
    digests.register(connection)
    if version < 8 and not writable:
        _as_of_today(connection, version)
    return connection


def cause(path: Path, error: sqlite3.Error) -> LibraryError:
    """Why a library file cannot be opened or read."""
    if not path.parent.exists() or (not path.exists() and os.access(path.parent, os.W_OK)):
        return LibraryNotFound(f"{path}: there is no such file")
    if path.exists() and not os.access(path, os.R_OK):
        return LibraryError(f"{path}: permission denied; ask its owner to let you read it")
    if "locked" in str(error):
        return LibraryLocked(f"{path}: locked by another process; try again when it has ended")
    if "full" in str(error) or "I/O error" in str(error):
        return LibraryError(f"{path}: cannot be read now ({error}); make room, check the disk, and try again")
    kind = LibraryError if isinstance(error, sqlite3.OperationalError) else LibraryDamaged
    return kind(f"{path}: cannot be opened as a library ({error}); if it is damaged, delete its folder and index again")


class FrozenConnection(sqlite3.Connection):
    """A connection to a file that is taken not to change while it is open, without locks."""


def not_written(path: Path, error: sqlite3.OperationalError) -> LibraryError:
    """Why a library file cannot be written, and what to do."""
    if "full" in str(error):
        what = "the disk is full; make room"
    elif "I/O error" in str(error):
        what = f"the disk fails ({error}); check it and make room"
    else:
        what = f"cannot be written ({error}); see that it may be"
    return LibraryError(f"{path}: {what}, and run 'motionseek index' again: what was committed is kept")


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    uri = path.absolute().as_uri()
    try:
        connection = sqlite3.connect(
            f"{uri}?mode={mode}", uri=True, timeout=30, isolation_level=None, check_same_thread=False
        )
        connection.execute("PRAGMA user_version")
        return connection
    except sqlite3.OperationalError:
        # In a read-only folder the shared memory of the log cannot be made. SQLite can do without, but leaves out what
        # a killed writer or a copy has left in the log.
        if mode != "ro" or not path.exists() or os.access(path.parent, os.W_OK):
            raise
        log = path.with_name(f"{path.name}-wal")
        if log.exists() and log.stat().st_size:
            raise LibraryError(
                f"{path}: its last changes lie in {log.name}, which cannot be read in a read-only folder; "
                "copy the whole folder to where you may write and open it there"
            ) from None
        return sqlite3.connect(
            f"{uri}?immutable=1", uri=True, isolation_level=None, check_same_thread=False, factory=FrozenConnection
        )


def migrate(connection: sqlite3.Connection) -> None:
    """Bring the tables up to date: each missing step in a transaction of its own."""
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")
    connection.execute("PRAGMA foreign_keys=ON")
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    if version == len(MIGRATIONS):
        return
    from sqlite_utils import Database  # slow to import, and few commands need it

    for number, step in enumerate(MIGRATIONS[version:], start=version + 1):
        with transaction(connection):
            if connection.execute("PRAGMA user_version").fetchone()[0] < number:  # else another process was faster
                step(Database(connection))
                connection.execute(f"PRAGMA user_version={number}")


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """All or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:  # else SQLite has rolled back by itself, as where the disk is full
            connection.execute("ROLLBACK")
        raise
