"""Readers: a file becomes a Take. The content decides which reader, then the ending."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path

from encoders.errors import UnreadableMotion
from indexer.readers import bvh
from indexer.readers.take import Take

READABLE = {".bvh": bvh.DESCRIPTION}


def read_take(path: str | PathLike[str], *, fps: float | None = None) -> Take:
    """Read any motion file that can be read."""
    path = Path(fspath(path))
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UnreadableMotion(path, error.strerror or str(error)) from None
    if not data.lstrip(b"\xef\xbb\xbf \t\r\n")[:9].lower().startswith(b"hierarchy"):
        raise UnreadableMotion(path, f"not a motion file that can be read ({', '.join(READABLE)})")
    return bvh.read(path, data, fps=fps)
