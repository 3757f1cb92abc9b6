"""Writing files: beside their place and renamed, so that one that is there is replaced whole or not at all."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from encoders.errors import MotionSeekError


@contextmanager
def replacing(out: Path) -> Iterator[IO[bytes]]:
    """A file that takes the place of `out` once it is whole.

    Raises
    ------
    MotionSeekError
        If the system cannot write it; then `out` is as it was.
    """
    try:
        with _replacing(out) as file:
            yield file
    except OSError as error:
        kept = "; the file of that name is unchanged" if os.path.lexists(out) else ""
        raise MotionSeekError(f"{out}: cannot be written ({error.strerror or error}){kept}{_advice(error)}") from error


def write_text(out: Path, text: str) -> None:
    """Write a text file, as UTF-8, in the same way."""
    with replacing(out) as file:
        file.write(text.encode())


def _advice(error: OSError) -> str:
    return "; free some space, or write to another disk" if error.errno in _FULL else ""


_FULL = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)}


@contextmanager
def _replacing(out: Path) -> Iterator[IO[bytes]]:
    place = Path(os.path.realpath(out))  # through a link, so that the link stays one
    handle, name = tempfile.mkstemp(dir=place.parent, prefix=f".{place.name[:40]}.")
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, place)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
