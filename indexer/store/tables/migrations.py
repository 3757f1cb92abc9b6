"""The tables of `library.sqlite`, as numbered migrations that run when a library is opened for writing."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from secrets import randbits
from typing import TYPE_CHECKING, Any

from indexer.store.spelling import path_words
from indexer.store.tables import digests

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
READING = (
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
    for name, kind, value in READING:
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


def show_as_of_today(connection: sqlite3.Connection, version: int) -> None:
    """Show the tables of an older library, which is only read, with what they lack."""
    if version == 7:
        return
    empty = "SELECT 0 AS clip_id, '' AS root, '' AS path, '' AS kind, '' AS name, '' AS added, 0 AS id WHERE 0"
    connection.execute(f"CREATE TEMP VIEW marks AS {empty}")
    if version < 4:
        defaults = ", ".join(f"{value} AS {name}" for name, _, value in READING)
        path = "(SELECT path FROM main.files WHERE files.id = file_id) AS clip_path"
        connection.execute(f"CREATE TEMP VIEW clips AS SELECT *, {defaults}, {path} FROM main.clips")
    if version < 6:
        split = "" if version >= 3 else ", NULL AS split"
        connection.execute(f"CREATE TEMP VIEW captions AS SELECT *{split}, NULL AS up FROM main.captions")
