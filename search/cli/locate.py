"""Locating the library of a command."""

from __future__ import annotations

import os
from pathlib import Path

from encoders.errors import LibraryNotFound
from indexer.vectors.milvus.milvus_address import is_milvus_address

FOLDER, FILE = ".motionseek", "library.sqlite"
VARIABLE = "MOTIONSEEK_LIBRARY"
#: Where the poses of a collection of Milvus are.
POSES_VARIABLE = "MOTIONSEEK_POSES"


def locate(given: str | os.PathLike[str] | None = None, *, start: Path | None = None) -> str | Path:
    """The library's folder, or its address in Milvus: `given`, else MOTIONSEEK_LIBRARY, else a folder.

    That is the nearest at or above `start` with a `.motionseek`, or one that is a library itself.

    Raises
    ------
    LibraryNotFound
        If there is none.
    """
    named = given or os.environ.get(VARIABLE)
    if named:
        return str(named) if is_milvus_address(named) else Path(named)
    here = (start or Path.cwd()).resolve()
    for folder in (here, *here.parents):
        if (folder / FOLDER).is_dir() or (folder / FILE).is_file():
            return folder
    raise LibraryNotFound(
        f"no library in {here} or its parent folders; create one with 'motionseek index FOLDER', "
        f"or give one with --library or {VARIABLE}"
    )


def poses_of(place: str | os.PathLike[str]) -> str | None:
    """Where the poses of a library are that is a collection of Milvus; None where none are, or it has its own."""
    return os.environ.get(POSES_VARIABLE) if is_milvus_address(place) else None
