"""Many rows, found fast: only the clusters nearest to a query are looked at (an inverted file, IVF).

Exact search reads every vector, which at a million rows takes as long as memory takes to deliver half a gigabyte. Here
a row is missed where its cluster is not among those looked at: of the ten best of 100,000 clips with 2.4 million
windows of a trained model, 995 in 1,000 were found (`benchmarks/serve.py` measures it). Vectors without any clusters,
random ones or those of an untrained model, are what it cannot do.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from indexer.vectors import Block, Found, Rows

#: Clusters looked at for a query. Filters that leave few rows make it more, so that as many rows are compared.
PROBES = 32

_ROUNDS = 8
_SAMPLE = 48  # rows a cluster that take part in finding the clusters
_CHUNK = 1 << 16


class ClusteredBlock(Block):
    """Rows in clusters; answers as `Block` does, but for the rows it misses."""

    @classmethod
    def of(cls, rows: Rows) -> ClusteredBlock:
        """Find clusters, about as many as the square root of the rows, and sort the rows into them."""
        import faiss

        size, count = rows.vectors.shape[1], int(np.sqrt(len(rows)))
        centres = faiss.IndexFlatIP(size)
        fp16, inner = faiss.ScalarQuantizer.QT_fp16, faiss.METRIC_INNER_PRODUCT
        index = faiss.IndexIVFScalarQuantizer(centres, size, count, fp16, inner, False)
        clustering = cast(Any, index.cp)
        clustering.niter, clustering.spherical, clustering.max_points_per_centroid = _ROUNDS, True, _SAMPLE
        chosen = np.random.default_rng(0).permutation(len(rows))[: count * _SAMPLE]
        index.train(rows.vectors[np.sort(chosen)].astype(np.float32))
        for first in range(0, len(rows), _CHUNK):
            index.add(rows.vectors[first : first + _CHUNK].astype(np.float32))
        return cls(rows.owners, rows.spans, index)

    @property
    def rows(self) -> Rows:
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
        return Rows(self.owners, self.spans, vectors)

    def search(self, queries: NDArray[np.float32], k: int, mask: NDArray[np.bool_] | None) -> Found:
        """See `Block.search`."""
        import faiss

        faiss.omp_set_num_threads(1)
        share = 1.0 if mask is None else max(float(mask.mean()), 1e-9)
        probes = min(int(np.ceil(PROBES / share)), self.index.nlist)
        selector, parameters = cast(Any, faiss.IDSelectorBitmap), cast(Any, faiss.SearchParametersIVF)
        if mask is None:
            return self._found(*self.index.search(queries, k, params=parameters(nprobe=probes)))
        bits = np.packbits(mask, bitorder="little")  # held until the search is done: FAISS only points at it
        return self._found(*self.index.search(queries, k, params=parameters(nprobe=probes, sel=selector(bits))))
