"""The file that keeps the shapes and copies of a library, so that only what changed is computed again: `shapes.npz`.

Derived: it may be deleted at any time.
"""

from __future__ import annotations

import os
import tempfile
import zipfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from search.stacks.copies import NO_PAIRS, Pairs, Shapes, blank
from search.stacks.shapes import SIZE

FILE = "shapes.npz"
#: Of the way shapes are computed: another makes older files useless.
_VERSION = 1


class Computed(NamedTuple):
    """What was computed for a library: of each clip its id and generation (N,), its shape, and the pairs of copies.

    Pairs are of rows.
    """

    identity: int
    ids: NDArray[np.int64]
    generations: NDArray[np.int64]
    shapes: Shapes
    pairs: Pairs


def nothing(identity: int) -> Computed:
    """Nothing computed yet for the library of that identity."""
    none = np.empty(0, np.int64)
    return Computed(identity, none, none, blank(0), NO_PAIRS)


def load(folder: Path, identity: int) -> Computed:
    """What the file holds for the library of that identity; nothing where it is of another, damaged, or not there."""
    try:
        with np.load(folder / FILE, allow_pickle=False) as file:
            if file["state"].tolist() != [_VERSION, identity]:
                return nothing(identity)
            shapes = Shapes(file["vectors"], file["durations"], file["ways"])
            held = Computed(identity, file["ids"], file["generations"], shapes, (file["pairs"], file["flags"]))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return nothing(identity)
    return held if _is_whole(held) else nothing(identity)


def save(folder: Path, held: Computed) -> None:
    """Write the file; does nothing where the folder cannot be written."""
    if not os.access(folder.parent, os.W_OK):
        return
    try:
        folder.mkdir(exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, prefix=".shapes.")
        with os.fdopen(handle, "wb") as file:
            np.savez(
                file,
                state=np.array([_VERSION, held.identity]),
                ids=held.ids,
                generations=held.generations,
                vectors=held.shapes.vectors,
                durations=held.shapes.durations,
                ways=held.shapes.ways,
                pairs=held.pairs[0],
                flags=held.pairs[1],
            )
        os.replace(name, folder / FILE)
    except OSError:
        return


def _is_whole(held: Computed) -> bool:
    """Whether all parts are of the kinds and lengths that `save` writes."""
    count, (pairs, flags) = len(held.ids), held.pairs
    return (
        held.shapes.vectors.shape == (count, SIZE)
        and held.generations.shape == held.shapes.durations.shape == held.shapes.ways.shape == (count,)
        and pairs.shape == (len(flags), 2)
        and bool(((pairs >= 0) & (pairs < count)).all())
    )
