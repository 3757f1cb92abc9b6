"""HumanML3D and KIT-ML in their published folders, where each motion becomes one clip with its captions.

new_joints/000001.npy           a motion as joints
new_joint_vecs/000001.npy       the same motion as features; read where there are no joints
texts/000001.txt                its captions
Mean.npy, Std.npy               statistics of the features
train.txt, val.txt, test.txt    splits: lists of ids
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from io import TextIOWrapper
from pathlib import Path
from posixpath import basename, dirname, join

from indexer.formats.opening import open_file
from indexer.ingest.scan import LINES, Folder
from indexer.store.captions import CaptionRow
from indexer.store.files import File

#: The folders of a data set that hold its motions, the preferred one first.
_MOTIONS = ("new_joints", "new_joint_vecs")
_TEXTS = "texts"
_STATISTICS = frozenset({"mean", "std"})
#: A list of ids has at most so many bytes: a million ids.
_MAX_LIST_BYTES = 16 << 20


@dataclass(frozen=True)
class Published:
    """What lies in published folders under a root.

    Attributes
    ----------
    passed_over : set of str
        Motions that are there as joints, too, and statistics.
    texts : list of (File, list of str)
        Files of captions, each with the path of its motion.
    lists : list of File
        Text files beside the folders of motions; those that list ids are splits.
    """

    passed_over: set[str] = field(default_factory=set)
    texts: list[tuple[File, list[str]]] = field(default_factory=list)
    lists: list[File] = field(default_factory=list)


def published(folders: Iterable[Folder]) -> Published:
    """What lies in published folders among those under a root."""
    files = {folder.path: folder.files for folder in folders}
    found = Published()
    for place in dict.fromkeys(dirname(path) for path in files if basename(path) in _MOTIONS):
        motions: dict[str, str] = {}
        for name in _MOTIONS:
            for file in (file for file in files.get(join(place, name), []) if file.ending == ".npy"):
                if motions.setdefault(file.name, file.path) != file.path:
                    found.passed_over.add(file.path)
        inside = (path for path in files if not place or path == place or path.startswith(f"{place}/"))
        found.passed_over.update(file.path for path in inside for file in files[path] if _is_statistics(file))
        texts = [file for file in files.get(join(place, _TEXTS), []) if file.ending == LINES]
        found.texts.extend((file, [motions[file.name]]) for file in texts if file.name in motions)
        found.lists.extend(
            file for file in files.get(place, []) if file.ending == LINES and file.size <= _MAX_LIST_BYTES
        )
    return found


def read_split(root: Path, file: File) -> list[CaptionRow]:
    """The motions that a list of ids names, whether or not they are there, as of the split that it is called after.

    Raises
    ------
    OSError, UnreadableMotion
        If it cannot be read.
    """
    with TextIOWrapper(open_file(root / file.path), encoding="utf-8", errors="replace") as lines:
        ids = dict.fromkeys(line.strip() for line in lines)
    return [
        CaptionRow(join(dirname(file.path), folder, f"{id}.npy"), split=file.name)
        for id in ids
        if id.isalnum() and id.isascii()
        for folder in _MOTIONS
    ]


def advice(root: Path) -> str:
    """What to index instead of a folder that holds the motions of a data set alone; empty for any other folder."""
    if root.name not in _MOTIONS or not (root.parent / _TEXTS).is_dir():
        return ""
    return f"{root}: the captions of its motions lie beside it; index {root.parent} to have them"


def _is_statistics(file: File) -> bool:
    return file.ending == ".npy" and file.name.lower() in _STATISTICS
