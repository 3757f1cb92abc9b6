"""Reading an unindexed file: as the library would read it, at the frame rate that is known for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from encoders.errors import UnreadableMotion
from indexer.argument_checks import checked_rate
from indexer.formats import table
from indexer.formats.opening import beside, state
from indexer.formats.reading import split_name
from indexer.ingest.scan import with_companions
from indexer.read_motion import ReadMotion
from indexer.store.captions import Stated, stated_option
from indexer.store.files import File
from indexer.store.read_options import ReadOptions
from indexer.store.stored_library import StoredLibrary

#: Digests of files that are remembered: a folder that was copied has another time on every one.
_DIGESTS = 4096


def read_unindexed(
    library: StoredLibrary, path: Path, *, fps: float | None = None, up: str | None = None
) -> ReadMotion:
    """The motion of a file that is no clip of the library, read with `known_options`.

    Where the library does not know the file and its format states no frame rate, the rate given for all clips of the
    same skeleton and format is the best guess.

    Parameters
    ----------
    path : Path
        The file, or `file#part`.
    fps : float, optional
        The file's true frame rate, over what the library knows.
    up : str, optional
        The axis that is up, over what the library knows.

    Raises
    ------
    UnreadableMotion
        If it holds no motion that can be read.
    ArgumentError
        If `fps` is no frame rate.
    """
    from indexer.ingest.load import read_motion  # the state of a file is told without reading it

    fps = checked_rate(fps)
    file, _ = split_name(path)
    known = known_options(library, file)
    options = known or ReadOptions()
    read = read_motion(str(path), fps or options.fps, dict(options.joint_map) or None, up or options.up)
    row = table.READABLE.get(file.suffix.lower())
    if known is None and fps is None and row is not None and not row.states_fps:
        rate = _rate_of_rig(library, read.rig, row.ending.lstrip("."))
        if rate is not None:
            read = read_motion(str(path), rate, up=up or options.up)
    return read


def file_state(library: StoredLibrary, clip: int, place: Path) -> str:
    """What became of the file of a clip since it was indexed: that it is gone or has changed; else empty.

    Only a file of the same size and another time is read, as one that was copied or touched: it may be the same.
    """
    row = library.connection.execute(
        "SELECT size, mtime_ns, hash FROM files JOIN clips ON clips.file_id = files.id WHERE clips.id = ?", (clip,)
    ).fetchone()
    try:
        file = _scanned(split_name(place)[0])
        same = row is None or (file.size, file.mtime_ns) == row[:2]
        same = same or (file.size == row[0] and _digest(file, place.parent) == row[2])
    except (FileNotFoundError, NotADirectoryError):
        return "is gone since it was indexed"
    except (OSError, UnreadableMotion):  # UnreadableMotion: the archive it lies in
        return "cannot be read any more"
    return "" if same else "has changed since it was indexed"


@lru_cache(_DIGESTS)
def _digest(file: File, root: Path) -> str:
    """The digest of a file, read once for each of its sizes and times: every hit of every answer asks for it."""
    return file.hash(root)


def known_options(library: StoredLibrary, path: Path) -> ReadOptions | None:
    """How the library reads a file, by its path or its content; None where it knows neither.

    As in indexing, what a captions table states takes precedence. Files of the same content that were read
    with different options decide nothing.
    """
    options, stated = None, Stated()
    for key, inside in library.places(path):
        options = options or _common(library, "root_id = ? AND path = ? AND state != 'gone'", (key, inside))
        stated = stated_option(library.connection, key, inside).and_then(stated)
    options = options or _of_content(library, path)
    if stated == Stated():
        return options
    known = options or ReadOptions()
    return replace(known, fps=stated.fps or known.fps, up=stated.up or known.up)


def _of_content(library: StoredLibrary, place: Path) -> ReadOptions | None:
    try:
        file = _scanned(place)
        if library.connection.execute("SELECT 1 FROM files WHERE size = ? LIMIT 1", (file.size,)).fetchone() is None:
            return None
        return _common(library, "hash = ?", (file.hash(place.parent),))
    except (OSError, UnreadableMotion):  # the reader reports it better
        return None


def _scanned(place: Path) -> File:
    """A file as indexing its folder would find it: with the companions that it may need."""
    row = table.READABLE.get(place.suffix.lower())
    others: list[Path] = []
    if row is not None and row.companion is not None:
        kind = row.companion
        others = [other for other in beside(place) if other.suffix.lower() == kind.ending]
        others = [other for other in others if not kind.same_name or other.stem == place.stem]
    companions = [File(other.name, *state(other)) for other in others if not other.name.startswith(".")]
    return with_companions(File(place.name, *state(place)), companions)


def _common(library: StoredLibrary, condition: str, values: Sequence[Any]) -> ReadOptions | None:
    """The options of the files that meet an SQL condition; None where there are none, or they differ."""
    rows = library.connection.execute(f"SELECT DISTINCT recipe FROM files WHERE {condition}", values).fetchall()
    options = {replace(ReadOptions.of(text), from_table=False, up_from_table=False, version=0) for (text,) in rows}
    return options.pop() if len(options) == 1 else None


def _rate_of_rig(library: StoredLibrary, rig: str, format: str) -> float | None:
    """The frame rate given for all clips of a rig and format; None where there is none, or they differ."""
    rows = library.connection.execute(
        "SELECT DISTINCT files.recipe FROM clips JOIN files ON files.id = clips.file_id "
        "WHERE files.state = 'indexed' AND clips.rig = ? AND clips.format = ?",
        (rig, format),
    )
    rates = {ReadOptions.of(text).fps for (text,) in rows}
    return rates.pop() if len(rates) == 1 else None
