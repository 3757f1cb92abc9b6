"""Opening a library wherever it is: a folder, or a collection of Milvus."""

from __future__ import annotations

from os import PathLike

from encoders.arguments import checked_flag
from encoders.errors import ArgumentError
from encoders.protocol import Encoder
from indexer.vectors.milvus.milvus_address import is_milvus_address
from search.library import Library


def open_library(
    folder: str | PathLike[str],
    *,
    bundle: Encoder | None = None,
    create: bool = False,
    poses: str | PathLike[str] | None = None,
) -> Library:
    """Open the library of an indexed folder, a library folder itself, or a collection of Milvus.

    Parameters
    ----------
    folder : path or str
        A folder; "milvus://HOST:PORT/COLLECTION"; or a file of milvus-lite, "NAME.db".
    bundle : Encoder, optional
        The model; if not given, that of the library is found where models are kept when it is first needed.
    create : bool
        Make a folder an empty library where it is none yet.
    poses : path or str, optional
        Of a collection, where its poses were put; see `motionseek.index`.

    Raises
    ------
    ArgumentError
        If an argument is of a wrong type.
    LibraryNotFound
        If there is no library.
    LibraryDamaged, LibraryError
        If it cannot be read.
    BundleMismatch
        If `bundle` is not the model whose vectors the library holds.
    """
    if isinstance(folder, (str, PathLike)) and is_milvus_address(folder):
        if checked_flag("create", create):
            raise ArgumentError(f"create: 'motionseek index FOLDER --vectors {folder}' makes a collection")
        from search.milvus_library import MilvusLibrary

        return MilvusLibrary(str(folder), bundle=bundle, poses=poses)
    if poses is not None:
        raise ArgumentError("poses is for a collection of Milvus; a folder has its poses itself")
    return Library.open(folder, bundle=bundle, create=create)
