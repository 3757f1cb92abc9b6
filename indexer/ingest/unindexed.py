"""A file that is no clip of a library, read as the library would read it: at the frame rate it was told of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from encoders.motion import Motion
from indexer.ingest import worker
from indexer.ingest.scan import SKELETONS, walk
from indexer.store.captions import stated_rate
from indexer.store.files import File
from indexer.store.read_options import ReadOptions
from indexer.store.stored_library import StoredLibrary

#: Formats that name no frame rate: what a library was told of others of their skeleton is the best guess there is.
_RATELESS = frozenset({".amc", ".npy"})


def read_as_known(library: StoredLibrary, path: Path, *, fps: float | None = None) -> Motion:
    """A file's motion, read as `recipe_of` says or, where the library knows nothing of it, as others of its skeleton.

    Parameters
    ----------
    fps : float, optional
        The file's true frame rate, over what the library knows.

    Raises
    ------
    UnreadableMotion
        If it holds no motion that can be read.
    """
    known = recipe_of(library, path)
    recipe = known or ReadOptions()
    motion, rig = worker.read(str(path), fps or recipe.fps, dict(recipe.joint_map) or None)
    if known is None and fps is None and path.suffix.lower() in _RATELESS:
        rate = _rate_of_rig(library, rig, path.suffix.lower().lstrip("."))
        if rate is not None:
            motion, _ = worker.read(str(path), rate, None)
    return motion


def recipe_of(library: StoredLibrary, path: Path) -> ReadOptions | None:
    """How a library reads a file, by its path or its content; None where it knows nothing of it.

    As in a run of the index, the rate that a captions table states goes before what was asked for. Files of one content
    that are read in different ways say nothing.
    """
    place = path.resolve()
    recipe, rate = None, None
    for key, root in _roots(library):
        if place.is_relative_to(root):
            named = (key, place.relative_to(root).as_posix())
            recipe = recipe or _only(library, "root_id = ? AND path = ? AND state != 'gone'", named)
            rate = rate or stated_rate(library.connection, *named)
    recipe = recipe or _of_content(library, place)
    return recipe if rate is None else replace(recipe or ReadOptions(), fps=rate)


def _roots(library: StoredLibrary) -> list[tuple[int, Path]]:
    rows = library.connection.execute("SELECT id, path FROM roots ORDER BY id")
    return [(key, (library.folder / path).resolve()) for key, path in rows]


def _of_content(library: StoredLibrary, place: Path) -> ReadOptions | None:
    try:
        file = _scanned(place)
        if library.connection.execute("SELECT 1 FROM files WHERE size = ? LIMIT 1", (file.size,)).fetchone() is None:
            return None
        return _only(library, "hash = ?", (file.hash(place.parent),))
    except OSError:  # the reader says it better
        return None


def _scanned(place: Path) -> File:
    """A file as a walk of its folder sees it: with the skeletons beside it, where it may need them."""
    if place.suffix.lower() in SKELETONS:
        beside = next(walk(place.parent, lambda _: None)).motions(SKELETONS)
        found = [file for file in beside if file.path == place.name]
        if found:
            return found[0]
    return File(place.name, place.stat().st_size, place.stat().st_mtime_ns)


def _only(library: StoredLibrary, condition: str, values: Sequence[Any]) -> ReadOptions | None:
    """The one recipe of the files that meet an SQL condition; None where there are none, or several."""
    rows = library.connection.execute(f"SELECT DISTINCT recipe FROM files WHERE {condition}", values).fetchall()
    recipes = {replace(ReadOptions.of(text), from_table=False, version=0) for (text,) in rows}
    return recipes.pop() if len(recipes) == 1 else None


def _rate_of_rig(library: StoredLibrary, rig: str, format: str) -> float | None:
    """The frame rate at which all clips of a rig and format were read, if they were told one and the same."""
    rows = library.connection.execute(
        "SELECT DISTINCT files.recipe FROM clips JOIN files ON files.id = clips.file_id "
        "WHERE files.state = 'indexed' AND clips.rig = ? AND clips.format = ?",
        (rig, format),
    )
    rates = {ReadOptions.of(text).fps for (text,) in rows}
    return rates.pop() if len(rates) == 1 else None
