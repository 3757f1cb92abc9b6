"""Locating the library of a command."""

from __future__ import annotations

import os
from pathlib import Path

from encoders.errors import LibraryNotFound

FOLDER, FILE = ".motionseek", "library.sqlite"
VARIABLE = "MOTIONSEEK_LIBRARY"


def locate(given: str | os.PathLike[str] | None = None, *, start: Path | None = None) -> Path:
    """The library's folder: `given`, else MOTIONSEEK_LIBRARY, else the nearest at or above `start`.

    That is a folder with a `.motionseek`, or one that is a library itself.

    Raises
    ------
    LibraryNotFound
        If there is none.
    """
    named = given or os.environ.get(VARIABLE)
    if named:
        return Path(named)
    here = (start or Path.cwd()).resolve()
    for folder in (here, *here.parents):
        if (folder / FOLDER).is_dir() or (folder / FILE).is_file():
            return folder
    raise LibraryNotFound(
        f"no library in {here} or its parent folders; create one with 'motionseek index FOLDER', "
        f"or give one with --library or {VARIABLE}"
    )
