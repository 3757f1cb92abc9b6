"""ZIP archives as folders: what one holds, and what a member holds. Read in place; nothing it states is trusted."""

from __future__ import annotations

import io
import lzma
import os
import re
import stat
import struct
import zipfile
import zlib
from collections import defaultdict
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from posixpath import dirname
from typing import Any, BinaryIO

from encoders.arguments import is_text
from encoders.errors import UnreadableMotion

ENDING = ".zip"
#: Bytes of an archive's directory, and members in it.
MAX_DIRECTORY, MAX_MEMBERS = 16 << 20, 100_000
#: Bytes a member may unpack to; and how often its packed size, where it is larger than `_SMALL`.
MAX_MEMBER, _MAX_RATIO, _SMALL = 1 << 30, 250, 16 << 20

_ENCRYPTED = 0x1
_UTF8 = 0x800
_LOCAL_HEADER = 30
_DAMAGE = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error, EOFError, NotImplementedError, OverflowError,
    RuntimeError, ValueError,
)  # fmt: skip

#: Control characters, and the backslash, which is a separator on some systems.
_NOT_IN_NAMES = re.compile(r"[\x00-\x1f\x7f-\x9f\\]")

_NESTED = "archives in it passed over, to be unpacked"
_ODD_NAMES = "files passed over whose names lead out of the archive or are none"
_LINKS = "symbolic links in it passed over"
_TWICE = "files passed over that share their name with a later one"


@dataclass(frozen=True)
class Archive:
    """The directory of an archive.

    Attributes
    ----------
    members : dict
        Name -> what the archive states about it, in the order of the archive.
    folders : dict
        The name of a folder, empty for the archive itself -> the names of the files in it.
    remarks : dict
        Why members are passed over -> their names.
    """

    members: dict[str, zipfile.ZipInfo] = field(default_factory=dict)
    folders: dict[str, list[str]] = field(default_factory=dict)
    remarks: dict[str, list[str]] = field(default_factory=dict)


def split(path: Path) -> tuple[Path, str] | None:
    """The archive and the name of a member, of a path such as `pack.zip/walk.bvh`; None for any other."""
    if ENDING not in str(path).lower():
        return None
    for above in path.parents:
        if above.suffix.lower() == ENDING and os.path.isfile(above):
            return above, path.relative_to(above).as_posix()
    return None


def read_archive(file: Path) -> Archive:
    """The directory of an archive.

    Raises
    ------
    UnreadableMotion
        If it is damaged or no archive, or has too many members.
    OSError
        If it cannot be opened.
    """
    state = os.stat(file)
    return _read_archive(file, state.st_size, state.st_mtime_ns, state.st_ino)


def refusal(info: zipfile.ZipInfo) -> str:
    """Why a member is not read, by what the archive states about it; empty if it is."""
    if info.flag_bits & _ENCRYPTED:
        return "it is encrypted; unpack the archive with its password"
    if info.file_size > MAX_MEMBER:
        return f"it unpacks to more than {MAX_MEMBER >> 30} GB; unpack the archive"
    if info.file_size > max(_SMALL, _MAX_RATIO * info.compress_size):
        return f"it unpacks to more than {_MAX_RATIO} times its size, as no motion does; else unpack the archive"
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        return f"it is packed by a method that is not known (number {info.compress_type}); unpack the archive"
    return ""


def open_member(file: Path, name: str) -> BinaryIO:
    """Open a member for reading; a damaged one raises UnreadableMotion while it is read.

    Raises
    ------
    FileNotFoundError
        If the archive has no such member.
    UnreadableMotion
        If the archive or the member cannot be read; see `refusal`.
    OSError
        If the archive cannot be opened.
    """
    info = read_archive(file).members.get(name)
    if info is None:
        raise FileNotFoundError(2, "no such file in the archive", str(file / name))
    if reason := refusal(info):
        raise UnreadableMotion(file / name, reason)
    raw = file.open("rb")
    try:
        raw.seek(info.header_offset)
        header = raw.read(_LOCAL_HEADER)
        if len(header) < _LOCAL_HEADER or not header.startswith(b"PK\x03\x04"):
            raise UnreadableMotion(file / name, "the archive is damaged: the file does not begin where it states")
        raw.seek(sum(struct.unpack("<HH", header[26:])), os.SEEK_CUR)
        return io.BufferedReader(_Member(file / name, zipfile.ZipExtFile(raw, "r", info, close_fileobj=True)))
    except BaseException:
        raw.close()
        raise


class _Member(io.RawIOBase):
    """The content of a member; what damage raises becomes UnreadableMotion."""

    def __init__(self, path: Path, content: zipfile.ZipExtFile) -> None:
        self._path, self._content = path, content

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        data = self._read(len(buffer))
        buffer[: len(data)] = data
        return len(data)

    def readall(self) -> bytes:
        return self._read(-1)

    def _read(self, size: int) -> bytes:
        try:
            return self._content.read(size)
        except _DAMAGE as error:
            raise UnreadableMotion(self._path, f"the archive is damaged ({error})") from None

    def close(self) -> None:
        self._content.close()
        super().close()


class _Bounded(io.BufferedReader):
    """A file of which only short pieces can be read, however long the archive says that its directory is."""

    def read(self, size: int | None = -1, /) -> bytes:
        if size is None or size < 0:
            return super().read(MAX_DIRECTORY)
        if size > MAX_DIRECTORY:
            raise zipfile.BadZipFile("its directory is too long")
        return super().read(size)


@lru_cache(maxsize=2)
def _read_archive(file: Path, size: int, mtime_ns: int, inode: int) -> Archive:
    try:
        with _Bounded(io.FileIO(file)) as raw, zipfile.ZipFile(raw) as archive:
            infos = archive.infolist()
    except _DAMAGE as error:
        raise UnreadableMotion(file, f"the archive is damaged or no ZIP ({error}); unpack or fetch it again") from None
    if len(infos) > MAX_MEMBERS or sum(info.compress_size for info in infos) > size:
        what = f"more than {MAX_MEMBERS} files" if len(infos) > MAX_MEMBERS else "files that overlap"
        raise UnreadableMotion(file, f"the archive holds {what}; unpack it")
    return _arranged(infos)


def _arranged(infos: list[zipfile.ZipInfo]) -> Archive:
    archive, remarks, folders = Archive(), defaultdict[str, list[str]](list), defaultdict[str, list[str]](list)
    for info in infos:
        name = _name(info)
        parts = name.split("/")
        if name.endswith("/") or any(part.startswith(".") and part.strip(".") for part in parts):
            continue  # a folder, or hidden
        if parts[0] == "__MACOSX":  # what macOS adds to each file
            continue
        if set(parts) & {"", ".", ".."} or name[1:2] == ":" or _NOT_IN_NAMES.search(name) or not is_text(name):
            remarks[_ODD_NAMES].append(name)
        elif stat.S_ISLNK(info.external_attr >> 16):
            remarks[_LINKS].append(name)
        elif name.lower().endswith(ENDING):
            remarks[_NESTED].append(name)
        else:
            if name in archive.members:
                remarks[_TWICE].append(name)
            archive.members[name] = info
    for name in archive.members:
        folders[dirname(name)].append(name)
    archive.folders.update(folders)
    archive.remarks.update(remarks)
    return archive


def _name(info: zipfile.ZipInfo) -> str:
    """A member's name; many programs write UTF-8 without saying so, where the standard has another encoding."""
    if info.flag_bits & _UTF8:
        return info.orig_filename
    try:
        return info.orig_filename.encode("cp437").decode()
    except UnicodeError:
        return info.orig_filename
