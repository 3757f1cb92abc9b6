"""motionseek: the search engine for human motion.

import motionseek
motionseek.index("my_mocap")
library = motionseek.open("my_mocap")
for hit in library.search("a person limps to the left", k=5):
    print(hit.score, hit.strength, hit.path, hit.start, hit.end)
"""

from __future__ import annotations

from os import PathLike

from motionseek_main import hidden_package as _hidden_package

if _hidden := _hidden_package():
    raise ImportError(_hidden)

from encoders.bundle.bundle import Bundle
from encoders.errors import (
    BundleError,
    BundleMismatch,
    LibraryError,
    MotionSeekError,
    QueryError,
    UnknownRig,
    UnreadableMotion,
)
from encoders.motion import Motion
from indexer.ingest.indexing import Summary, index
from indexer.ingest.load import load_motion as load
from search.hits import Hit, Step
from search.library import Library as Library


def open(folder: str | PathLike[str], *, bundle: Bundle | None = None) -> Library:
    """Open the library of an indexed folder.

    Parameters
    ----------
    folder : path
        The indexed folder, or the library folder itself.
    bundle : Bundle, optional
        The model, where it is not the default one.

    Raises
    ------
    LibraryError
        If there is no library, or it cannot be read.
    BundleMismatch
        If the library was made with another model.
    """
    return Library.open(folder, bundle=bundle)


__all__ = [
    "Bundle",
    "BundleError",
    "BundleMismatch",
    "Hit",
    "Library",
    "LibraryError",
    "Motion",
    "MotionSeekError",
    "QueryError",
    "Step",
    "Summary",
    "UnknownRig",
    "UnreadableMotion",
    "index",
    "load",
    "open",
]
