"""The FAISS file of very many rows in clusters, written piece by piece: memory grows with the rows, not their vectors.

`ClusteredBlock.of` makes the same index in memory. FAISS's file ends with the lists of its clusters, one after the
other; their places are known once each row has its cluster.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import IndexRows
from indexer.vectors.clustered import empty_index, find_centres, nearest_centres, sampled

#: How FAISS ends an index without rows: the sizes of no lists.
_NO_LISTS = b"sprs" + bytes(8)
_ID = 8  # bytes


@dataclass(frozen=True)
class RowSource:
    """Rows that are read in pieces, as often as needed, always the same ones in the same order.

    Attributes
    ----------
    size : int
        Size D of a vector.
    pieces : callable
        Their `IndexRows`, a few thousand rows each.
    """

    size: int
    pieces: Callable[[], Iterator[IndexRows]]


def write(path: Path, source: RowSource) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Write the index over all rows; their owners (n,) and spans (n, 2).

    Raises
    ------
    OSError
        Where it cannot be written.
    RuntimeError
        If this version of FAISS has files of another form.
    """
    import faiss

    kept = [(rows.owners, rows.spans) for rows in source.pieces()]
    owners, spans = (np.concatenate(parts) for parts in zip(*kept, strict=True))
    del kept
    centres = find_centres(_sample(source, len(owners)), len(owners))
    clusters = np.concatenate([nearest_centres(rows.vectors, centres) for rows in source.pieces()]).astype(np.int32)
    index = empty_index(centres)
    index.ntotal = len(owners)
    head = faiss.serialize_index(index).tobytes()
    if not head.endswith(_NO_LISTS):
        raise RuntimeError("this version of FAISS writes other files")
    counts = np.bincount(clusters, minlength=len(centres))
    with path.open("xb") as file:
        file.write(head[: -len(_NO_LISTS)] + b"full" + np.array([len(counts), *counts], "<u8").tobytes())
        bytes_a_row = 2 * source.size + _ID
        starts = file.tell() + (np.cumsum(counts) - counts) * bytes_a_row
        codes, ids = starts.copy(), starts + counts * 2 * source.size
        first = 0
        for rows in source.pieces():
            mine = clusters[first : first + len(rows)]
            order = np.argsort(mine, kind="stable")
            vectors, places = rows.vectors[order], (order + first).astype("<i8")
            found, begin = np.unique(mine[order], return_index=True)
            for cluster, start, stop in zip(found, begin, [*begin[1:], len(mine)], strict=True):
                file.seek(codes[cluster])
                codes[cluster] += file.write(vectors[start:stop].astype("<f2").data.cast("B"))
                file.seek(ids[cluster])
                ids[cluster] += file.write(places[start:stop].data.cast("B"))
            first += len(rows)
    return owners, spans


def _sample(source: RowSource, count: int) -> NDArray[np.float16]:
    """The vectors of the rows that clusters are found from."""
    wanted, first, found = sampled(count), 0, []
    for rows in source.pieces():
        begin, end = np.searchsorted(wanted, (first, first + len(rows)))
        found.append(rows.vectors[wanted[begin:end] - first])
        first += len(rows)
    return np.concatenate(found)
