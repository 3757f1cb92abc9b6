"""The map of a library, laid out in the background: at low priority, with progress, once for each generation."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from typing import Any

from search.map import map_file
from search.map.layout import make_map
from search.query.vocabulary import vocabulary
from search.server.responses import to_json
from search.server.snapshot_library import Snapshot, SnapshotLibrary

#: Nice value of the thread: those who search come first.
_NICE = 10


class MapJob:
    """Lays out the map of a snapshot in a thread of its own."""

    def __init__(self, library: SnapshotLibrary, snapshot: Snapshot) -> None:
        self.generation = snapshot.generation
        self.count = snapshot.count
        self.progress = 0.0
        self._document: bytes | None = None
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._run, args=(library, snapshot), daemon=True, name="map")
        self._thread.start()

    def wait(self, seconds: float) -> bytes | None:
        """The map as JSON, None where it takes longer than so many seconds.

        Raises
        ------
        Exception
            What laying out raised.
        """
        self._thread.join(seconds)
        if self._error is not None:
            raise self._error
        return self._document

    @property
    def failed(self) -> bool:
        """Whether it ended without a map."""
        return self._error is not None

    def status(self) -> dict[str, Any]:
        """How far it is, as JSON content."""
        return {"generation": self.generation, "count": self.count, "progress": round(self.progress, 3)}

    def _run(self, library: SnapshotLibrary, snapshot: Snapshot) -> None:
        with suppress(AttributeError, OSError):  # on Linux each thread has its own
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICE)
        try:
            self._document = self._made(library, snapshot)
        except Exception as error:
            self._error = error

    def _made(self, library: SnapshotLibrary, snapshot: Snapshot) -> bytes:
        folder = library.folder / "previews"
        library_map = map_file.load(folder, snapshot.generation)
        if library_map is None:
            rows, texts = snapshot.clips.rows, vocabulary()
            text_vectors = library.bundle.encode_texts(list(texts))
            vectors = rows.vectors.astype("float32")
            library_map = make_map(
                snapshot.generation, rows.owners, vectors, texts, text_vectors, progress=self._proceed
            )
            map_file.save(folder, library_map)
        return to_json(library_map.document())

    def _proceed(self, part: float) -> None:
        self.progress = part


class MapJobs:
    """The map of the newest generation that was asked for."""

    def __init__(self, library: SnapshotLibrary) -> None:
        self._library = library
        self._lock = threading.Lock()
        self._job: MapJob | None = None

    def current(self) -> MapJob:
        """The job of the present snapshot; started where there is none, or where it failed."""
        snapshot = self._library.snapshot
        with self._lock:
            if self._job is None or self._job.generation != snapshot.generation or self._job.failed:
                self._job = MapJob(self._library, snapshot)
            return self._job
