"""Approximate search among many rows: only the clusters nearest to a query are probed (an inverted file, IVF).

Exact search reads every vector, which at a million rows takes as long as memory takes to deliver half a gigabyte. Here
a row is missed where its cluster is not among those probed. Of the ten best of 100,000 clips nearly all are found,
of the 160 best of their 2.4 million windows 98 in 100 and more: `benchmarks/serve.py` prints how many.
Vectors without any clusters, random ones or those of an untrained model, are what it cannot do.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import Block, IndexRows, Mask, SearchResult

#: Clusters probed for a query. The best of the rows that a filter leaves lie further off: where a hundredth is left ten
#: times as many are probed. `benchmarks.scale` prints what is found so.
PROBES = 32
#: Where a filter leaves fewer rows than so many for each that is wanted, all clusters are probed: none may be missing.
_FEW = 4

#: Rounds of k-means, and rows a cluster that take part. With half of both, 2 in 100 of the best of 2.8 million are
#: missed that are found so.
_ROUNDS, _SAMPLE = 8, 48
_CHUNK = 1 << 12  # rows compared with the centres at once


class ClusteredBlock(Block):
    """Rows in clusters; answers as `Block` does, but for the rows it misses."""

    @classmethod
    def of(cls, rows: IndexRows) -> ClusteredBlock:
        """Find clusters, about as many as the square root of the rows, and sort the rows into them."""
        import faiss

        centres = find_centres(rows.vectors[sampled(len(rows))], len(rows))
        index = empty_index(centres)
        for first in range(0, len(rows), _CHUNK):
            vectors = rows.vectors[first : first + _CHUNK].astype(np.float32)
            nearest, places = nearest_centres(vectors, centres), np.arange(first, first + len(vectors))
            index.add_core(len(places), *(faiss.swig_ptr(given) for given in (vectors, places, nearest)))
        return cls(rows.owners, rows.spans, index)

    @property
    def rows(self) -> IndexRows:
        """The rows in their order; the vectors are a copy."""
        vectors = np.empty((self.index.ntotal, self.index.d), np.float16)
        for places, part in self.pieces():
            vectors[places] = part
        return IndexRows(self.owners, self.spans, vectors)

    def pieces(self) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float16]]]:
        """See `Block.pieces`: a cluster at a time, as views of the index's memory."""
        import faiss

        lists, size = self.index.invlists, self.index.d
        for cluster in range(self.index.nlist):
            count = lists.list_size(cluster)
            if count:
                places = faiss.rev_swig_ptr(lists.get_ids(cluster), count)
                codes = faiss.rev_swig_ptr(lists.get_codes(cluster), count * size * 2)
                yield places, codes.view(np.float16).reshape(count, size)

    def vectors_of(self, rows: NDArray[np.int64]) -> NDArray[np.floating]:
        """See `Block.vectors_of`; in single precision. The first call makes a table of the place of every row."""
        return np.asarray(self._direct.reconstruct_batch(rows))

    @cached_property
    def _direct(self) -> Any:
        self.index.make_direct_map()
        return self.index

    def search(self, queries: NDArray[np.float32], k: int, mask: Mask | None, *, exact: bool = False) -> SearchResult:
        """See `Block.search`; all clusters are probed where it is to be exact."""
        import faiss

        faiss.omp_set_num_threads(1)
        left = len(self) if mask is None else mask.count
        probes = int(np.ceil(PROBES * (len(self) / max(left, 1)) ** 0.5))
        if exact or left <= _FEW * k:
            probes = self.index.nlist
        selector, parameters = cast(Any, faiss.IDSelectorBitmap), cast(Any, faiss.SearchParametersIVF)
        chosen = {} if mask is None else {"sel": selector(mask.bits)}
        return self._found(
            *self.index.search(queries, k, params=parameters(nprobe=min(probes, self.index.nlist), **chosen))
        )


def sampled(count: int) -> NDArray[np.int64]:
    """The numbers of the rows, of `count`, that clusters are found from, in order."""
    return np.sort(np.random.default_rng(0).permutation(count)[: int(np.sqrt(count)) * _SAMPLE])


def empty_index(centres: NDArray[np.float32]) -> Any:
    """A FAISS index of clusters without rows."""
    import faiss

    count, size = centres.shape
    flat = faiss.IndexFlatIP(size)
    flat.add(centres)
    fp16, inner = faiss.ScalarQuantizer.QT_fp16, faiss.METRIC_INNER_PRODUCT
    index = faiss.IndexIVFScalarQuantizer(flat, size, count, fp16, inner, False)
    index.is_trained = True
    return index


def find_centres(points: NDArray[np.float16], rows: int) -> NDArray[np.float32]:
    """Centres (C, D) of clusters, about as many as the square root of the rows, from some of them (n, D).

    Spherical k-means (Dhillon and Modha, 2001). By NumPy's matrix product this is about five times as fast as by that
    of FAISS's packages.
    """
    count, rng = int(np.sqrt(rows)), np.random.default_rng(0)
    centres = points[rng.choice(len(points), count, replace=False)].astype(np.float32)
    for _ in range(_ROUNDS):
        sums, filled = np.zeros_like(centres), np.zeros(count, np.bool_)
        for first in range(0, len(points), _CHUNK):
            piece = points[first : first + _CHUNK].astype(np.float32)
            nearest = nearest_centres(piece, centres)
            found, starts = np.unique(np.sort(nearest), return_index=True)
            sums[found] += np.add.reduceat(piece[np.argsort(nearest, kind="stable")], starts)
            filled[found] = True
        again = points[rng.choice(len(points), count)]  # where a cluster is empty, it begins anew
        centres = np.where(filled[:, None], sums, again.astype(np.float32))
        centres /= np.maximum(np.linalg.norm(centres, axis=1, keepdims=True), 1e-12)
    return centres


def nearest_centres(vectors: NDArray[np.floating], centres: NDArray[np.float32]) -> NDArray[np.int64]:
    """The number of the nearest centre of each vector."""
    pieces = [vectors[first : first + _CHUNK] for first in range(0, len(vectors), _CHUNK)]
    found = [np.argmax(piece.astype(np.float32, copy=False) @ centres.T, axis=1) for piece in pieces]
    return np.concatenate(found).astype(np.int64)
