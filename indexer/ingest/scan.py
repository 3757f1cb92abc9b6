"""Walk a folder: the files that are or may be motions, and the side files that describe them."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from posixpath import basename, splitext

from indexer.store.files import File

#: Formats of motion that people keep beside what can be read: listed as failed, not passed over in silence.
MOTION_LIKE = frozenset(
    {".abc", ".anim", ".bip", ".blend", ".c3d", ".csm", ".dae", ".fbx", ".glb", ".gltf", ".htr", ".mvnx"}
    | {".tak", ".trc", ".usd", ".usda", ".usdc", ".usdz", ".vmd", ".vrm", ".vrma"}
)
#: A motion's ending -> the ending of the skeletons beside it that it cannot be read without.
SKELETONS = {".amc": ".asf"}
TABLES = frozenset({"captions.csv", "captions.tsv", "captions.jsonl"})
LINES = ".txt"


@dataclass
class Folder:
    """One folder's regular files; `error` says why they are not known."""

    path: str
    files: list[File] = field(default_factory=list)
    error: str = ""

    def motions(self, readable: Collection[str]) -> list[File]:
        """The files that are motions by their ending, each with the skeletons it may need."""
        by_ending: dict[str, list[File]] = {}
        for file in self.files:
            by_ending.setdefault(file.ending, []).append(file)
        return [
            _with(file, by_ending.get(SKELETONS.get(file.ending, ""), []))
            for file in self.files
            if (file.ending in readable or file.ending in MOTION_LIKE) and file.ending not in SKELETONS.values()
        ]

    def side_files(self, motions: list[File]) -> list[tuple[File, list[str]]]:
        """The side files, each with the paths of the motions it is about; none for a table, which names them."""
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

    Hidden files and folders are skipped; symbolic links are not followed, and `warn` is told of those that may
    have been meant.

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
            warn(f"{root / folder.path}: cannot be listed ({folder.error}); what was indexed of it is left as it was")
            found = []
        inner = []
        for entry in found:
            path = f"{folder.path}/{entry.name}" if folder.path else entry.name
            if entry.name.startswith("."):
                continue
            if not _is_utf8(path):
                warn(f"{os.fsencode(root / path).decode(errors='replace')}: the name is not UTF-8; rename it")
            elif entry.is_symlink():
                if entry.is_dir() or splitext(path)[1].lower() in (".bvh", ".amc", ".npy", ".npz", *MOTION_LIKE):
                    warn(f"{root / path}: symbolic links are not followed; index what it points to by its own path")
            elif entry.is_dir(follow_symlinks=False):
                inner.append(path)
            elif entry.is_file(follow_symlinks=False):
                try:
                    state = entry.stat(follow_symlinks=False)
                except FileNotFoundError:
                    continue  # it went while we looked
                folder.files.append(File(path, state.st_size, state.st_mtime_ns))
        yield folder
        waiting.extend(reversed(inner))


def _with(file: File, others: list[File]) -> File:
    if not others:
        return file
    # Added up as SQLite's 63 bits can hold it; any of the times changing changes the sum.
    time = sum(part.mtime_ns for part in (file, *others)) % 2**63
    return File(
        file.path,
        sum(part.size for part in (file, *others)),
        time,
        tuple(other.path for other in others),
    )


def _is_utf8(path: str) -> bool:
    try:
        path.encode()
    except UnicodeEncodeError:
        return False
    return True
