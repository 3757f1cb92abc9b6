"""The layout of the map of many clips: time, memory, reports of progress, and neighbours that stay neighbours.

    python -m benchmarks.map_layout FOLDER --clips 100000

The clips are those of the library of FOLDER, each many times, its vector moved a little (as in `benchmarks.simulated`).
openTSNE (extra `map`) is beside the layout that is used without it. Of the thirty nearest clips of 300, the share that
is among the thirty nearest on the map is printed.
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from indexer.store.stored_library import StoredLibrary
from indexer.vectors.library_indexes import CLIPS
from search.map.layout import lay_out

Array = NDArray[np.float32]
_NOISE, _ASKED, _NEAREST = 0.5, 300, 30


def main() -> None:
    """Print the measurements."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--clips", type=int, default=100_000)
    given = parser.parse_args()
    vectors = moved(given.folder, given.clips)
    for name, library in (("without openTSNE", False), ("openTSNE", True)):
        print(f"{name}: {measured(vectors, library)}", flush=True)


def moved(folder: Path, count: int) -> Array:
    """That many unit vectors (N, D) around those of a library's clips."""
    rng = np.random.default_rng(0)
    with StoredLibrary.open(folder) as library, library.reading() as connection:
        real = library.indexes.current(CLIPS, connection).rows.vectors.astype(np.float32)
    near = real[rng.integers(len(real), size=count)]
    near += _NOISE / 2 / 16 * rng.standard_normal(near.shape, np.float32)
    vectors: Array = near / np.linalg.norm(near, axis=1, keepdims=True)
    return vectors


def measured(vectors: Array, library: bool) -> str:
    """Lay vectors out: what it took, as text."""
    began, began_cpu = time.perf_counter(), time.process_time()
    told = [began]
    points = lay_out(vectors, library=library, progress=lambda _: told.append(time.perf_counter()))
    wall, cpu = time.perf_counter() - began, time.process_time() - began_cpu
    silent = max(np.diff([*told, began + wall]))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    return (
        f"{wall:.0f} s ({cpu:.0f} s of CPU), {memory:.0f} MB at most, progress {len(told) - 1} times, "
        f"at most {silent:.1f} s apart, {100 * kept(vectors, points):.0f} % of the neighbours kept"
    )


def kept(vectors: Array, points: Array) -> float:
    """The share of the nearest vectors of some that are among the nearest points."""
    shares = []
    for i in np.random.default_rng(1).choice(len(vectors), _ASKED, replace=False):
        near = nearest(-(vectors @ vectors[i]), int(i))
        shares.append(len(near & nearest(((points - points[i]) ** 2).sum(axis=1), int(i))) / _NEAREST)
    return float(np.mean(shares))


def nearest(distances: Array, but: int) -> set[int]:
    """Where the smallest distances are, without one place."""
    return set(np.argpartition(distances, _NEAREST)[: _NEAREST + 1].tolist()) - {but}


if __name__ == "__main__":
    main()
