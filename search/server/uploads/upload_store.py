"""Uploads: a file is received under limits, read in a process that can be killed, and kept in memory for a while."""

from __future__ import annotations

import secrets
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import IO

import anyio
from anyio.to_thread import run_sync
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

from indexer.formats.table import READABLE
from indexer.ingest import pool
from search.server.exception_handlers import BUSY
from search.server.lru_cache import LruCache
from search.server.uploads.sandboxed_reader import READ
from search.source import MotionSource


@dataclass(frozen=True)
class UploadLimits:
    """Resource limits of uploads.

    Attributes
    ----------
    bytes : int
        Size of a file.
    seconds : float
        Time to receive it.
    patience : float
        Time to read it in seconds, plus two seconds a MB.
    at_once : int
        Uploads read at the same time.
    receiving_bytes : int
        Disk space of all uploads that are being received: those that send nothing shut nobody out.
    kept : int
        Uploads kept in memory.
    kept_bytes : int
        Memory for them.
    """

    bytes: int = 64 << 20
    seconds: float = 60.0
    patience: float = 15.0
    at_once: int = 2
    receiving_bytes: int = 512 << 20
    kept: int = 32
    kept_bytes: int = 256 << 20


@dataclass(frozen=True)
class Upload:
    """An uploaded motion: the key that names it in requests, its file format and its rig."""

    key: str
    source: MotionSource
    format: str
    rig: str


class UploadStore:
    """The uploads of a server; the least recently used are evicted."""

    def __init__(self, limits: UploadLimits | None = None) -> None:
        self._limits = limits or UploadLimits()
        share = self._limits.kept_bytes / self._limits.kept  # an upload counts for at least its share
        self._uploads: LruCache[Upload] = LruCache(
            self._limits.kept_bytes, weight=lambda upload: max(upload.source.motion.joints.nbytes, share)
        )
        self._running = 0
        self._received = 0
        self.rejected = 0

    def get(self, key: str) -> Upload | None:
        """An upload that is still kept, else None."""
        return self._uploads.get(key)

    async def receive(self, request: Request, name: str) -> Upload:
        """Receive and read the body of a request as a motion file called `name`.

        Raises
        ------
        HTTPException
            400 connection closed, 408 timed out, 413 too large, 422 no readable motion, 503 too many at once.
        """
        ending = PurePosixPath(name.lower()).suffix
        try:
            with tempfile.TemporaryDirectory(prefix="motionseek-") as folder:
                # Of the client's file name only a known ending is used.
                path = Path(folder) / f"upload{ending if ending in READABLE else ''}"
                await self._save(request, path)
                with self._slot():
                    return await run_sync(self._read, path, name)
        except HTTPException:
            self.rejected += 1
            raise

    @contextmanager
    def _slot(self) -> Iterator[None]:
        if self._running >= self._limits.at_once:
            raise HTTPException(503, BUSY)
        self._running += 1
        try:
            yield
        finally:
            self._running -= 1

    async def _save(self, request: Request, path: Path) -> None:
        too_large = HTTPException(413, f"the file is larger than {self._limits.bytes >> 20} MB; cut it into takes")
        announced = request.headers.get("content-length", "")
        if announced.isdecimal() and int(announced) > self._limits.bytes:
            raise too_large
        try:
            with path.open("xb") as file, anyio.fail_after(self._limits.seconds):
                await self._write(request, file, too_large)
        except TimeoutError:
            raise HTTPException(408, f"the file was not received within {self._limits.seconds:g} s") from None
        except ClientDisconnect:
            raise HTTPException(400, "the connection was closed before the file was complete") from None

    async def _write(self, request: Request, file: IO[bytes], too_large: HTTPException) -> None:
        size = 0
        try:
            async for chunk in request.stream():
                size += len(chunk)
                self._received += len(chunk)
                if size > self._limits.bytes:
                    raise too_large
                if self._received > self._limits.receiving_bytes:
                    raise HTTPException(503, BUSY)
                file.write(chunk)
        finally:
            self._received -= size

    def _read(self, path: Path, name: str) -> Upload:
        request = pool.Request(None, path)
        _, read = next(iter(pool.read_all([request], 1, patience=self._limits.patience, target=READ)))
        if not read.clips:
            raise HTTPException(422, f"{name}: {read.reason.replace(str(path), name)}")
        clip = read.clips[0]
        source = replace(MotionSource.of_motion(clip.motion, name), reading=clip.reading)
        upload = Upload(f"u{secrets.token_hex(16)}", source, path.suffix.removeprefix("."), clip.rig)
        self._uploads.put(upload.key, upload)
        return upload
