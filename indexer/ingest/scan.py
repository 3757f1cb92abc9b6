"""Walk a folder: its motion files, and the side files that hold captions for them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from posixpath import basename, splitext

from encoders.arguments import is_text
from indexer.formats import table
from indexer.store.files import File
from indexer.store.stored_library import FILE

TABLES = frozenset({"captions.csv", "captions.tsv", "captions.jsonl"})
LINES = ".txt"
#: The folders of a library, beside its file.
_OF_LIBRARY = frozenset({"vectors", "previews"})


@dataclass
class Folder:
    """One folder's regular files; `error` says why it could not be listed."""

    path: str
    files: list[File] = field(default_factory=list)
    error: str = ""

    def motions(self) -> list[File]:
        """The files that are motions by their ending, each with the companions it may need."""
        by_ending: dict[str, list[File]] = {}
        for file in self.files:
            by_ending.setdefault(file.ending, []).append(file)
        companions = {
            row.ending: by_ending.get(row.companion.ending, []) for row in table.FORMATS if row.companion is not None
        }
        return [_with(file, companions.get(file.ending, [])) for file in self.files if table.is_motion(file.ending)]

    def side_files(self, motions: list[File]) -> list[tuple[File, list[str]]]:
        """The side files, each with the paths of the motions beside it; none for a table, which names them."""
        named: dict[str, list[str]] = {}
        for motion in motions:
            named.setdefault(motion.stem, []).append(motion.path)
        about = {file.path: named.get(file.stem, []) for file in self.files if file.ending == LINES}
        return [
            (file, about.get(file.path, []))
            for file in self.files
            if basename(file.path).lower() in TABLES or about.get(file.path)
        ]


def walk(root: Path, warn: Callable[[str], None]) -> Iterator[Folder]:
    """Every folder under `root`, parents first, in order of names.

    Hidden files and folders are skipped, and those in which a library keeps its vectors and previews. Symbolic links
    are not followed, with a warning where they may be meant.

    Raises
    ------
    OSError
        If `root` itself cannot be listed.
    """
    waiting = [""]
    while waiting:
        folder = Folder(waiting.pop())
        try:
            with os.scandir(root / folder.path) as entries:
                found = sorted(entries, key=lambda entry: entry.name)
        except OSError as error:
            if not folder.path:
                raise
            folder.error = error.strerror or str(error)
            warn(f"{root / folder.path}: cannot be listed ({folder.error}); its clips are left as they were")
            found = []
        inner = []
        own = _OF_LIBRARY if any(entry.name == FILE for entry in found) else frozenset()
        for entry in found:
            path = f"{folder.path}/{entry.name}" if folder.path else entry.name
            if entry.name.startswith("."):
                continue
            if not is_text(path):
                warn(f"{os.fsencode(root / path).decode(errors='replace')}: the name is not UTF-8; rename it")
            elif entry.is_symlink():
                if entry.is_dir() or table.is_motion(splitext(path)[1].lower()):
                    warn(f"{root / path}: symbolic links are not followed; index what it points to by its own path")
            elif entry.is_dir(follow_symlinks=False):
                if entry.name not in own:
                    inner.append(path)
            elif entry.is_file(follow_symlinks=False):
                try:
                    state = entry.stat(follow_symlinks=False)
                except FileNotFoundError:
                    continue  # it has vanished since it was listed
                folder.files.append(File(path, state.st_size, state.st_mtime_ns))
        yield folder
        waiting.extend(reversed(inner))


def _with(file: File, others: list[File]) -> File:
    if not others:
        return file
    # The sum of the times within SQLite's 63 bits; if any of them changes, so does the sum.
    time = sum(part.mtime_ns for part in (file, *others)) % 2**63
    return File(
        file.path,
        sum(part.size for part in (file, *others)),
        time,
        tuple(other.path for other in others),
    )
