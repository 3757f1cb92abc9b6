"""Vector indexes on disk: derived from the library, written whole or not at all, verified when read.

Each lies in a folder of its own, `<name>.<generation>.<random>`, whose manifest names the library and model it was
made from and the digest of each part.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import time
from hashlib import blake2b
from pathlib import Path

import numpy as np

from indexer.vectors.faiss_index import FaissIndex, block_from_index

_FORMAT = 1
_INDEX, _OWNERS, _SPANS, _MANIFEST = "index.faiss", "owners.npy", "spans.npy", "manifest.json"
#: Seconds after which a half-written index is taken for abandoned.
_ABANDONED = 3600.0
_PARTS = (_INDEX, _OWNERS, _SPANS)


def save(vectors: FaissIndex, folder: Path, name: str, model: str) -> FaissIndex:
    """Write the index as `<folder>/<name>.<generation>.<random>/`: whole or not at all. Older ones go.

    The index that is returned is that of the files, so that the one that was written need not stay in memory.
    Raises OSError where the folder cannot be written.
    """
    import faiss

    vectors = vectors.compacted()
    folder.mkdir(exist_ok=True)
    fresh = Path(tempfile.mkdtemp(prefix=f".{name}.", dir=folder))
    try:
        block = vectors.main
        faiss.write_index(block.index, str(fresh / _INDEX))
        np.save(fresh / _OWNERS, block.owners)
        np.save(fresh / _SPANS, block.spans)
        manifest = {
            "format": _FORMAT,
            "generation": vectors.generation,
            "model": model,
            "digest": {part: _digest(fresh / part) for part in _PARTS},
        }
        (fresh / _MANIFEST).write_text(json.dumps(manifest))
        for path in (*fresh.iterdir(), fresh):
            _sync(path)
        os.chmod(fresh, 0o755)
        made = fresh.rename(folder / f"{name}.{vectors.generation}.{fresh.name.rsplit('.', 1)[1]}")
        _sync(folder)
    except BaseException:
        shutil.rmtree(fresh, ignore_errors=True)
        raise
    left = [path for path in folder.glob(f".{name}.*") if time.time() - path.stat().st_mtime > _ABANDONED]
    for old in {*_files(folder, name), *left} - {made}:
        shutil.rmtree(old, ignore_errors=True)
    return _mapped(made, vectors.generation)


def load(folder: Path, name: str, model: str, size: int) -> FaissIndex | None:
    """The newest intact index of this model on disk, memory-mapped; None where there is none."""
    for path in _files(folder, name):
        try:
            return _load(path, model, size)
        except (OSError, ValueError, KeyError, RuntimeError):
            continue  # damaged, half deleted or of another model: the library has all it held
    return None


def _load(path: Path, model: str, size: int) -> FaissIndex:
    manifest = json.loads((path / _MANIFEST).read_text())
    if manifest["format"] != _FORMAT or manifest["model"] != model:
        raise ValueError("made from another model or in another version")
    for part, digest in manifest["digest"].items():
        if part not in _PARTS or _digest(path / part) != digest:
            raise ValueError(f"{part} is damaged")
    vectors = _mapped(path, int(manifest["generation"]))
    if vectors.size != size:
        raise ValueError("vectors of another size")
    return vectors


def _mapped(path: Path, generation: int) -> FaissIndex:
    import faiss

    index = faiss.read_index(str(path / _INDEX), faiss.IO_FLAG_MMAP_IFC)
    owners = np.load(path / _OWNERS, mmap_mode="r", allow_pickle=False)
    spans = np.load(path / _SPANS, mmap_mode="r", allow_pickle=False)
    if len(owners) != index.ntotal or spans.shape != (index.ntotal, 2):
        raise ValueError("parts do not fit together")
    return FaissIndex(generation, block_from_index(owners, spans, index))


def _files(folder: Path, name: str) -> list[Path]:
    """Index folders of that name, newest generation first."""
    found = [(path.name.split("."), path) for path in folder.glob(f"{name}.*.*")]
    return [
        path
        for parts, path in sorted(found, key=lambda item: (-int(item[0][1]) if item[0][1].isdigit() else 1, item[1]))
        if parts[1].isdigit()
    ]


def _digest(path: Path) -> str:
    """A checksum at memory speed: sums of 4 KiB blocks, hashed with the size."""
    data = np.memmap(path, np.uint8, "r")
    whole = len(data) // 4096 * 4096
    sums = data[:whole].view(np.uint64).reshape(-1, 512).sum(axis=1, dtype=np.uint64)
    return blake2b(sums.tobytes() + data[whole:].tobytes() + str(len(data)).encode(), digest_size=16).hexdigest()


def _sync(path: Path) -> None:
    """Ask for the file or folder to be on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
