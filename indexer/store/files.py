"""The records of the files that a library's motions come from: as found on disk, as read, and as known from before."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from posixpath import basename, splitext

from indexer.formats.opening import look, open_file
from indexer.store.read_options import ReadOptions

#: What the library knows of a file: its clip can be found, it cannot be read, or it has vanished.
INDEXED, FAILED, GONE = "indexed", "failed", "gone"

#: The root, relative to the library folder, of clips that were added as arrays; there is no such folder.
ARRAYS_ROOT = "arrays"
#: Their format.
ARRAY = "array"


@dataclass(frozen=True)
class File:
    """A file as found on disk.

    Attributes
    ----------
    path : str
        Relative to the root, with forward slashes.
    size, mtime_ns : int
        Of the file and its companions, added up: enough to see that something changed. See `opening.state`.
    companions : tuple of str
        Files it is read with, such as the skeleton of an AMC; relative to the root.
    refusal : str
        Why it is not read, whatever its format: by what the archive states in which it lies.
    """

    path: str
    size: int
    mtime_ns: int
    companions: tuple[str, ...] = ()
    refusal: str = ""

    @property
    def ending(self) -> str:
        """In lower case, with the dot."""
        return splitext(self.path)[1].lower()

    @property
    def stem(self) -> str:
        """The path without its ending: what a side file of the same name shares."""
        return splitext(self.path)[0]

    @property
    def name(self) -> str:
        """The name of its clip."""
        return basename(self.stem)

    @property
    def format(self) -> str:
        """The format of its clip."""
        return self.ending.lstrip(".")

    def look(self, root: Path) -> tuple[tuple[int, ...], ...]:
        """What tells, compared before and after reading, that neither it nor a companion was written meanwhile.

        Raises
        ------
        OSError
            If one is not there, or cannot be looked at.
        """
        return tuple(look(root / path) for path in (self.path, *self.companions))

    def hash(self, root: Path) -> str:
        """A digest of the content of the file and its companions, as hex digits.

        Raises
        ------
        OSError
            If one cannot be read.
        UnreadableMotion
            If one lies in an archive and is damaged there.
        """
        digest = blake2b(digest_size=16)
        for path in (self.path, *self.companions):
            with open_file(root / path) as file:
                while piece := file.read(1 << 20):
                    digest.update(piece)
            digest.update(b"\0")
        return digest.hexdigest()


@dataclass(frozen=True)
class ArrayItem(File):
    """A motion that was added as an array: its path is the id it was given, and there is no file."""

    @property
    def name(self) -> str:
        """The last part of the id."""
        return basename(self.path)

    @property
    def format(self) -> str:
        """Always `ARRAY`."""
        return ARRAY


@dataclass(frozen=True)
class FileVersion:
    """A file at the time it was read: where it lies, what it held, and how it was read.

    `seen` is its look before its content was, if it was looked at.
    """

    root_id: int
    file: File
    hash: str
    options: ReadOptions
    seen: tuple[tuple[int, ...], ...] = ()


@dataclass(frozen=True)
class KnownFile:
    """What the library recorded of a file when it was last indexed."""

    id: int
    path: str
    size: int
    mtime_ns: int
    hash: str
    options: ReadOptions
    state: str
