"""The file that caches the map of one library generation: `map.GENERATION.npz`."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path

import numpy as np

from search.map.layout import LibraryMap


def load(folder: Path, generation: int) -> LibraryMap | None:
    """The cached map of a generation; None where there is none or it is damaged."""
    try:
        with np.load(folder / _name(generation), allow_pickle=False) as file:
            labels = tuple(json.loads(str(file["labels"])))
            return LibraryMap(generation, file["clips"], file["points"], labels, file["label"])
    except (OSError, ValueError, KeyError):
        return None


def save(folder: Path, library_map: LibraryMap) -> None:
    """Write a map and remove those of older generations; does nothing where the folder cannot be written."""
    if not os.access(folder.parent, os.W_OK):
        return
    target = folder / _name(library_map.generation)
    try:
        folder.mkdir(exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, prefix=".map.")
        with os.fdopen(handle, "wb") as file:
            np.savez(
                file,
                clips=library_map.clips,
                points=library_map.points,
                labels=np.array(json.dumps(library_map.labels)),
                label=library_map.label,
            )
        os.replace(name, target)
        for old in folder.glob("map.*.npz"):
            if old != target:
                old.unlink(missing_ok=True)
    except OSError:
        return


def _name(generation: int) -> str:
    return f"map.{generation}.npz"
