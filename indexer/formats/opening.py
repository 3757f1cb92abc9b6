"""Opening the files that motions are read from: a motion itself, and what lies beside it."""

from __future__ import annotations

from pathlib import Path

from encoders.errors import UnreadableMotion
from indexer.formats.decoding import decoded

MAX_BYTES = 4 << 30


def read_bytes(path: Path, *, max_bytes: int = MAX_BYTES, as_it_is: bool = False) -> bytes:
    """The content of a file, without gzip and in UTF-8 if it is text, unless wanted as it is.

    Raises
    ------
    UnreadableMotion
        If it cannot be read, is empty, no regular file, larger than `max_bytes`, or its compression is damaged.
    """
    try:
        if path.is_dir():
            raise UnreadableMotion(path, "this is a folder, not a file")
        if path.exists() and not path.is_file():
            raise UnreadableMotion(path, "this is no regular file")
        if path.stat().st_size > max_bytes:
            raise UnreadableMotion(path, f"the file is larger than {max_bytes / (1 << 30):.2g} GB; cut it into takes")
        data = path.read_bytes() if as_it_is else decoded(path, path.read_bytes())
    except (OSError, ValueError) as error:
        raise UnreadableMotion(path, getattr(error, "strerror", None) or str(error)) from None
    if not data.strip():
        raise UnreadableMotion(path, "the file is empty")
    return data
