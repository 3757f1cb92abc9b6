"""Laying out a map in the background: at low priority, with progress, once for each generation of a library."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from search.map.layout import Progress

#: Nice value of the thread: those who search come first.
_NICE = 10


class LayoutJob:
    """Makes the map of one generation in a thread of its own.

    Parameters
    ----------
    count : int
        Clips of the map.
    make : callable
        Given a function to report progress to, returns the map as JSON.
    """

    def __init__(self, generation: int, count: int, make: Callable[[Progress], bytes]) -> None:
        self.generation = generation
        self.count = count
        self.progress = 0.0
        self._document: bytes | None = None
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._run, args=(make,), daemon=True, name="map")
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

    def _run(self, make: Callable[[Progress], bytes]) -> None:
        with suppress(AttributeError, OSError):  # on Linux each thread has its own
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICE)
        try:
            self._document = make(self._proceed)
        except Exception as error:
            self._error = error

    def _proceed(self, part: float) -> None:
        self.progress = part


class LayoutJobs:
    """The job of the newest generation that was asked for."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._job: LayoutJob | None = None

    def of(self, generation: int, count: int, make: Callable[[Progress], bytes]) -> LayoutJob:
        """The job of a generation; started where there is none, or where it failed."""
        with self._lock:
            if self._job is None or self._job.generation != generation or self._job.failed:
                self._job = LayoutJob(generation, count, make)
            return self._job
