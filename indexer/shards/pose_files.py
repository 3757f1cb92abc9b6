"""PoseFiles: the stored poses of clips in a shared folder or an object store, for servers far from the library."""

from __future__ import annotations

import os
import struct
from collections.abc import Sequence
from contextlib import suppress
from os import PathLike, fspath
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

from encoders.errors import LibraryError, QueryError

_MAGIC = b"MSP1"
_COUNT = struct.Struct("<I")
#: Clips lie in so many folders.
_FOLDERS = 4096


class PoseFiles:
    """A file a clip, with the chunks of `indexer.store.poses`; written whole or not at all.

    Parameters
    ----------
    place : path or str
        A folder, or an address that fsspec knows, such as "s3://bucket/poses", for which its package is needed.
    """

    def __init__(self, place: str | PathLike[str]) -> None:
        self.place = fspath(place)
        self._store: Any = None
        if "://" in self.place:
            self._store, self._root = _store_at(self.place)
        else:
            self._root = self.place

    def write(self, clip: int, chunks: Sequence[bytes]) -> None:
        """Store the poses of a clip, in place of what there was.

        Raises
        ------
        LibraryError
            If they cannot be written.
        """
        lengths = b"".join(_COUNT.pack(len(chunk)) for chunk in chunks)
        data = _MAGIC + _COUNT.pack(len(chunks)) + lengths + b"".join(chunks)
        try:
            self._put(self._path(clip), data)
        except Exception as error:  # whatever a store raises
            raise LibraryError(f"{self.place}: poses cannot be written ({_reason(error)})") from error

    def read(self, clip: int) -> list[bytes]:
        """The chunks of a clip.

        Raises
        ------
        QueryError
            If there are none.
        LibraryError
            If they cannot be read.
        """
        try:
            data = self._get(self._path(clip))
        except FileNotFoundError:
            raise QueryError(f"the poses of clip #{clip} are not where this library's poses are kept") from None
        except Exception as error:
            raise LibraryError(f"{self.place}: poses cannot be read ({_reason(error)})") from error
        try:
            return _unpacked(data)
        except (struct.error, ValueError) as error:
            raise LibraryError(f"{self.place}: the poses of clip #{clip} are damaged ({error})") from error

    def remove(self, clip: int) -> None:
        """Remove the poses of a clip, if there are any."""
        with suppress(FileNotFoundError):
            self._store.rm_file(self._path(clip)) if self._store else Path(self._path(clip)).unlink()

    def has(self, clip: int) -> bool:
        """Whether there are poses of a clip."""
        path = self._path(clip)
        return bool(self._store.exists(path)) if self._store else os.path.exists(path)

    def _path(self, clip: int) -> str:
        return f"{self._root.rstrip('/')}/{clip % _FOLDERS:03x}/{clip:x}.poses"

    def _put(self, path: str, data: bytes) -> None:
        if self._store:
            self._store.pipe_file(path, data)
            return
        folder = Path(path).parent
        folder.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=folder, prefix=".", delete=False) as file:
            try:
                file.write(data)
                file.close()
                os.chmod(file.name, 0o644)
                os.replace(file.name, path)
            except BaseException:
                with suppress(OSError):
                    os.unlink(file.name)
                raise

    def _get(self, path: str) -> bytes:
        return bytes(self._store.cat_file(path)) if self._store else Path(path).read_bytes()


def _store_at(place: str) -> tuple[Any, str]:
    try:
        import fsspec
    except ImportError:
        raise LibraryError(f"{place}: object stores need a further package; run: pip install fsspec") from None
    try:
        store, root = fsspec.core.url_to_fs(place)
    except (ImportError, ValueError, OSError) as error:
        raise LibraryError(f"{place}: cannot be opened ({_reason(error)})") from error
    return store, str(root)


def _unpacked(data: bytes) -> list[bytes]:
    if not data.startswith(_MAGIC):
        raise ValueError("no file of poses")
    (count,) = _COUNT.unpack_from(data, 4)
    first = 4 + _COUNT.size * (count + 1)
    lengths = [_COUNT.unpack_from(data, 4 + _COUNT.size * (i + 1))[0] for i in range(count)]
    if first + sum(lengths) != len(data):
        raise ValueError("wrong size")
    chunks = []
    for length in lengths:
        chunks.append(data[first : first + length])
        first += length
    return chunks


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__
