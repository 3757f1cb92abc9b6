"""Walk a folder: the files that are or may be motions, and the side files that describe them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path, PurePosixPath

#: Formats of motion that people keep beside what can be read: listed as failed, not passed over in silence.
MOTION_LIKE = frozenset(
    {".abc", ".anim", ".bip", ".blend", ".c3d", ".csm", ".dae", ".fbx", ".glb", ".gltf", ".htr", ".mvnx", ".npz"}
    | {".trc", ".usd", ".usda", ".usdc", ".usdz", ".vmd", ".vrm", ".vrma"}
)
#: A skeleton that belongs to motions beside it, no motion itself.
SKELETONS = frozenset({".asf"})
TABLES = frozenset({"captions.csv", "captions.tsv", "captions.jsonl"})


@dataclass(frozen=True)
class File:
    """A file as the walk saw it; `path` is relative to the root, with forward slashes."""

    path: str
    size: int
    mtime_ns: int

    @property
    def ending(self) -> str:
        return PurePosixPath(self.path).suffix.lower()

    @property
    def stem(self) -> str:
        """The path without its ending: what a side file of the same name shares."""
        return str(PurePosixPath(self.path).with_suffix(""))


def walk(root: Path, warn: Callable[[str], None]) -> Iterator[File]:
    """Every regular file under `root`, folder by folder in order of names.

    Hidden files and folders are skipped, symbolic links are not followed, and a folder that cannot be listed
    is told to `warn` (the error is the caller's to judge: what lies there is unknown, not gone).
    """
    waiting = [""]
    while waiting:
        folder = waiting.pop()
        try:
            with os.scandir(root / folder) as entries:
                found = sorted(entries, key=lambda entry: entry.name)
        except OSError as error:
            if not folder:
                raise
            warn(f"{root / folder}: cannot be listed ({error.strerror}); what lies there is left as it was")
            continue
        inner = []
        for entry in found:
            path = f"{folder}/{entry.name}" if folder else entry.name
            if entry.name.startswith("."):
                continue
            if not _storable(path):
                warn(f"{root / path}".encode(errors="replace").decode() + ": the name is no UTF-8; rename it")
            elif entry.is_symlink():
                warn(f"{root / path}: symbolic links are not followed; index the folder it points to as well")
            elif entry.is_dir(follow_symlinks=False):
                inner.append(path)
            elif entry.is_file(follow_symlinks=False):
                state = entry.stat(follow_symlinks=False)
                yield File(path, state.st_size, state.st_mtime_ns)
        waiting.extend(reversed(inner))


def _storable(path: str) -> bool:
    try:
        path.encode()
    except UnicodeEncodeError:
        return False
    return True


def content_hash(paths: list[Path]) -> str:
    """The content of the files, one after the other, as hex digits."""
    digest = blake2b(digest_size=16)
    for path in paths:
        with path.open("rb") as file:
            while piece := file.read(1 << 20):
                digest.update(piece)
        digest.update(b"\0")
    return digest.hexdigest()
