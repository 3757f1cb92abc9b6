"""Walk a folder: its motion files, and the side files that hold captions for them."""

from __future__ import annotations

import errno
import os
import stat
from collections import defaultdict
from dataclasses import dataclass, field, replace
from pathlib import Path
from posixpath import basename, dirname, splitext
from unicodedata import normalize

from encoders.arguments import is_text
from encoders.errors import UnreadableMotion
from indexer.formats import table, zip_archive
from indexer.formats.opening import time_of
from indexer.formats.refused import PACKINGS
from indexer.store.files import File
from indexer.store.library_reader import FILE

TABLES = frozenset({"captions.csv", "captions.tsv", "captions.jsonl"})
LINES = ".txt"
#: The folders of a library, beside its file.
_OF_LIBRARY = frozenset({"vectors", "previews"})

#: Archives and compressed files, which may hold motions and are not looked into.
_NOT_LOOKED_INTO = frozenset({*PACKINGS, ".gz"})

_OTHER_NAME = "symbolic links passed over, to what is indexed under another name"
_LOOP = "symbolic links passed over, back to a folder around them"
_BROKEN = "symbolic links to nothing that is there, whose clips are left as they were"
_PACKED = "packed files not read, to be unpacked, or packed as .zip"
_ENCODING = "entries passed over, to be renamed, whose names are not UTF-8"


@dataclass
class Folder:
    """One folder's files, links to files among them."""

    path: str
    files: list[File] = field(default_factory=list)

    def motions(self) -> list[File]:
        """The files that are motions by their ending, each with the companions it may need."""
        others: dict[tuple[str, str], list[File]] = {}  # by ending, and by ending and name
        for file in self.files:
            others.setdefault((file.ending, ""), []).append(file)
            others.setdefault((file.ending, file.stem), []).append(file)

        def companions(motion: File) -> list[File]:
            row = table.READABLE.get(motion.ending)
            kind = None if row is None else row.companion
            return [] if kind is None else others.get((kind.ending, motion.stem if kind.same_name else ""), [])

        return [
            with_companions(file, companions(file))
            for file in self.files
            if table.is_motion(file.ending) or file.ending == zip_archive.ENDING
        ]

    def side_files(self, motions: list[File]) -> list[tuple[File, list[str]]]:
        """The side files, each with the paths of the motions beside it; none for a table, which names them."""
        named: dict[str, list[str]] = {}
        for motion in motions:
            named.setdefault(normalize("NFC", motion.stem), []).append(motion.path)
        about = {file.path: named.get(normalize("NFC", file.stem), []) for file in self.files if file.ending == LINES}
        return [
            (file, about.get(file.path, []))
            for file in self.files
            if basename(file.path).lower() in TABLES or about.get(file.path)
        ]


@dataclass
class Scan:
    """What was found under a root.

    Attributes
    ----------
    folders : list of Folder
        Parents first, in order of names.
    unread : list of str
        Files and folders that are there but cannot be looked at now: nothing is known of them and of what they hold.
    failed : list of (path, reason)
        Why; what passes by itself, or once somebody gives the permission.
    warnings : list of str
        What was passed over.
    """

    folders: list[Folder] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)
    failed: list[tuple[str, str]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def may_hold(self, path: str) -> bool:
        """Whether a file that was not found may still be there."""
        return path.startswith(tuple(f"{place}/" for place in self.unread)) or path in self.unread


def walk(root: Path) -> Scan:
    """Every folder under `root`.

    Hidden files and folders are skipped, and those in which a library keeps its vectors and previews. Symbolic links
    are followed, also out of the root, and what they lead to has the link's own path. A motion or a folder that several
    paths lead to is taken once, under its own path where that is not hidden.

    Raises
    ------
    OSError
        If `root` itself cannot be listed or entered.
    """
    walking = _Walk(root)
    walking.tree("", walking.real_root)
    while walking.links:
        links, walking.links = walking.links, []
        for link in links:
            walking.follow(*link)
    return walking.found()


class _Walk:
    """The state of a walk: links are followed when all that lies in the folder itself is known."""

    def __init__(self, root: Path) -> None:
        self.root, self.real_root = root, os.path.realpath(root)
        self.folders: dict[str, Folder] = {}
        #: Links that wait: path, and the real path of the folder it lies in.
        self.links: list[tuple[str, str]] = []
        self._scan = Scan()
        self._real: set[str] = set()
        self._motions: set[tuple[int, int]] = set()
        self._remarks: dict[str, list[str]] = defaultdict(list)

    def tree(self, path: str, real: str) -> None:
        """Walk a folder and those in it."""
        waiting = [(path, real)]
        while waiting:
            path, real = waiting.pop()
            if real in self._real:
                self._remarks[_OTHER_NAME].append(path)
                continue
            try:
                inner = self.read_folder(path, real)
            except OSError as error:
                if not path:
                    raise
                self._fail(path, "cannot be listed", error)
                continue
            waiting.extend((_join(path, name), os.path.join(real, name)) for name in reversed(inner))

    def read_folder(self, path: str, real: str) -> list[str]:
        """Note the files and links of a folder; the names of the folders in it."""
        with os.scandir(self.root / path) as entries:
            found = sorted(entries, key=lambda entry: entry.name)
        os.stat(os.path.join(self.root, path, "."))  # a folder may be listed that cannot be entered
        self._real.add(real)
        self.folders[path] = Folder(path)
        own = _OF_LIBRARY if any(entry.name == FILE for entry in found) else frozenset()
        inner = []
        for entry in found:
            inside = _join(path, entry.name)
            if entry.name.startswith("."):
                continue
            if not is_text(inside):
                self._remarks[_ENCODING].append(os.fsencode(inside).decode(errors="replace"))
                continue
            try:
                if entry.is_symlink() or getattr(entry, "is_junction", bool)():
                    self.links.append((inside, real))
                elif entry.is_dir(follow_symlinks=False):
                    if entry.name not in own:
                        inner.append(entry.name)
                elif entry.is_file(follow_symlinks=False):
                    self._add(inside, entry.stat(follow_symlinks=False))
            except FileNotFoundError:
                continue  # it has vanished since it was listed
            except OSError as error:
                self._fail(inside, "cannot be looked at", error)
        return inner

    def follow(self, path: str, around: str) -> None:
        """Take what a link in the folder of the real path `around` leads to."""
        try:
            state = os.stat(self.root / path)
        except OSError as error:
            self._broken(path, error)
            return
        if stat.S_ISREG(state.st_mode):
            if table.is_motion(splitext(path)[1].lower()) and (state.st_dev, state.st_ino) in self._motions:
                self._remarks[_OTHER_NAME].append(path)
            else:
                self._add(path, state)
        elif stat.S_ISDIR(state.st_mode):
            real = os.path.realpath(self.root / path)
            if Path(around).is_relative_to(real) or Path(self.real_root).is_relative_to(real):
                self._remarks[_LOOP].append(path)
            else:
                self.tree(path, real)

    def found(self) -> Scan:
        """All that was found."""
        scan = self._scan
        scan.folders = sorted(self.folders.values(), key=lambda folder: folder.path.split("/"))
        for folder in scan.folders:
            folder.files.sort(key=lambda file: file.path)
        for remark, paths in self._remarks.items():
            self._remark(f"{self.root}: {remark}", paths)
        return scan

    def _remark(self, text: str, paths: list[str]) -> None:
        self._scan.warnings.append(f"{text}: {len(paths)}, such as {min(paths)}")

    def _add(self, path: str, state: os.stat_result) -> None:
        file = File(path, state.st_size, time_of(state))
        if file.ending == zip_archive.ENDING:
            self._add_archive(file)
            return
        if file.ending in _NOT_LOOKED_INTO:
            self._remarks[_PACKED].append(path)
        self.folders[dirname(path)].files.append(file)
        if state.st_ino and table.is_motion(file.ending):
            self._motions.add((state.st_dev, state.st_ino))

    def _add_archive(self, file: File) -> None:
        """Take the members of an archive as files of a folder of its name; one that is damaged is a file itself."""
        try:
            archive = zip_archive.read_archive(self.root / file.path)
        except UnreadableMotion as error:
            self.folders[dirname(file.path)].files.append(replace(file, refusal=error.reason))
            return
        for name, members in archive.folders.items():
            folder = Folder(_join(file.path, name) if name else file.path)
            for member in members:
                info = archive.members[member]
                path = _join(file.path, member)
                folder.files.append(File(path, info.file_size, info.CRC, refusal=zip_archive.refusal(info)))
            self.folders[folder.path] = folder
        for remark, names in archive.remarks.items():
            self._remark(f"{self.root / file.path}: {remark}", names)

    def _broken(self, path: str, error: OSError) -> None:
        if error.errno == errno.ELOOP:
            self._remarks[_LOOP].append(path)
        elif error.errno in (errno.ENOENT, errno.ENOTDIR):
            self._remarks[_BROKEN].append(path)
            self._scan.unread.append(path)
        else:
            self._fail(path, "cannot be looked at", error)

    def _fail(self, path: str, what: str, error: OSError) -> None:
        reason = error.strerror or str(error)
        self._scan.unread.append(path)
        self._scan.failed.append((str(self.root / path), f"{what} ({reason}); its clips are left as they were"))


def _join(folder: str, name: str) -> str:
    return f"{folder}/{name}" if folder else name


def with_companions(file: File, others: list[File]) -> File:
    """A file with those beside it that it may be read with."""
    if not others:
        return file
    # The sum of the times within SQLite's 63 bits; if any of them changes, so does the sum.
    time = sum(part.mtime_ns for part in (file, *others)) % 2**63
    size = sum(part.size for part in (file, *others))
    return replace(file, size=size, mtime_ns=time, companions=tuple(other.path for other in others))
