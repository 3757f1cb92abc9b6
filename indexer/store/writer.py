"""The one writer of a library: every change is a batch, and a batch is one transaction and one generation."""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from datetime import datetime, timezone
from hashlib import blake2b
from pathlib import Path
from secrets import randbits

from encoders.errors import LibraryError, LibraryLocked
from encoders.motion import Motion
from indexer.part_names import with_part
from indexer.read_motion import ReadMotion
from indexer.store import captions, file_rows, models, poses, schema
from indexer.store.captions import CaptionRow
from indexer.store.file_rows import AT_PATH
from indexer.store.files import ARRAYS_ROOT, FAILED, GONE, INDEXED, ArrayItem, File, FileVersion
from indexer.store.lock import write_lock
from indexer.store.marks import marks_file, marks_table
from indexer.store.models import ClipVectors
from indexer.store.read_options import ReadOptions
from indexer.store.spelling import path_words
from indexer.store.tables import digests


class Writer:
    """Changes to a library; `writing` gives one."""

    def __init__(self, folder: Path, connection: sqlite3.Connection) -> None:
        self.folder = folder
        self.connection = connection
        self._generation = 0
        self._token = randbits(62)
        with schema.transaction(connection):
            connection.execute("INSERT OR REPLACE INTO settings(key, value) VALUES ('writer', ?)", (self._token,))

    @contextmanager
    def batch(self) -> Iterator[None]:
        """All changes inside become visible together, under the next generation."""
        with schema.transaction(self.connection):
            self._check_sole_writer()
            self._generation = (
                1 + self.connection.execute("SELECT value FROM settings WHERE key = 'generation'").fetchone()[0]
            )
            self.connection.execute("UPDATE settings SET value = ? WHERE key = 'generation'", (self._generation,))
            self.connection.execute("INSERT INTO generations VALUES (?, random())", (self._generation,))
            yield

    def _check_sole_writer(self) -> None:
        """See that no other process has become the writer, as it can where the lock's file was deleted or is no lock.

        Raises
        ------
        LibraryLocked
            If one has.
        """
        row = self.connection.execute("SELECT value FROM settings WHERE key = 'writer'").fetchone()
        if row != (self._token,):
            raise LibraryLocked(
                f"{self.folder}: another process has begun to write it, as its writer.lock was deleted or the file "
                "system has no locks; what was committed is kept, run the command again when that is done"
            )

    def recover_marks(self) -> None:
        """Bring back the marks of the file beside the database where this lacks them; see `marks_file`."""
        if lost := marks_file.to_recover(self.folder, self.connection):
            with self.batch():
                marks_table.restore(self.connection, lost)

    def root(self, path: Path) -> int:
        """The id of an indexed folder, new or known.

        One that holds the library is stored relative to it, so that both can be moved together.

        Raises
        ------
        LibraryError
            If it lies inside another indexed folder or the other way round.
        """
        inside = self.folder.is_relative_to(path)
        stored = Path(os.path.relpath(path, self.folder)).as_posix() if inside else path.as_posix()
        for key, other in self.connection.execute("SELECT id, path FROM roots").fetchall():
            if other == stored:
                return int(key)
            if other == ARRAYS_ROOT:
                continue
            place = (self.folder / other).resolve()
            if place.is_relative_to(path) or path.is_relative_to(place):
                raise LibraryError(f"{path}: lies inside {place} or around it, which this library indexes already")
        return int(self.connection.execute("INSERT INTO roots(path) VALUES (?)", (stored,)).lastrowid or 0)

    def _arrays_root(self) -> int:
        """The id of the root of the clips that no file holds."""
        self.connection.execute("INSERT OR IGNORE INTO roots(path) VALUES (?)", (ARRAYS_ROOT,))
        row = self.connection.execute("SELECT id FROM roots WHERE path = ?", (ARRAYS_ROOT,)).fetchone()
        return int(row[0])

    def root_path(self, root_id: int) -> Path:
        """Where an indexed folder lies."""
        path: str = self.connection.execute("SELECT path FROM roots WHERE id = ?", (root_id,)).fetchone()[0]
        return (self.folder / path).resolve()

    def fail(self, source: FileVersion, reason: str, *, doubted: bool = False) -> bool:
        """Record that a file cannot be read; the clips of an earlier version of it are gone.

        With `doubted` the reason may not lie in the content: the first time it is recorded so that the file is tried
        again at the next run, and clips of an earlier version stay until then. Whether it was.
        """
        if doubted and not file_rows.has_failed(self.connection, source):
            file_rows.fail_once(self.connection, source, reason)
            return True
        self._retire(source)
        file_rows.insert(self.connection, source, FAILED, reason)
        return False

    def add(self, source: FileVersion, clips: Sequence[tuple[ReadMotion, ClipVectors]], model_id: int) -> list[int]:
        """Store the clips of a file, new or its new content, each with the captions that name its path; their ids.

        A clip that was there is known by its part; one whose part is no longer there is gone.
        """
        file_id = file_rows.put(self.connection, source)
        ids = []
        for read, vectors in clips:
            clip_id, is_new = self._clip(file_id, source.file, read)
            self._put_content(clip_id, read.motion, vectors, model_id)
            ids.append((clip_id, is_new))
        self._drop_others(file_id, [clip_id for clip_id, _ in ids])
        paths = [with_part(source.file.path, read.part) for read, _ in clips]
        # Captions that name the file alone are the first clip's.
        for path, (clip_id, is_new) in zip((*paths, source.file.path), (*ids, ids[0]), strict=True):
            captions.attach(self.connection, clip_id, source.root_id, path, is_new=is_new)
        for path, (clip_id, _) in zip(paths, ids, strict=True):
            marks_table.attach(self.connection, clip_id, source.root_id, path)
        return [clip_id for clip_id, _ in ids]

    def _drop_others(self, file_id: int, kept: Sequence[int]) -> None:
        """Drop the clips of a file that are not among those kept."""
        rows = self.connection.execute("SELECT id FROM clips WHERE file_id = ?", (file_id,)).fetchall()
        for (clip_id,) in rows:
            if clip_id not in kept:
                self._drop(clip_id)

    def _drop(self, clip_id: int) -> None:
        """Drop a clip with its poses and vectors.

        Its row stays, as of a file that has vanished, so that vector indexes learn that it went.
        """
        db = self.connection
        gone = db.execute(
            "INSERT INTO files(root_id, path, size, mtime_ns, hash, recipe, state) "
            "SELECT root_id, clip_path, 0, 0, '', recipe, ? FROM clips JOIN files ON files.id = file_id "
            "WHERE clips.id = ?",
            (GONE, clip_id),
        ).lastrowid
        for table in ("poses", "embeddings", "windows"):
            db.execute(f"DELETE FROM {table} WHERE clip_id = ?", (clip_id,))
        db.execute("UPDATE clips SET file_id = ?, generation = ? WHERE id = ?", (gone, self._generation, clip_id))

    def forget(self, clip_ids: Iterable[int]) -> list[str]:
        """Drop clips with the captions that no file holds; their paths. Their files, where they are there, are new."""
        db, paths = self.connection, []
        for clip_id in clip_ids:
            path, file_id = db.execute("SELECT clip_path, file_id FROM clips WHERE id = ?", (clip_id,)).fetchone()
            self._drop(clip_id)
            captions.forget(db, clip_id)
            marks_table.forget(db, clip_id)
            db.execute("UPDATE files SET hash = '', size = -1 WHERE id = ?", (file_id,))
            db.execute("DELETE FROM files WHERE id = ? AND id NOT IN (SELECT file_id FROM clips)", (file_id,))
            paths.append(path)
        return paths

    def add_array(
        self, item: ArrayItem, read: ReadMotion, rows: Sequence[CaptionRow], vectors: ClipVectors, model_id: int
    ) -> int:
        """Store a clip that no file holds, or replace the one of that id, with its captions; the clip's id."""
        root_id = self._arrays_root()
        # Never that of a file.
        digest = blake2b(read.motion.joints.tobytes(), digest_size=16, person=b"array").hexdigest()
        file_id = file_rows.put(self.connection, FileVersion(root_id, item, digest, ReadOptions()))
        clip_id, is_new = self._clip(file_id, item, read)
        captions.replace_of_clip(self.connection, root_id, clip_id, rows, is_new=is_new)
        marks_table.attach(self.connection, clip_id, root_id, item.path)
        self._put_content(clip_id, read.motion, vectors, model_id)
        return clip_id

    def remove_array(self, id: str) -> bool:
        """Remove a clip that no file holds, with all that belongs to it; whether there was one of that id.

        Its row stays, as of a file that has vanished, so that vector indexes learn that it went.
        """
        row = self.connection.execute(
            f"SELECT clips.id, files.id FROM clips JOIN files ON files.id = clips.file_id WHERE {AT_PATH}",
            (self._arrays_root(), id, INDEXED),
        ).fetchone()
        if row is None:
            return False
        clip_id, file_id = row
        for table in ("captions", "poses", "embeddings", "windows"):
            self.connection.execute(f"DELETE FROM {table} WHERE clip_id = ?", (clip_id,))
        marks_table.forget(self.connection, clip_id)
        self.gone([file_id])
        return True

    def _put_content(self, clip_id: int, motion: Motion, vectors: ClipVectors, model_id: int) -> None:
        """Store poses and vectors in place of what there was."""
        db = self.connection
        for table in ("poses", "embeddings", "windows"):
            db.execute(f"DELETE FROM {table} WHERE clip_id = ?", (clip_id,))
        chunks = [(clip_id, number, data) for number, data in enumerate(poses.pack_all(motion.joints))]
        db.executemany("INSERT INTO poses(clip_id, chunk, data) VALUES (?, ?, ?)", chunks)
        models.insert_vectors(db, clip_id, model_id, vectors)

    def move(self, file_id: int, root_id: int, file: File) -> None:
        """A file has moved, or is back; its clips keep all that belongs to them."""
        db = self.connection
        db.execute(f"DELETE FROM files WHERE {AT_PATH}", (root_id, file.path, FAILED))
        db.execute(
            "UPDATE files SET root_id = ?, path = ?, size = ?, mtime_ns = ?, state = ? WHERE id = ?",
            (root_id, file.path, file.size, file.mtime_ns, INDEXED, file_id),
        )
        clips = db.execute("SELECT id, part FROM clips WHERE file_id = ? ORDER BY id", (file_id,)).fetchall()
        for clip_id, part in clips:
            path = with_part(file.path, part)
            db.execute(
                "UPDATE clips SET name = ?, clip_path = ?, words = ?, format = ?, generation = ? WHERE id = ?",
                (with_part(file.name, part), path, path_words(path), file.format, self._generation, clip_id),
            )
            captions.attach(db, clip_id, root_id, path, is_new=False)
            marks_table.attach(db, clip_id, root_id, path)
        captions.attach(db, clips[0][0], root_id, file.path, is_new=False)

    def gone(self, file_ids: Iterable[int]) -> None:
        """Files have vanished: their clips are no longer found, but kept in case they come back."""
        for file_id in file_ids:
            self.connection.execute("DELETE FROM files WHERE id = ? AND state = ?", (file_id, FAILED))
            self.connection.execute("UPDATE files SET state = ? WHERE id = ?", (GONE, file_id))
            self.connection.execute("UPDATE clips SET generation = ? WHERE file_id = ?", (self._generation, file_id))

    def _clip(self, file_id: int, file: File, read: ReadMotion) -> tuple[int, bool]:
        """The row of one of a file's clips, inserted or updated: its id, and whether it is new."""
        values = {
            "name": with_part(file.name, read.part),
            "clip_path": with_part(file.path, read.part),
            "words": path_words(with_part(file.path, read.part)),
            "format": file.format,
            "rig": read.rig,
            "fps": read.motion.fps,
            "frames": len(read.motion),
            "duration": read.motion.duration,
            "generation": self._generation,
        }
        values |= read.reading.record() | {"warnings": json.dumps(read.reading.warnings, ensure_ascii=False)}
        db = self.connection
        row = db.execute("SELECT id FROM clips WHERE file_id = ? AND part = ?", (file_id, read.part)).fetchone()
        if row is not None:
            settings = ", ".join(f"{name} = ?" for name in values)
            db.execute(f"UPDATE clips SET {settings} WHERE id = ?", (*values.values(), row[0]))
            return int(row[0]), False
        values |= {"file_id": file_id, "part": read.part}
        values["added"] = datetime.now(timezone.utc).isoformat(timespec="seconds")
        marks = ", ".join("?" * len(values))
        cursor = db.execute(f"INSERT INTO clips({', '.join(values)}) VALUES ({marks})", tuple(values.values()))
        return int(cursor.lastrowid or 0), True

    def _retire(self, source: FileVersion) -> None:
        rows = self.connection.execute(
            f"SELECT id FROM files WHERE {AT_PATH}",
            (source.root_id, source.file.path, INDEXED),
        ).fetchall()
        self.gone(row[0] for row in rows)


@contextmanager
def writing(folder: Path) -> Iterator[Writer]:
    """The writer of the library in `folder`, which is created where there is none.

    Raises
    ------
    LibraryLocked
        If another process is writing it.
    LibraryError
        If the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(13, "it is read-only")
    except OSError as error:
        raise LibraryError(
            f"{folder}: cannot be written ({error.strerror}); keep the library in another folder (library=, --library)"
        ) from error
    file = folder / "library.sqlite"
    with ExitStack() as stack:
        stack.enter_context(write_lock(folder))
        connection = schema.connect(file, writable=True)
        stack.callback(connection.close)
        try:
            schema.migrate(connection)
            digests.keep(connection)
            writer = Writer(folder, connection)
            writer.recover_marks()
            yield writer
            marks_file.update(folder, connection)
        except sqlite3.OperationalError as error:
            raise schema.not_written(file, error) from error
