"""Uploads: a file is received under limits, read in a process that can be killed, and kept in memory for a while."""

from __future__ import annotations

import re
import secrets
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import IO, Any

import anyio
from anyio.to_thread import run_sync
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

from indexer.formats.table import READABLE
from indexer.ingest import pool
from indexer.part_names import with_part
from indexer.read_motion import ReadMotion
from indexer.store.marks.marks_table import NO_MARKS
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

    def document(self) -> dict[str, Any]:
        """Its metadata as JSON content, with the keys of a clip's."""
        motion, path = self.source.motion, self.source.path
        return {
            "clip": self.key,
            "root": None,
            "path": path,
            "name": PurePosixPath(path).stem,
            "duration": round(motion.duration, 3),
            "fps": motion.fps,
            "frames": len(motion),
            "format": self.format,
            "rig": self.rig,
            "added": "",
            **self.source.reading.document(),
            "captions": [],
            **NO_MARKS.document(),
        }


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
        """Receive and read the body of a request as a motion file called `name`; the first motion in it.

        Raises
        ------
        HTTPException
            400 connection closed, 408 timed out, 413 too large, 422 no readable motion, 503 too many at once.
        """
        return (await self.receive_files(request, [(name, None)]))[0]

    async def receive_files(self, request: Request, files: Sequence[tuple[str, int | None]]) -> list[Upload]:
        """Receive a motion file and the files it needs, one behind the other in the body, and read all motions in it.

        Parameters
        ----------
        files : sequence of (str, int or None)
            Names and sizes in bytes, the motion first; None for all that is left.

        Raises
        ------
        HTTPException
            As `receive`; 422 also where the body is shorter than the files.
        """
        try:
            with tempfile.TemporaryDirectory(prefix="motionseek-") as folder:
                paths = _safe_paths(Path(folder), [name for name, _ in files])
                await self._save(request, [(path, size) for path, (_, size) in zip(paths, files, strict=True)])
                with self._slot():
                    return await run_sync(self._read, paths[0], files[0][0])
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

    async def _save(self, request: Request, files: Sequence[tuple[Path, int | None]]) -> None:
        too_large = HTTPException(413, f"the file is larger than {self._limits.bytes >> 20} MB; cut it into takes")
        announced = request.headers.get("content-length", "")
        if announced.isdecimal() and int(announced) > self._limits.bytes:
            raise too_large
        try:
            with anyio.fail_after(self._limits.seconds):
                await self._write(request, files, too_large)
        except TimeoutError:
            raise HTTPException(408, f"the file was not received within {self._limits.seconds:g} s") from None
        except ClientDisconnect:
            raise HTTPException(400, "the connection was closed before the file was complete") from None

    async def _write(
        self, request: Request, files: Sequence[tuple[Path, int | None]], too_large: HTTPException
    ) -> None:
        size = 0
        with ExitStack() as stack:
            opened: list[tuple[IO[bytes], int | None]] = [
                (stack.enter_context(path.open("xb")), left) for path, left in files
            ]
            stack.callback(lambda: self._forget(size))
            async for chunk in request.stream():
                size += len(chunk)
                self._received += len(chunk)
                if size > self._limits.bytes:
                    raise too_large
                if self._received > self._limits.receiving_bytes:
                    raise HTTPException(503, BUSY)
                opened = _distribute(chunk, opened)
        if any(left for _, left in opened):
            raise HTTPException(422, "size: the files are shorter than announced")

    def _forget(self, size: int) -> None:
        self._received -= size

    def _read(self, path: Path, name: str) -> list[Upload]:
        request = pool.Request(None, path)
        _, read = next(iter(pool.read_all([request], 1, patience=self._limits.patience, target=READ)))
        if not read.clips:
            raise HTTPException(422, f"{name}: {read.reason.replace(str(path), name)}")
        return [self._keep(clip, name, path.suffix.removeprefix(".")) for clip in read.clips[: self._limits.kept]]

    def _keep(self, clip: ReadMotion, name: str, format: str) -> Upload:
        source = replace(MotionSource.of_motion(clip.motion, with_part(name, clip.part)), reading=clip.reading)
        upload = Upload(f"u{secrets.token_hex(16)}", source, format, clip.rig)
        self._uploads.put(upload.key, upload)
        return upload


def _safe_paths(folder: Path, names: Sequence[str]) -> list[Path]:
    """Paths in a folder for files of a client: the motion's ending is a known one, and no name leads elsewhere.

    Raises
    ------
    HTTPException
        422 if two files have one name.
    """
    plain = [re.sub(r"[^\w .()+#-]", "_", re.split(r"[/\\]", name)[-1])[-200:].lstrip(".") for name in names]
    stem, ending = PurePosixPath(plain[0]).stem, PurePosixPath(plain[0].lower()).suffix
    plain[0] = f"{stem or 'upload'}{ending if ending in READABLE else ''}"
    if len({name.lower() for name in plain}) < len(plain) or not all(plain):
        raise HTTPException(422, "name: each file needs a name of its own")
    return [folder / name for name in plain]


def _distribute(chunk: bytes, files: list[tuple[IO[bytes], int | None]]) -> list[tuple[IO[bytes], int | None]]:
    """Write a chunk to the first files that lack bytes; the files that still do.

    Raises
    ------
    HTTPException
        422 if bytes are left over.
    """
    while chunk:
        if not files:
            raise HTTPException(422, "size: the files are longer than announced")
        file, left = files[0]
        part = chunk if left is None else chunk[:left]
        file.write(part)
        chunk = chunk[len(part) :]
        if left is None:
            return files
        files = [(file, left - len(part)), *files[1:]] if left > len(part) else files[1:]
    return files
