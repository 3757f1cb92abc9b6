"""Locating the library of a command."""

from __future__ import annotations

import os
from pathlib import Path

from encoders.errors import LibraryNotFound

FOLDER = ".motionseek"
VARIABLE = "MOTIONSEEK_LIBRARY"


def locate(given: str | os.PathLike[str] | None = None, *, start: Path | None = None) -> Path:
    """The library's folder: `given`, else MOTIONSEEK_LIBRARY, else the folder at or above `start` with a `.motionseek`.

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
        if (folder / FOLDER).is_dir():
            return folder
    raise LibraryNotFound(
        f"no library in {here} or its parent folders; create one with 'motionseek index FOLDER', "
        f"or give one with --library or {VARIABLE}"
    )
