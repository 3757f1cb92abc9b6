"""The library on disk, as its readers see it: clips, poses, captions, vectors."""

from __future__ import annotations

import sqlite3
import threading
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_flag, checked_path, optional_number
from encoders.bundle.windows import Windows
from encoders.errors import (
    BundleMismatch,
    LibraryDamaged,
    LibraryError,
    LibraryNotFound,
    QueryError,
)
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from indexer.argument_checks import checked_clip_id, checked_encoder
from indexer.read_motion import extent
from indexer.store import captions, poses, schema
from indexer.store.clip_finder import ClipFinder, storable_id
from indexer.store.clips import Caption
from indexer.store.library_reader import FILE, FileId, library_folder, one_snapshot
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import NO_MARKS, Marks
from indexer.store.stats import stats
from indexer.vectors.blocks import IndexRows
from indexer.vectors.library_indexes import CLIPS, WINDOWS, LibraryIndexes

if TYPE_CHECKING:
    from typing_extensions import Self


CaptionVectors = tuple[list[str], NDArray[np.int64], NDArray[np.float32]]

#: Held while a library is made, so that no other thread opens it half made.
_creating = threading.Lock()


class StoredLibrary(ClipFinder):
    """A library as it lies on disk. Safe to share between threads; what others write is seen at the next call."""

    def __init__(self, folder: Path, *, bundle: Encoder | None = None) -> None:
        super().__init__(folder)
        self._bundle = bundle
        self._captions: tuple[tuple[FileId, int], CaptionVectors] | None = None
        self.indexes = LibraryIndexes(folder / "vectors")
        if bundle is not None:
            self._check(bundle)

    @classmethod
    def open(cls, folder: str | PathLike[str], *, bundle: Encoder | None = None, create: bool = False) -> Self:
        """Open the library of an indexed folder, or a library folder itself.

        Parameters
        ----------
        folder : path
        bundle : Encoder, optional
            The model; if not given, that of the library is found where models are kept when it is first needed.
        create : bool
            Make `folder` itself an empty library folder where it is none yet.

        Raises
        ------
        ArgumentError
            If an argument is of a wrong type.
        LibraryNotFound
            If there is no library.
        LibraryDamaged, LibraryError
            If it cannot be read.
        BundleMismatch
            If `bundle` is not the model whose vectors the library holds.
        """
        given, bundle = checked_path("folder", folder), checked_encoder(bundle)
        with _creating:
            place = library_folder(given)
            if checked_flag("create", create) and place is None:
                place = _create(given)
        if place is None:
            raise LibraryNotFound(
                f"{given}: no library here; make one with motionseek.index or 'motionseek index {given}'"
            )
        return cls(place.resolve(), bundle=bundle)

    @property
    def bundle(self) -> Encoder:
        """The model: the one that was given, else the one that the library was made with, wherever it is kept.

        Raises
        ------
        BundleMismatch
            If that is neither the shipped one nor among those that `encoders.bundle.known_models` knows.
        """
        if self._bundle is None:
            self._bundle = self._own_model()
        return self._bundle

    def _own_model(self) -> Encoder:
        from encoders.bundle.known_models import load_model, model_with

        with self.reading():
            model = self._model()
        if model is None:
            return load_model()
        found = model_with(model["fingerprint"], model["name"])
        if found is None:
            raise BundleMismatch(
                f"{self.folder}: made with the model {model['name']} ({model['fingerprint'][:12]}), which is not here "
                "('motionseek model list'); import it again, or index the library again with another model, "
                "rebuild=True (--rebuild)"
            )
        return found

    def _check(self, bundle: Encoder) -> None:
        model = self._model()
        if model is not None and model["fingerprint"] != bundle.fingerprint:
            raise BundleMismatch(
                f"{self.folder}: made with the model {model['name']} ({model['fingerprint'][:12]}), not with "
                f"{bundle.name} ({bundle.fingerprint[:12]}); index it again with rebuild=True (--rebuild)"
            )

    def _model(self) -> dict[str, Any] | None:
        return _one(
            self.connection,
            "SELECT models.* FROM models JOIN settings ON settings.key = 'model' AND settings.value = models.id",
        )

    @property
    def captions_generation(self) -> int:
        """The generation in which a caption of a clip that was there before last changed; 0 if none ever has."""
        return captions.generation(self.connection)

    @one_snapshot
    def motion(self, id: int, start: float | None = None, end: float | None = None) -> Motion:
        """The clip's motion, or a span of it in seconds of its file, out of the stored poses.

        Raises
        ------
        UnknownClip
            If there is no such clip.
        LibraryDamaged
            If its stored poses are corrupt or incomplete.
        QueryError
            If the span is empty or begins after the clip ends; `ArgumentError` if `start` or `end` is no number.
        """
        clip = self.clip(id)
        start, end = optional_number("start", start), optional_number("end", end)
        start = max((start or 0.0) - clip.start, 0.0)
        end = clip.duration if end is None else min(end - clip.start, clip.duration)
        if start >= end:
            raise QueryError(
                f"{clip.path}: span {start + clip.start:g} to {end + clip.start:g} s lies outside its "
                f"{extent(clip.start, clip.duration)}; give a start and end inside it, in seconds"
            )
        first = min(round(start * FPS), clip.frames - 1)
        last = max(round(end * FPS), first + 1)
        joints = [*map(poses.unpack, self.pose_chunks(clip.id, first // poses.CHUNK, (last - 1) // poses.CHUNK))]
        skipped = first // poses.CHUNK * poses.CHUNK
        if sum(map(len, joints)) < last - skipped:
            raise LibraryDamaged(
                f"{clip.path}: stored poses are incomplete; motionseek check --repair reads the file again"
            )
        return Motion(np.concatenate(joints)[first - skipped : last - skipped], FPS)

    def pose_chunks(self, id: int, first: int, last: int) -> list[bytes]:
        """The stored poses of a clip from one chunk to another; see `indexer.store.poses`."""
        rows = self.connection.execute(
            "SELECT data FROM poses WHERE clip_id = ? AND chunk BETWEEN ? AND ? ORDER BY chunk", (id, first, last)
        )
        return [data for (data,) in rows]

    @one_snapshot
    def captions(self, id: int) -> list[Caption]:
        """The captions of a clip, in the order in which they were read.

        Raises
        ------
        UnknownClip
            If there is no such clip.
        """
        rows = self.connection.execute(
            "SELECT texts.text, captions.start, captions.end FROM captions JOIN texts ON texts.id = captions.text_id "
            "JOIN clips ON clips.id = captions.clip_id "
            "JOIN files ON files.id = clips.file_id AND files.state = 'indexed' "
            "WHERE captions.clip_id = ? ORDER BY captions.id",
            (storable_id(id),),
        ).fetchall()
        if not rows:
            self.clip(id)  # raises where there is none
        return list(dict.fromkeys(Caption(*row) for row in rows))

    @property
    def marks_generation(self) -> int:
        """The generation in which a star, tag or collection last changed; 0 if none ever has."""
        return marks_table.generation(self.connection)

    def marks(self, id: int) -> Marks:
        """The star, tags and collections of a clip."""
        return marks_table.of_clips(self.connection, [checked_clip_id(id)]).get(id, NO_MARKS)

    @one_snapshot
    def caption_vectors(self) -> CaptionVectors:
        """Every caption of every clip: texts, clip ids (N,), unit vectors (N, D); not to be changed."""
        held, state = self._captions, self.state
        if held is None or held[0] != state:
            held = self._captions = state, self._read_caption_vectors()
        return held[1]

    def _read_caption_vectors(self) -> CaptionVectors:
        rows = self.connection.execute(
            "SELECT DISTINCT texts.text, captions.clip_id, text_embeddings.vector "
            "FROM captions JOIN clips ON clips.id = captions.clip_id "
            "JOIN files ON files.id = clips.file_id AND files.state = 'indexed' "
            "JOIN texts ON texts.id = captions.text_id "
            "JOIN text_embeddings ON text_embeddings.text_id = texts.id AND text_embeddings.model_id = "
            "(SELECT value FROM settings WHERE key = 'model')"
        ).fetchall()
        vectors = np.frombuffer(b"".join(row[2] for row in rows), np.float16)
        size = len(vectors) // len(rows) if rows else self._size()
        return (
            [row[0] for row in rows],
            np.array([row[1] for row in rows], np.int64),
            vectors.reshape(-1, size).astype(np.float32),
        )

    def _size(self) -> int:
        model = self._model()
        return self.bundle.latent_size if model is None else int(model["size"])

    def nearest_clips(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None, exact: bool = False
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The clips whose vectors are nearest to each query (Q, D): scores and clip ids, each (Q, k), best first.

        `allowed` are the sorted ids to choose from, None for all. Where there are fewer than k the id is -1. Unless the
        answer is to be `exact`, large libraries are searched by clusters, which miss a few.
        """
        with self.reading() as connection:
            return self.indexes.current(CLIPS, connection).search(queries, k, allowed=allowed, exact=exact)[:2]

    def nearest_windows(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None, exact: bool = False
    ) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]]:
        """The windows nearest to each query (Q, D): scores, clip ids, starts and ends, each (Q, k).

        Starts and ends are seconds of the motion; those of its file are `Clip.start` later.

        `allowed` are the sorted clip ids to choose from, None for all. Where there are fewer than k the id is -1. See
        `nearest_clips` of `exact`.
        """
        with self.reading() as connection:
            return self.indexes.current(WINDOWS, connection).search(queries, k, allowed=allowed, exact=exact)

    def vectors_of(self, ids: NDArray[np.int64]) -> tuple[IndexRows, IndexRows]:
        """The vectors of clips, of each as a whole, and of all their windows."""
        with self.reading() as connection:
            clips, windows = (self.indexes.current(kind, connection).rows_of(ids) for kind in (CLIPS, WINDOWS))
            return clips, windows

    def prepare(self) -> None:
        """Bring the vector indexes and their files up to date now rather than at the next query."""
        with self.reading() as connection:
            for kind in (CLIPS, WINDOWS):
                self.indexes.current(kind, connection)

    @one_snapshot
    def windows(self, id: int) -> list[Windows]:
        """The windows of a clip, shortest length first."""
        rows = self.connection.execute(
            "SELECT length, duration, starts, vectors FROM windows JOIN clips ON clips.id = clip_id "
            "JOIN files ON files.id = clips.file_id AND files.state = 'indexed' WHERE clip_id = ? AND model_id = "
            "(SELECT value FROM settings WHERE key = 'model') ORDER BY length",
            (storable_id(id),),
        ).fetchall()
        if not rows:
            self.clip(id)  # raises where there is none
        return [Windows.of(*row) for row in rows]

    @one_snapshot
    def failures(self) -> list[tuple[str, str]]:
        """Files that could not be read, with the reason, as of the last time each was tried."""
        roots = self._roots()
        rows = self.connection.execute("SELECT root_id, path, reason FROM files WHERE state = 'failed' ORDER BY path")
        return [(str(roots[root] / path), reason) for root, path, reason in rows]

    @one_snapshot
    def stats(self) -> dict[str, Any]:
        """What the library holds, in numbers; see `indexer.store.stats.stats`."""
        return stats(self.connection, self.folder, self.roots)


def _one(connection: sqlite3.Connection, query: str) -> dict[str, Any] | None:
    cursor = connection.execute(query)
    row = cursor.fetchone()
    return None if row is None else dict(zip([column[0] for column in cursor.description], row, strict=True))


def _create(folder: Path) -> Path:
    """Make `folder` an empty library."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with closing(schema.connect(folder / FILE, writable=True)) as connection:
            schema.migrate(connection)
    except (OSError, LibraryError) as error:
        raise LibraryError(
            f"{folder}: cannot be written ({error}); keep the library in another folder (library=, --library)"
        ) from error
    return folder
