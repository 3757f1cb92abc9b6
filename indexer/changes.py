"""What changed in a folder since the library last looked: by path, size and time, then by content."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path

from indexer.scan import File, Folder
from indexer.writer import INDEXED, Known, Source, Writer

#: Grows when files come to be read differently than before, so that all are read again.
READING = 1


@dataclass
class Changes:
    """What is to be done about the motions of one root.

    Attributes
    ----------
    read : list of (Source, fps)
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
        Files as they were, and how many of them could not be read.
    """

    read: list[tuple[Source, float | None]] = field(default_factory=list)
    unreadable: list[tuple[Source, str]] = field(default_factory=list)
    moved: list[tuple[int, int, File]] = field(default_factory=list)
    touched: list[tuple[int, File]] = field(default_factory=list)
    gone: list[Known] = field(default_factory=list)
    unchanged: int = 0
    failed_before: int = 0


def recipe(fps: float | None, joint_map: Mapping[str, str]) -> str:
    """What besides a file's content decides the motion it gives, as one short word."""
    said = json.dumps([READING, fps, sorted(joint_map.items())])
    return blake2b(said.encode(), digest_size=8).hexdigest()


def compare(
    writer: Writer,
    root: Path,
    root_id: int,
    folders: list[Folder],
    motions: list[File],
    *,
    fps: float | None,
    rates: Mapping[str, float],
    joint_map: Mapping[str, str],
    retry: bool,
) -> Changes:
    """Hold the motions found under a root against what the library knows; changes nothing.

    Parameters
    ----------
    fps : float or None
        The frame rate asked for.
    rates : mapping
        Path -> frame rate stated by a captions table, which goes before `fps`.
    retry : bool
        Read unchanged files again that could not be read.
    """
    changes = Changes()
    known = writer.known(root_id)
    found = {file.path for file in motions}
    taken: set[int] = set()
    for file in motions:
        rate = rates.get(file.path, fps)
        made = recipe(rate, joint_map)
        old = known.get(file.path)
        again = old is None or old.recipe != made or (retry and old.state != INDEXED)
        if old is not None and not again and (old.size, old.mtime_ns) == (file.size, file.mtime_ns):
            changes.unchanged += 1
            changes.failed_before += old.state != INDEXED
            continue
        try:
            source = Source(root_id, file, file.hash(root), made)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            changes.unreadable.append((Source(root_id, file, "", made), reason))
            continue
        if old is not None and not again and old.hash == source.hash:
            changes.touched.append((old.id, file))
            changes.unchanged += 1
            changes.failed_before += old.state != INDEXED
            continue
        origin = None if old is not None and old.state == INDEXED else _origin(writer, source, root_id, found, taken)
        if origin is None:
            changes.read.append((source, rate))
        else:
            taken.add(origin)
            changes.moved.append((origin, root_id, file))
    unseen = tuple(folder.path + "/" for folder in folders if folder.error)
    changes.gone = [
        old for path, old in known.items() if path not in found and old.id not in taken and not path.startswith(unseen)
    ]
    return changes


def _origin(writer: Writer, source: Source, root_id: int, found: set[str], taken: set[int]) -> int | None:
    """The file that this one was: of the same content, read in the same way, and not there any more."""
    for file_id, other_root, path, state in writer.same_content(source.hash, source.recipe):
        if file_id in taken:
            continue
        elsewhere = other_root != root_id and not os.path.lexists(writer.root_path(other_root) / path)
        if state != INDEXED or elsewhere or (other_root == root_id and path not in found):
            return file_id
    return None
