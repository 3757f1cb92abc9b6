"""The captions of a library are brought up to date with the side files of a folder."""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from indexer.ingest.caption_files import Warn, read_lines, read_table
from indexer.ingest.scan import TABLES
from indexer.store import captions
from indexer.store.captions import CaptionRow
from indexer.store.files import File


@dataclass
class SideFileChanges:
    """The side files that were read in this run, and those that have vanished, by id."""

    read: list[int] = field(default_factory=list)
    vanished: list[int] = field(default_factory=list)


def update(
    db: sqlite3.Connection, root: Path, root_id: int, found: list[tuple[File, list[str]]], warn: Warn
) -> SideFileChanges:
    """Read the side files that are new or changed; unchanged ones are not opened.

    Parameters
    ----------
    found : list of (File, list of str)
        The side files of the root, each with the paths of the motions beside it.
    """
    known = captions.side_files(db, root_id)
    changes = SideFileChanges()
    for file, targets in found:
        _, size, mtime_ns, old_hash = known.pop(file.path, (None, -1, -1, ""))
        if (size, mtime_ns) == (file.size, file.mtime_ns):
            continue
        try:
            digest = file.hash(root)
            rows = _read(root, file, targets, warn) if digest != old_hash else None
        except OSError as error:
            warn(f"{root / file.path}: {(error.strerror or str(error)).lower()}; its captions are left as they were")
            continue
        file_id = captions.record_side_file(db, root_id, file, digest)
        if rows is not None:
            captions.replace_of_side_file(db, root_id, file_id, rows)
            changes.read.append(file_id)
    changes.vanished = [file_id for file_id, *_ in known.values()]
    return changes


def unmatched(db: sqlite3.Connection, root: Path, changes: SideFileChanges) -> list[str]:
    """A warning for each side file just read that names motions which the library does not have."""
    warnings = []
    for file_id in changes.read:
        path, count, example = captions.without_clip(db, file_id)
        if count:
            rows = f"{count} captions are" if count > 1 else "a caption is"
            warnings.append(f"{root / path}: {rows} of motions that are not indexed, such as {example!r}")
    return warnings


def _read(root: Path, file: File, targets: list[str], warn: Warn) -> list[CaptionRow]:
    path = PurePosixPath(file.path)
    if path.name.lower() in TABLES:
        folder = "" if str(path.parent) == "." else str(path.parent)
        return read_table(root / file.path, folder, warn)
    return [CaptionRow(target, *caption) for caption in read_lines(root / file.path, warn) for target in targets]
