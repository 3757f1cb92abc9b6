"""Opening the files that motions are read from: a motion itself, and what lies beside it; in a folder or in a ZIP."""

from __future__ import annotations

import os
from pathlib import Path
from posixpath import dirname
from typing import BinaryIO

from encoders.errors import UnreadableMotion
from indexer.formats import zip_archive
from indexer.formats.decoding import decoded

MAX_BYTES = 4 << 30
TOO_LARGE = f"the file is larger than {MAX_BYTES / (1 << 30):.2g} GB; cut it into takes"
#: The largest integer of SQLite.
_LARGEST = 2**63 - 1


def read_bytes(path: Path, *, max_bytes: int = MAX_BYTES, as_it_is: bool = False) -> bytes:
    """The content of a file, or of a member of a ZIP archive: `pack.zip/walk.bvh`.

    It comes without gzip, and in UTF-8 if it is text, unless wanted as it is.

    Raises
    ------
    UnreadableMotion
        If it cannot be read, is empty, no regular file, larger than `max_bytes`, or damaged. Its cause (`__cause__`)
        is an OSError where that need not last, such as a permission that is missing.
    """
    try:
        if path.is_dir():
            raise UnreadableMotion(path, "this is a folder, not a file")
        if path.exists() and not path.is_file():
            raise UnreadableMotion(path, "this is no regular file")
        if path.suffix.lower() == zip_archive.ENDING and zip_archive.split(path) is None and path.is_file():
            raise UnreadableMotion(path, _name_a_member(path))
        if size(path) > max_bytes:
            raise UnreadableMotion(path, f"the file is larger than {max_bytes / (1 << 30):.2g} GB; cut it into takes")
        with open_file(path) as file:
            data = file.read() if as_it_is else decoded(path, file.read())
    except OSError as error:
        raise UnreadableMotion(path, error.strerror or str(error)) from error
    except ValueError as error:  # a name that no file can have
        raise UnreadableMotion(path, str(error)) from None
    if not data.strip():
        raise UnreadableMotion(path, "the file is empty")
    return data


def open_file(path: Path) -> BinaryIO:
    """Open a file for reading in bytes; one in an archive that is damaged raises UnreadableMotion while it is read.

    Raises
    ------
    OSError
        If it cannot be opened.
    UnreadableMotion
        If it is a member of an archive that cannot be read.
    """
    member = zip_archive.split(path)
    return path.open("rb") if member is None else zip_archive.open_member(*member)


def is_file(path: Path) -> bool:
    """Whether there is such a file."""
    try:
        return path.is_file() or (zip_archive.split(path) is not None and size(path) >= 0)
    except (OSError, ValueError, UnreadableMotion):
        return False


def size(path: Path) -> int:
    """Bytes of a file; raises OSError if there is none."""
    return state(path)[0]


def state(path: Path) -> tuple[int, int]:
    """What changes when the content of a file does: its size and its time; of a member of an archive its checksum.

    Raises
    ------
    OSError
        If there is no such file, or it cannot be looked at.
    UnreadableMotion
        If it lies in an archive that cannot be read.
    """
    member = zip_archive.split(path)
    if member is None:
        found = os.stat(path)
        return found.st_size, time_of(found)
    archive, name = member
    info = zip_archive.read_archive(archive).members.get(name)
    if info is None:
        raise FileNotFoundError(2, "no such file in the archive", str(path))
    return info.file_size, info.CRC


def look(path: Path) -> tuple[int, ...]:
    """What any write to a file changes, even one that sets its time back: of an archive, where it lies in one.

    Raises
    ------
    OSError
        If there is no such file, or it cannot be looked at.
    """
    member = zip_archive.split(path)
    found = os.stat(path if member is None else member[0])
    return found.st_size, found.st_mtime_ns, found.st_ctime_ns, found.st_ino


def time_of(found: os.stat_result) -> int:
    """When a file was last changed, in ns, as an integer that SQLite can hold: none after the year 2262."""
    return max(-_LARGEST, min(found.st_mtime_ns, _LARGEST))


def beside(path: Path) -> list[Path]:
    """The files in the folder of a file, itself among them, in order of their names.

    Raises
    ------
    OSError
        If the folder cannot be listed.
    UnreadableMotion
        If it is an archive that cannot be read.
    """
    member = zip_archive.split(path)
    if member is None:
        return sorted(other for other in path.parent.iterdir() if other.is_file())
    archive, name = member
    return sorted(archive / other for other in zip_archive.read_archive(archive).folders.get(dirname(name), []))


def _name_a_member(path: Path) -> str:
    members = list(zip_archive.read_archive(path).members)
    example = f", such as {path.name}/{members[0]}" if members else ""
    return f"this is an archive; index its folder, or name a file in it{example}"
