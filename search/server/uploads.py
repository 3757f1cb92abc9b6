"""Uploads: a file is received under limits, read in a process that can be killed, and kept in memory for a while."""

from __future__ import annotations

import secrets
import tempfile
import threading
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO

import anyio
from anyio.to_thread import run_sync
from starlette.requests import ClientDisconnect, Request

from indexer.formats.table import READABLE
from indexer.ingest import pool
from search.server.exception_handlers import BUSY, Refused
from search.server.sandboxed_reader import READ
from search.source import MotionSource


@dataclass(frozen=True)
class UploadLimits:
    """What an upload may cost.

    Attributes
    ----------
    bytes : int
    seconds : float
        For the file to arrive.
    patience : float
        Seconds for it to be read, and two more for each MB.
    at_once : int
        UploadStore in the works.
    kept : int
        UploadStore that are remembered.
    kept_bytes : int
        Memory for them.
    """

    bytes: int = 64 << 20
    seconds: float = 60.0
    patience: float = 15.0
    at_once: int = 2
    kept: int = 32
    kept_bytes: int = 256 << 20


@dataclass(frozen=True)
class Upload:
    """An uploaded motion, what it is called from then on, and its kind of file and skeleton."""

    key: str
    source: MotionSource
    format: str
    rig: str


class UploadStore:
    """The uploads of a server."""

    def __init__(self, limits: UploadLimits | None = None) -> None:
        self._limits = limits or UploadLimits()
        self._held: OrderedDict[str, Upload] = OrderedDict()
        self._lock = threading.Lock()
        self._running = 0
        self.refused = 0

    def get(self, key: str) -> Upload | None:
        """An upload that is still remembered."""
        with self._lock:
            if key in self._held:
                self._held.move_to_end(key)
            return self._held.get(key)

    async def receive(self, request: Request, name: str) -> Upload:
        """Take in the body of a request as a motion file called `name`.

        Raises
        ------
        Refused
            413 too large, 408 too slow, 422 no motion that can be read, 503 too many at once.
        """
        ending = PurePosixPath(name.lower()).suffix
        try:
            with self._slot(), tempfile.TemporaryDirectory(prefix="motionseek-") as folder:
                # The client's name goes no further than its ending, and that only where it is a known one.
                path = Path(folder) / f"upload{ending if ending in READABLE else ''}"
                await self._save(request, path)
                return await run_sync(self._read, path, name)
        except Refused:
            self.refused += 1
            raise

    @contextmanager
    def _slot(self) -> Iterator[None]:
        """One of the uploads in the works."""
        if self._running >= self._limits.at_once:
            raise Refused(503, BUSY)
        self._running += 1
        try:
            yield
        finally:
            self._running -= 1

    async def _save(self, request: Request, path: Path) -> None:
        too_large = Refused(413, f"the file is larger than {self._limits.bytes >> 20} MB; cut it into takes")
        announced = request.headers.get("content-length", "")
        if announced.isdecimal() and int(announced) > self._limits.bytes:
            raise too_large
        try:
            with path.open("xb") as file, anyio.fail_after(self._limits.seconds):
                await _write(request, file, self._limits.bytes, too_large)
        except TimeoutError:
            raise Refused(408, f"the file did not arrive within {self._limits.seconds:g} s") from None
        except ClientDisconnect:
            raise Refused(400, "the upload was broken off") from None

    def _read(self, path: Path, name: str) -> Upload:
        request = pool.Request(None, path)
        _, read = next(iter(pool.read_all([request], 1, patience=self._limits.patience, target=READ)))
        if read.motion is None:
            raise Refused(422, f"{name}: {read.reason}")
        source = MotionSource.of_motion(read.motion, name)
        upload = Upload(f"u{secrets.token_hex(16)}", source, path.suffix.removeprefix("."), read.rig)
        self._keep(upload)
        return upload

    def _keep(self, upload: Upload) -> None:
        with self._lock:
            self._held[upload.key] = upload
            while len(self._held) > 1 and (
                len(self._held) > self._limits.kept or self._held_bytes() > self._limits.kept_bytes
            ):
                self._held.popitem(last=False)

    def _held_bytes(self) -> int:
        return sum(upload.source.motion.joints.nbytes for upload in self._held.values())


async def _write(request: Request, file: IO[bytes], most: int, too_large: Refused) -> None:
    size = 0
    async for chunk in request.stream():
        size += len(chunk)
        if size > most:
            raise too_large
        file.write(chunk)
