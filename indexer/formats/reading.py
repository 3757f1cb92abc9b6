"""A file of any format becomes a Take."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path

import numpy as np

from encoders.errors import UnreadableMotion
from indexer.formats import table
from indexer.take import Take

MAX_BYTES = 4 << 30


@np.errstate(over="ignore", invalid="ignore")  # absurd values overflow to positions that are refused as not finite
def read_take(path: str | PathLike[str], *, fps: float | None = None) -> Take:
    """Read a motion file.

    Parameters
    ----------
    path : path
        The file; for AMC its skeleton lies beside it.
    fps : float, optional
        Its true frame rate, where it states none or a wrong one; otherwise that of the file, or its format's default.

    Raises
    ------
    UnreadableMotion
        With the reason: no such file, a format that cannot be read, damaged, no frames, values that are not finite.
    """
    path = Path(fspath(path))
    if fps is not None and not 0 < fps < 1e5:
        raise UnreadableMotion(path, f"fps={fps:g} is no frame rate")
    data = _load(path)
    row = table.detect(path, data)
    take = row.read(path, data, fps=fps)
    return take if take.fps is not None else replace(take, fps=row.default_fps)


def is_of_format(path: Path, ending: str) -> bool:
    """Whether a file that exists is of the format with an ending, by its content."""
    try:
        with path.open("rb") as file:
            return table.detect(path, file.read(table.COMPANION_START)).ending == ending
    except (OSError, UnreadableMotion):
        return False


def _load(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise UnreadableMotion(path, "this is a folder, not a file")
        if path.exists() and not path.is_file():
            raise UnreadableMotion(path, "this is no regular file")
        if path.stat().st_size > MAX_BYTES:
            raise UnreadableMotion(path, f"the file is larger than {MAX_BYTES >> 30} GB; cut it into takes")
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        raise UnreadableMotion(path, getattr(error, "strerror", None) or str(error)) from None
    if not data.strip():
        raise UnreadableMotion(path, "the file is empty")
    return data
