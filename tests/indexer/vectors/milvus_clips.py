"""Clips in a collection of milvus-lite, made up from rows."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from indexer.vectors.blocks import IndexRows

if TYPE_CHECKING:
    from indexer.vectors.milvus.collection_schema import StoredClip
    from indexer.vectors.milvus.milvus_collection import MilvusCollection

MODEL = ("f" * 64, "tiny")


@contextmanager
def opened(file: Path, size: int, fingerprint: str = MODEL[0]) -> Iterator[MilvusCollection]:
    """The collection of a file, made where there is none."""
    from indexer.vectors.milvus.milvus_address import MilvusAddress
    from indexer.vectors.milvus.milvus_collection import MilvusCollection

    collection = MilvusCollection(MilvusAddress.of(file), create=(fingerprint, MODEL[1], size))
    try:
        yield collection
    finally:
        collection.close()


def made_clip(number: int, windows: IndexRows, version: int = 1, path: str | None = None) -> StoredClip:
    """A clip whose windows are rows, and whose vector is that of the first of them."""
    from indexer.vectors.milvus.collection_schema import FIELDS, StoredClip

    blank = {"VARCHAR": "", "ARRAY": [], "JSON": {}, "BOOL": False}
    fields = {name: blank.get(kind, 0) for name, (kind, _) in FIELDS.items()}
    path = f"takes/{number}.bvh" if path is None else path
    fields |= {"clip": number, "version": version, "root": "takes", "path": path, "folded": path, "duration": 9.0}
    lengths = np.full(len(windows), 1.6, np.float32)
    return StoredClip(fields, windows.vectors[0], lengths, *windows.spans.T, windows.vectors)


def filled(collection: MilvusCollection, held: IndexRows) -> None:
    """Put rows into a collection, a clip for each owner."""
    clips = [made_clip(int(owner), held[held.owners == owner]) for owner in np.unique(held.owners)]
    assert collection.put(clips) == []
