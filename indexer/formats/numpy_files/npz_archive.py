"""A `.npz` archive, open: its arrays by name, each checked before it is unpacked."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from typing import Any

from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.numpy_files import npy

#: Unpacked, an array may be so large.
MAX_BYTES = 256 << 20
_MAX_WORD_BYTES = 1 << 10
#: Arrays of an archive that are looked at.
_MAX_ARRAYS = 256
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


class NpzArchive:
    """The arrays of an archive; `names` are without their ending. Nothing is unpickled."""

    def __init__(self, path: str | PathLike[str], archive: zipfile.ZipFile) -> None:
        self.path, self._archive = path, archive
        infos = [info for info in archive.infolist() if info.filename.endswith(".npy")][:_MAX_ARRAYS]
        self._infos = {info.filename.removesuffix(".npy"): info for info in infos}
        self.names = set(self._infos)

    def shapes(self) -> dict[str, tuple[int, ...] | None]:
        """The shape of each array of numbers, None of anything else, by name."""
        return {name: self._shape(name) for name in self._infos}

    def array(self, name: str) -> NDArray[Any]:
        """An array of numbers."""
        return npy.load_array(self.path, self._member(name, MAX_BYTES))

    def number(self, name: str) -> float:
        """An array of one number."""
        return npy.load_number(self.path, self._member(name, _MAX_WORD_BYTES))

    def word(self, name: str) -> str:
        """An array of one word."""
        return npy.load_word(self.path, self._member(name, _MAX_WORD_BYTES))

    def _shape(self, name: str) -> tuple[int, ...] | None:
        info = self._infos[name]
        if info.compress_type not in _PACKED:
            return None
        with self._archive.open(info) as file:
            start = file.read(npy.HEADER_BYTES)
        try:
            header = npy.header_of(self.path, start)
        except UnreadableMotion:
            return None
        return header.shape if header.dtype.kind in "fiu" else None

    def _member(self, name: str, limit: int) -> bytes:
        """An array's file, unpacked; no more of it than the archive announces, and that is at most `limit` bytes."""
        info = self._infos[name]
        if info.compress_type not in _PACKED:
            raise UnreadableMotion(self.path, f"{info.filename} is packed in a way that NumPy does not write")
        if info.file_size > limit:
            raise UnreadableMotion(self.path, f"{info.filename} is larger than {limit} bytes; cut it into takes")
        with self._archive.open(info) as file:
            return file.read(info.file_size)


@contextmanager
def opened(path: str | PathLike[str], data: bytes) -> Iterator[NpzArchive]:
    """An archive while it is open.

    Raises
    ------
    UnreadableMotion
        If it is damaged, then or when an array is taken from it.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            yield NpzArchive(path, archive)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise UnreadableMotion(path, f"the archive is damaged: {str(error)[:200]}") from None
