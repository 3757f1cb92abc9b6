"""What changed in a folder since the library last looked: by path, size and time, then by content."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from indexer.ingest.scan import File, Folder
from indexer.store.read_options import Asked
from indexer.store.writer import INDEXED, FileVersion, Known, Writer


@dataclass
class Changes:
    """What is to be done about the motions of one root.

    Attributes
    ----------
    read : list of Source
        New and changed files.
    unreadable : list of (Source, reason)
        Files that cannot even be opened.
    moved : list of (file id, root id, File)
        Files that lie elsewhere than before, or are back.
    touched : list of (file id, File)
        Files with a new time and the old content.
    gone : list of Known
        Files that have vanished.
    unchanged, failed_before : int
        Files as they were: those indexed, and those that could not be read.
    """

    read: list[FileVersion] = field(default_factory=list)
    unreadable: list[tuple[FileVersion, str]] = field(default_factory=list)
    moved: list[tuple[int, int, File]] = field(default_factory=list)
    touched: list[tuple[int, File]] = field(default_factory=list)
    gone: list[Known] = field(default_factory=list)
    unchanged: int = 0
    failed_before: int = 0

    def count_as_before(self, known: Known) -> None:
        """Count a file that needs nothing done."""
        if known.state == INDEXED:
            self.unchanged += 1
        else:
            self.failed_before += 1


def compare(
    writer: Writer,
    root: Path,
    root_id: int,
    folders: list[Folder],
    motions: list[File],
    asked: Asked,
    rates: Mapping[str, float],
) -> Changes:
    """Hold the motions found under a root against what the library knows; changes nothing.

    Parameters
    ----------
    asked : Asked
        How files are to be read.
    rates : mapping
        Path -> frame rate stated by a captions table, which goes before the one asked for.
    """
    changes = Changes()
    known = writer.known(root_id)
    found = {file.path for file in motions}
    taken: set[int] = set()
    for file in motions:
        rate = rates.get(file.path)
        old = known.get(file.path)
        recipe = asked.recipe(rate, None if old is None else old.recipe)
        again = old is None or old.recipe != recipe or (asked.retry and old.state != INDEXED)
        if old is not None and not again and (old.size, old.mtime_ns) == (file.size, file.mtime_ns):
            changes.count_as_before(old)
            continue
        try:
            source = FileVersion(root_id, file, file.hash(root), recipe)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            changes.unreadable.append((FileVersion(root_id, file, "", recipe), reason))
            continue
        if old is not None and not again and old.hash == source.hash:
            changes.touched.append((old.id, file))
            changes.count_as_before(old)
            continue
        origin = None
        if old is None or old.state != INDEXED:
            origin = _origin(writer, source, found, taken, asked, rate)
        if origin is None:
            changes.read.append(source)
        else:
            taken.add(origin)
            changes.moved.append((origin, root_id, file))
    unseen = tuple(folder.path + "/" for folder in folders if folder.error)
    changes.gone = [
        old for path, old in known.items() if path not in found and old.id not in taken and not path.startswith(unseen)
    ]
    return changes


def _origin(
    writer: Writer, source: FileVersion, found: set[str], taken: set[int], asked: Asked, rate: float | None
) -> int | None:
    """The file that this one was: of the same content, to be read as it was, and not there any more."""
    for file_id, root_id, path, state, recipe in writer.same_content(source.hash):
        if file_id in taken or asked.recipe(rate, recipe) != recipe:
            continue
        here = root_id == source.root_id
        if state != INDEXED or (path not in found if here else not os.path.lexists(writer.root_path(root_id) / path)):
            return file_id
    return None
