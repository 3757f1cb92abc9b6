"""The stacks of a library that is served, found in a thread of their own, again whenever the library has changed."""

from __future__ import annotations

import threading

from encoders.errors import MotionSeekError, QueryError
from indexer.store.stored_library import StoredLibrary
from search.stacks.stacking import Copy, stacks


class BackgroundStacks:
    """Finds stacks when they are asked for; until they are there, tells how far it is."""

    def __init__(self, library: StoredLibrary) -> None:
        self._library = library
        self._lock = threading.Lock()
        self._found: tuple[int, list[tuple[Copy, ...]]] | None = None
        self._running: threading.Thread | None = None
        self._share = 0.0

    @property
    def progress(self) -> float:
        """The share that is done, 0 to 1."""
        return self._share

    def get(self, generation: int) -> list[tuple[Copy, ...]] | None:
        """The stacks of a generation of the library; None where they are being found."""
        with self._lock:
            if self._found is not None and self._found[0] == generation:
                return self._found[1]
            if self._running is None or not self._running.is_alive():
                self._share = 0.0
                self._running = threading.Thread(target=self._find, args=(generation,), daemon=True, name="stacks")
                self._running.start()
        return None

    def wait(self) -> None:
        """Wait for what is being found."""
        if self._running is not None:
            self._running.join()

    def _find(self, generation: int) -> None:
        def progress(done: int, total: int) -> None:
            self._share = done / total

        try:
            found = stacks(self._library, progress)
        except QueryError:  # a library that has none to be found
            found = []
        except MotionSeekError:  # closed or removed meanwhile: asked for again, it is tried again
            return
        self._found = generation, found
