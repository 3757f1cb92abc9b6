"""Approximate search among many rows: only the clusters nearest to a query are probed (an inverted file, IVF).

Exact search reads every vector, which at a million rows takes as long as memory takes to deliver half a gigabyte. Here
a row is missed where its cluster is not among those probed. Of the ten best of 100,000 clips nearly all are found,
of the 160 best of their 2.4 million windows 98 in 100 and more: `benchmarks/serve.py` prints how many.
Vectors without any clusters, random ones or those of an untrained model, are what it cannot do.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import Block, IndexRows, Mask, SearchResult

#: Clusters probed for a query; more where a filter leaves few rows, so that as many rows are compared.
PROBES = 32

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

        count, rng = int(np.sqrt(len(rows))), np.random.default_rng(0)
        sample = np.sort(rng.permutation(len(rows))[: count * _SAMPLE])
        centres = _centres(rows.vectors[sample].astype(np.float32), count, rng)
        flat, size = faiss.IndexFlatIP(centres.shape[1]), centres.shape[1]
        flat.add(centres)
        fp16, inner = faiss.ScalarQuantizer.QT_fp16, faiss.METRIC_INNER_PRODUCT
        index = faiss.IndexIVFScalarQuantizer(flat, size, count, fp16, inner, False)
        index.is_trained = True
        for first in range(0, len(rows), _CHUNK):
            vectors = rows.vectors[first : first + _CHUNK].astype(np.float32)
            nearest, places = _nearest(vectors, centres), np.arange(first, first + len(vectors))
            index.add_core(len(places), *(faiss.swig_ptr(given) for given in (vectors, places, nearest)))
        return cls(rows.owners, rows.spans, index)

    @property
    def rows(self) -> IndexRows:
        """The rows in their order; the vectors are a copy."""
        import faiss

        lists, size = self.index.invlists, self.index.d
        vectors = np.empty((self.index.ntotal, size), np.float16)
        for cluster in range(self.index.nlist):
            count = lists.list_size(cluster)
            if count:
                places = faiss.rev_swig_ptr(lists.get_ids(cluster), count)
                codes = faiss.rev_swig_ptr(lists.get_codes(cluster), count * size * 2)
                vectors[places] = codes.view(np.float16).reshape(count, size)
        return IndexRows(self.owners, self.spans, vectors)

    def search(self, queries: NDArray[np.float32], k: int, mask: Mask | None) -> SearchResult:
        """See `Block.search`."""
        import faiss

        faiss.omp_set_num_threads(1)
        share = 1.0 if mask is None else max(mask.count / len(self), 1e-9)
        probes = min(int(np.ceil(PROBES / share)), self.index.nlist)
        selector, parameters = cast(Any, faiss.IDSelectorBitmap), cast(Any, faiss.SearchParametersIVF)
        chosen = {} if mask is None else {"sel": selector(mask.bits)}
        return self._found(*self.index.search(queries, k, params=parameters(nprobe=probes, **chosen)))


def _centres(points: NDArray[np.float32], count: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """Centres (count, D) of clusters of unit vectors (n, D): spherical k-means (Dhillon and Modha, 2001).

    By NumPy's matrix product this is about five times as fast as by that of FAISS's packages.
    """
    centres = points[rng.choice(len(points), count, replace=False)]
    for _ in range(_ROUNDS):
        nearest = np.concatenate(
            [_nearest(points[first : first + _CHUNK], centres) for first in range(0, len(points), _CHUNK)]
        )
        filled, starts = np.unique(np.sort(nearest), return_index=True)
        centres = points[rng.choice(len(points), count)]  # where a cluster is empty, it begins anew
        centres[filled] = np.add.reduceat(points[np.argsort(nearest, kind="stable")], starts)
        centres /= np.maximum(np.linalg.norm(centres, axis=1, keepdims=True), 1e-12)
    return centres


def _nearest(vectors: NDArray[np.float32], centres: NDArray[np.float32]) -> NDArray[np.int64]:
    return np.asarray(np.argmax(vectors @ centres.T, axis=1), np.int64)
