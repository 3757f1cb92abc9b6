"""A file of any format becomes Takes; a part of it is named as `file#name`."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike, fspath
from os.path import exists, join, split
from pathlib import Path
from unicodedata import normalize

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


def split_name(path: str | PathLike[str]) -> tuple[Path, str]:
    """A path as a file and the name of a part of it; the name is empty where there is such a file, or no `#`.

    Names are compared in Unicode's composed and decomposed forms, as files from a Mac have the latter.
    """
    whole = fspath(path)
    for file, name in ((whole, ""), *splits(whole)):
        for spelt in _spellings(file):
            if is_file(Path(spelt)) or (not name and exists(spelt)):
                return Path(spelt), name
    return Path(whole), ""


def _spellings(path: str) -> list[str]:
    """A path as it is, and in other forms of Unicode: all of it, and its last name alone."""
    if path.isascii():
        return [path]
    folder, name = split(path)
    wholes = [normalize(form, path) for form in ("NFC", "NFD")]
    names = [join(folder, normalize(form, name)) for form in ("NFC", "NFD")]
    return list(dict.fromkeys([path, *wholes, *names]))


def is_of_format(path: Path, ending: str) -> bool:
    """Whether a file that exists is of the format with an ending, by its content."""
    try:
        with open_file(path) as file:
            return table.detect(path, file.read(table.COMPANION_START)).ending == ending
    except (OSError, UnreadableMotion):
        return False
