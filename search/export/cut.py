"""A cut of a motion as a file: the source's own BVH lines, or the 22 joints."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import numpy as np

from encoders.arguments import checked_flag, checked_path
from encoders.errors import ArgumentError, MotionSeekError, QueryError
from encoders.motion import Motion
from indexer.formats.reading import is_of_format
from search.export import bvh_writer
from search.source import MotionSource


def write_cut(
    source: MotionSource, out: Path, start: float | None = None, end: float | None = None
) -> tuple[int, float]:
    """Write a motion, or its cut from `start` to `end` in seconds, in the format that the ending of `out` names.

    Returns
    -------
    frames : int
    fps : float
        Of what was written.

    Raises
    ------
    QueryError
        If the cut lies outside the motion, the ending names no format that can be written, or `out` is the source.
    """
    if source.file is not None and os.path.exists(out) and out.samefile(source.file):
        raise QueryError(f"{out} is the clip itself; name another file, its source would be lost")
    motion = source.cut(start, end)
    writer = WRITERS.get(out.suffix.lower())
    if writer is None:
        raise QueryError(f"{out}: can write {', '.join(WRITERS)}")
    if writer is _write_bvh and source.file is not None and is_of_format(source.file, ".bvh"):
        first = max(start or 0.0, 0.0)
        with replacing(out) as file:
            return bvh_writer.cut(source.file, file, first, first + motion.duration, duration=source.duration)
    with replacing(out) as file:
        writer(file, motion)
    return len(motion), motion.fps


def _write_bvh(file: IO[bytes], motion: Motion) -> None:
    bvh_writer.write(file, motion)


def _write_npz(file: IO[bytes], motion: Motion) -> None:
    np.savez_compressed(file, joints=motion.joints, fps=np.float64(motion.fps), up=np.array("y"))


def _write_npy(file: IO[bytes], motion: Motion) -> None:
    np.save(file, motion.joints)


#: Ending -> what writes it.
WRITERS: dict[str, Callable[[IO[bytes], Motion], None]] = {".bvh": _write_bvh, ".npz": _write_npz, ".npy": _write_npy}


def writable(out: str | os.PathLike[str], overwrite: bool) -> Path:
    """The path of a file to write.

    Raises
    ------
    ArgumentError
        If it is no path, its folder does not exist, or it exists and is not to be overwritten.
    """
    path, overwrite = checked_path("out", out), checked_flag("overwrite", overwrite)
    if not os.path.isdir(path.absolute().parent):
        raise ArgumentError(f"out={str(path)!r}: no folder {path.absolute().parent}; create it first")
    if os.path.isdir(path):
        raise ArgumentError(f"out={str(path)!r} is a folder; name a file in it")
    if os.path.exists(path) and not overwrite:
        raise ArgumentError(f"{path} exists; overwrite it with overwrite=True")
    return path


@contextmanager
def replacing(out: Path) -> Iterator[IO[bytes]]:
    """A file that takes the place of `out` once it is whole.

    Raises
    ------
    MotionSeekError
        If the system cannot write it.
    """
    try:
        with _replacing(out) as file:
            yield file
    except OSError as error:
        raise MotionSeekError(f"{out}: cannot be written ({error.strerror or error})") from error


@contextmanager
def _replacing(out: Path) -> Iterator[IO[bytes]]:
    handle, name = tempfile.mkstemp(dir=out.absolute().parent, prefix=f".{out.name[:40]}.")
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, out)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
