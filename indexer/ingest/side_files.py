"""The captions of a library are brought up to date with the side files of a folder."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from unicodedata import normalize

from encoders.errors import UnreadableMotion
from indexer.ingest.caption_files import MAX_BYTES, Warn, read_lines, read_table
from indexer.ingest.published_folders import read_split
from indexer.ingest.scan import TABLES
from indexer.part_names import splits, with_part
from indexer.store import captions
from indexer.store.captions import CaptionRow
from indexer.store.files import File


@dataclass
class SideFileChanges:
    """The side files that were read in this run, and those that have vanished, by id."""

    read: list[int] = field(default_factory=list)
    vanished: list[int] = field(default_factory=list)


def update(
    db: sqlite3.Connection,
    root: Path,
    root_id: int,
    found: list[tuple[File, list[str]]],
    lists: list[File],
    motions: Iterable[str],
    may_hold: Callable[[str], bool],
    warn: Warn,
) -> SideFileChanges:
    """Read the side files that are new or changed; unchanged ones are not opened.

    Parameters
    ----------
    found : list of (File, list of str)
        The side files of the root, each with the paths of the motions that it is about.
    lists : list of File
        Lists of ids of published data sets.
    motions : iterable of str
        The paths of all motions of the root.
    may_hold : callable
        Whether a side file that was not found may still be at a path; its captions are then left as they were.
    """
    on_disk = _spellings(motions)
    known = captions.side_files(db, root_id)
    named = captions.paths_named(db, root_id)
    changes = SideFileChanges()
    split_lists = {file.path for file in lists}
    for file, targets in [*found, *((file, []) for file in lists)]:
        old_id, size, mtime_ns, old_hash = known.pop(file.path, (None, -1, -1, ""))
        is_about_the_same = set(targets) <= named.get(old_id, set())
        if (size, mtime_ns) == (file.size, file.mtime_ns) and is_about_the_same:
            continue
        if file.size > MAX_BYTES:
            warn(f"{root / file.path}: larger than {MAX_BYTES >> 20} MB; its captions are left as they were")
            continue
        try:
            digest = file.hash(root)
            if digest == old_hash and is_about_the_same:
                rows = None
            elif file.path in split_lists:
                rows = read_split(root, file)
            else:
                rows = _read(root, file, targets, on_disk, warn)
        except (OSError, UnreadableMotion) as error:
            reason = error.reason if isinstance(error, UnreadableMotion) else (error.strerror or str(error)).lower()
            warn(f"{root / file.path}: {reason}; its captions are left as they were")
            continue
        file_id = captions.record_side_file(db, root_id, file, digest)
        if rows is not None:
            captions.replace_of_side_file(db, root_id, file_id, rows)
            changes.read.append(file_id)
    changes.vanished = [file_id for path, (file_id, *_) in known.items() if not may_hold(path)]
    return changes


def unmatched(db: sqlite3.Connection, root: Path, changes: SideFileChanges) -> list[str]:
    """A warning for each side file just read that names what is not so: no motion, one of several, a part of a file."""
    warnings = []
    for file_id in changes.read:
        path, count, example = captions.without_clip(db, file_id)
        if count:
            rows = f"{count} captions are" if count > 1 else "a caption is"
            warnings.append(f"{root / path}: {rows} of motions that are not indexed, such as {example!r}")
        several = captions.of_several_clips(db, file_id)
        if several:
            file, clip = several[0]
            more = f", and {len(several) - 1} more files" if len(several) > 1 else ""
            warnings.append(f"{root / path}: {file!r} has several clips; its captions went to {clip!r}{more}")
        parts = captions.stated_of_parts(db, file_id)
        if parts:
            part, file = parts[0]
            more = f" (and of {len(parts) - 1} more parts)" if len(parts) > 1 else ""
            warnings.append(f"{root / path}: fps and up are of a file, not of {part!r}{more}; name {file!r} for them")
    return warnings


def _spellings(paths: Iterable[str]) -> dict[str, str]:
    """How paths are spelt on disk that Unicode spells in several ways: by their own spelling and the composed one."""
    several = [path for path in paths if not path.isascii()]
    return {normalize("NFC", path): path for path in several} | {path: path for path in several}


def _read(root: Path, file: File, targets: list[str], on_disk: Mapping[str, str], warn: Warn) -> list[CaptionRow]:
    path = PurePosixPath(file.path)
    if path.name.lower() in TABLES:
        folder = "" if str(path.parent) == "." else str(path.parent)
        return [_spelt(row, on_disk) for row in read_table(root / file.path, folder, warn)]
    return [CaptionRow(target, *caption) for caption in read_lines(root / file.path, warn) for target in targets]


def _spelt(row: CaptionRow, on_disk: Mapping[str, str]) -> CaptionRow:
    """A row that names its motion as it is spelt on disk; one that is not there yet, in composed form."""
    if row.path.isascii():
        return row
    composed = normalize("NFC", row.path)
    for path in (row.path, composed):
        for file, part in ((path, ""), *splits(path)):
            if file in on_disk:
                return replace(row, path=with_part(on_disk[file], part))
    return replace(row, path=composed)
