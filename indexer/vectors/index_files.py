"""Vector indexes on disk: derived from the library, written whole or not at all, verified when read.

Each lies in a folder of its own, `<name>.<generation>.<random>`, whose manifest names the library's state it was made
from and the checksum of each part.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import time
import zlib
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np

from indexer.vectors import clustered_file
from indexer.vectors.clustered_file import RowSource
from indexer.vectors.faiss_index import FaissIndex, block_from_index

#: Generation -> what its vectors are of.
OriginOf = Callable[[int], str | None]

_FORMAT = 2
_INDEX, _OWNERS, _SPANS, _MANIFEST = "index.faiss", "owners.npy", "spans.npy", "manifest.json"
_PARTS = (_INDEX, _OWNERS, _SPANS)
#: Seconds after which a half-written index is taken for abandoned, and for which one is kept that has a successor:
#: other readers may be opening it.
_ABANDONED, _KEPT = 3600.0, 60.0
#: How often the folder is listed again where an index vanished while it was opened.
_ATTEMPTS = 4
#: Bytes read at a time.
_PIECE = 1 << 22


def save(vectors: FaissIndex, folder: Path, name: str, origin: str, *, mapped: bool = True) -> FaissIndex:
    """Write the index as `<folder>/<name>.<generation>.<random>/`: whole or not at all.

    Parameters
    ----------
    origin : str
        What the vectors are of.
    mapped : bool
        Give back the index of the files, so that the one that was written need not stay in memory.

    Raises
    ------
    OSError, RuntimeError
        Where it cannot be written; FAISS raises the latter.
    """
    import faiss

    vectors = vectors.compacted()
    block = vectors.main

    def write(fresh: Path) -> None:
        faiss.write_index(block.index, str(fresh / _INDEX))
        np.save(fresh / _OWNERS, block.owners)
        np.save(fresh / _SPANS, block.spans)

    made = _written(folder, name, vectors.generation, origin, write)
    return _read(made, vectors.generation, mapped=True) if mapped else vectors


def build(
    source: RowSource, folder: Path, name: str, generation: int, origin: str, *, mapped: bool = True
) -> FaissIndex:
    """The index of very many rows, which is written without being in memory; see `save`."""

    def write(fresh: Path) -> None:
        owners, spans = clustered_file.write(fresh / _INDEX, source)
        np.save(fresh / _OWNERS, owners)
        np.save(fresh / _SPANS, spans)

    return _read(_written(folder, name, generation, origin, write), generation, mapped=mapped)


def _written(folder: Path, name: str, generation: int, origin: str, write: Callable[[Path], None]) -> Path:
    """The new folder of an index, whose parts `write` writes: whole or not at all."""
    folder.mkdir(exist_ok=True)
    fresh = Path(tempfile.mkdtemp(prefix=f".{name}.", dir=folder))
    try:
        write(fresh)
        manifest = {
            "format": _FORMAT,
            "generation": generation,
            "origin": origin,
            "checksums": {part: _checksum(fresh / part) for part in _PARTS},
        }
        (fresh / _MANIFEST).write_text(json.dumps(manifest))
        for path in (*fresh.iterdir(), fresh):
            _sync(path)
        os.chmod(fresh, 0o755)
        made = fresh.rename(folder / f"{name}.{generation}.{fresh.name.rsplit('.', 1)[1]}")
        _sync(folder)
    except BaseException:
        shutil.rmtree(fresh, ignore_errors=True)
        raise
    _remove_superseded(folder, name)
    return made


def load(folder: Path, name: str, origin_of: OriginOf, size: int, *, mapped: bool = True) -> FaissIndex | None:
    """The newest intact index on disk of a generation and origin that the library knows; None where there is none.

    Parameters
    ----------
    origin_of : callable
        Generation -> what its vectors are of, None where the library has not been through it.
    size : int
        Of a vector.
    mapped : bool
        Map the files instead of reading them. Whoever truncates a mapped file kills the process.
    """
    for _ in range(_ATTEMPTS):
        vanished = False
        for path in _files(folder, name):
            try:
                return _load(path, origin_of, size, mapped=mapped)
            except (OSError, ValueError, KeyError, TypeError, AttributeError, RuntimeError):
                vanished |= not path.exists()  # else damaged or of another origin: the library has all it held
        if not vanished:
            break
    return None


def _load(path: Path, origin_of: OriginOf, size: int, *, mapped: bool) -> FaissIndex:
    manifest = json.loads((path / _MANIFEST).read_text())
    if manifest["format"] != _FORMAT or manifest["origin"] != origin_of(manifest["generation"]):
        raise ValueError("made from another library or model, or in another version")
    for part in _PARTS:
        if _checksum(path / part) != manifest["checksums"][part]:
            raise ValueError(f"{part} is damaged")
    vectors = _read(path, int(manifest["generation"]), mapped=mapped)
    if vectors.size != size:
        raise ValueError("vectors of another size")
    return vectors


def _read(path: Path, generation: int, *, mapped: bool) -> FaissIndex:
    import faiss

    index = faiss.read_index(str(path / _INDEX), faiss.IO_FLAG_MMAP_IFC if mapped else 0)
    mode: Literal["r"] | None = "r" if mapped else None
    owners = np.load(path / _OWNERS, mmap_mode=mode, allow_pickle=False)
    spans = np.load(path / _SPANS, mmap_mode=mode, allow_pickle=False)
    if len(owners) != index.ntotal or spans.shape != (index.ntotal, 2):
        raise ValueError("parts do not fit together")
    return FaissIndex(generation, block_from_index(owners, spans, index))


def _files(folder: Path, name: str) -> list[Path]:
    """Index folders of that name, newest generation first."""
    found = [(path.name.split("."), path) for path in folder.glob(f"{name}.*.*")]
    known = [(int(parts[1]), path) for parts, path in found if parts[1].isdecimal()]
    return [path for _, path in sorted(known, key=lambda item: (-item[0], item[1]))]


def _remove_superseded(folder: Path, name: str) -> None:
    """Remove the indexes whose successor has been there for a while, and what a killed process has half written."""

    def made(path: Path) -> float:
        try:
            return path.stat().st_mtime
        except OSError:  # another process has removed it
            return 0.0

    now, files = time.time(), sorted(_files(folder, name), key=made, reverse=True)
    old = [path for newer, path in pairwise(files) if now - made(newer) > _KEPT]
    for path in old + [path for path in folder.glob(f".{name}.*") if now - made(path) > _ABANDONED]:
        shutil.rmtree(path, ignore_errors=True)


def _checksum(path: Path) -> int:
    """CRC-32 of a file. It is read, not mapped: one that is truncated meanwhile only gives another checksum."""
    value = 0
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            value = zlib.crc32(piece, value)
    return value


def _sync(path: Path) -> None:
    """Ask for the file or folder to be on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
