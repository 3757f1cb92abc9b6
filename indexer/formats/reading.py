"""A file of any format becomes Takes; one of several is named as `file#name`."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike, fspath
from os.path import exists
from pathlib import Path

import numpy as np

from encoders.errors import UnreadableMotion
from indexer.formats import table
from indexer.formats.mending import mended
from indexer.formats.opening import is_file, open_file, read_bytes
from indexer.part_names import splits
from indexer.take import Take


@np.errstate(over="ignore", invalid="ignore")  # absurd values overflow to positions that are refused as not finite
def read_takes(path: str | PathLike[str], *, fps: float | None = None) -> list[Take]:
    """Read all takes of a motion file, at least one; where there are several, their names differ.

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
    data = read_bytes(path)
    row = table.detect(path, data)
    takes = row.read(path, data, fps=fps)
    takes = [take if take.fps is not None else replace(take, fps=row.default_fps) for take in takes]
    return [mended(path, take) for take in takes]


def read_take(path: str | PathLike[str], *, fps: float | None = None) -> Take:
    """Read the one take of a motion file, or the one of several that `file#name` names; see `read_takes`.

    Raises
    ------
    UnreadableMotion
        Also where the file holds several and none is named, or none of that name.
    """
    file, name = split_name(path)
    takes = read_takes(file, fps=fps)
    if not name and len(takes) == 1:
        return takes[0]
    for take in takes:
        if take.name == name:
            return take
    names = ", ".join(f"{file.name}#{take.name}" for take in takes if take.name)
    raise UnreadableMotion(file, f"it holds no take {name!r}" if not names else f"it holds several takes: {names}")


def split_name(path: str | PathLike[str]) -> tuple[Path, str]:
    """A path as a file and the name of a take in it; the name is empty where there is such a file, or no `#`."""
    whole = fspath(path)
    if exists(whole) or is_file(Path(whole)):
        return Path(whole), ""
    return next(((Path(file), name) for file, name in splits(whole) if is_file(Path(file))), (Path(whole), ""))


def is_of_format(path: Path, ending: str) -> bool:
    """Whether a file that exists is of the format with an ending, by its content."""
    try:
        with open_file(path) as file:
            return table.detect(path, file.read(table.COMPANION_START)).ending == ending
    except (OSError, UnreadableMotion):
        return False
