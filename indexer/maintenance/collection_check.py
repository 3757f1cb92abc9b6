"""Check a collection of Milvus against the library that fills it, and bring it back in step."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

from indexer.maintenance.check import Fault
from indexer.shards.in_step import bring_in_step, out_of_step
from indexer.shards.pose_files import PoseFiles
from indexer.shards.shard import Shard
from indexer.store.stored_library import StoredLibrary
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection


def check_collection(
    folder: Path,
    vectors: str,
    *,
    shard: str | None = None,
    repair: bool = False,
    poses: str | None = None,
) -> tuple[list[Fault], list[Fault]]:
    """What a collection has otherwise than a library, those files of its shard; and what is left of it.

    Parameters
    ----------
    folder : path
        The library folder.
    vectors : str
        See `indexer.ingest.indexing.index`.
    repair : bool
        Bring it in step, by the library; else all is left.
    poses : str, optional
        Where the poses go of what is put there anew.

    Raises
    ------
    ArgumentError, LibraryError
        If an address is none, or Milvus or the library cannot be reached.
    """
    part, place = Shard.of(shard), None if poses is None else PoseFiles(poses)
    with (
        StoredLibrary.open(folder) as library,
        closing(MilvusCollection(MilvusAddress.of(vectors), create=_model(library))) as collection,
    ):
        found = [Fault(*fault) for fault in out_of_step(library, collection, part)]
        if not found or not repair:
            return found, found
        refused = bring_in_step(library, collection, part, poses=place, thorough=True).refused
        return found, [Fault(*fault) for fault in [*out_of_step(library, collection, part), *refused]]


def _model(library: StoredLibrary) -> tuple[str, str, int]:
    model = library.bundle
    return model.fingerprint, model.name, model.latent_size
