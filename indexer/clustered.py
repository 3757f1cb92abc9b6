"""Many rows, found fast: only the clusters nearest to a query are looked at (an inverted file, IVF).

Exact search reads every vector, which at a million rows takes as long as memory takes to deliver half a gigabyte. Here
a row is missed where its cluster is not among those looked at: of the ten best of 100,000 clips with 2.4 million
windows of a trained model, 995 in 1,000 were found (`benchmarks/serve.py` measures it). Vectors without any clusters,
random ones or those of an untrained model, are what it cannot do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from indexer.blocks import Block, Found, Mask, Part, Rows

#: Clusters looked at for a query. Filters that leave few rows make it more, so that as many rows are compared.
PROBES = 32

#: Clusters are found anew when there are so many times the rows there were.
_OUTGROWN = 2

_ROUNDS = 8
_SAMPLE = 48  # rows a cluster that take part in finding the clusters
_CHUNK = 1 << 12  # rows sorted in at once


class ClusteredBlock(Block):
    """Rows in clusters, answered as by `Block` but for those it misses. Several blocks may have the same centres."""

    def __init__(
        self, owners: NDArray[np.int64], spans: NDArray[np.float32], index: Any, centres: Any | None = None
    ) -> None:
        import faiss

        super().__init__(owners, spans, index)
        self._centres = centres or faiss.clone_index(index.quantizer)

    @classmethod
    def of(cls, rows: Rows) -> ClusteredBlock:
        """Find clusters, about as many as the square root of the rows, and sort the rows into them."""
        import faiss

        size, count = rows.vectors.shape[1], int(np.sqrt(len(rows)))
        centres = faiss.IndexFlatIP(size)
        index = _index(centres, count)
        clustering = cast(Any, index.cp)
        clustering.niter, clustering.spherical, clustering.max_points_per_centroid = _ROUNDS, True, _SAMPLE
        chosen = np.random.default_rng(0).permutation(len(rows))[: count * _SAMPLE]
        index.train(rows.vectors[np.sort(chosen)].astype(np.float32))
        return _sorted_in(rows, centres, index)

    def outgrown(self, count: int) -> bool:
        """Whether there are too few clusters for so many rows."""
        return count > _OUTGROWN * int(self.index.nlist) ** 2

    def join(self, parts: Sequence[Part]) -> ClusteredBlock:
        """The rows of several parts, in order, in clusters around the centres of this block.

        Rows that lie in these clusters already are copied; only others are compared with the centres.
        """
        import faiss

        faiss.omp_set_num_threads(1)
        sorted_in = [part if self._shares_centres(part.block) else self._alike(part.rows) for part in parts]
        index = _index(self._centres, self.index.nlist)
        for cluster, places, codes in _lists(sorted_in):
            index.invlists.add_entries(cluster, len(places), faiss.swig_ptr(places), faiss.swig_ptr(codes))
            index.ntotal += len(places)
        owners = np.concatenate([part.block.owners[part.there] for part in sorted_in])
        spans = np.concatenate([part.block.spans[part.there] for part in sorted_in])
        return ClusteredBlock(owners, spans, index, self._centres)

    def _shares_centres(self, block: Block) -> bool:
        return isinstance(block, ClusteredBlock) and block._centres is self._centres

    def _alike(self, rows: Rows) -> Part:
        return Part(_sorted_in(rows, self._centres, _index(self._centres, self.index.nlist)))

    @property
    def rows(self) -> Rows:
        """The rows in their order; the vectors are a copy."""
        vectors = np.empty((self.index.ntotal, self.index.d), np.float16)
        for _, places, codes in _lists([Part(self)]):
            vectors[places] = codes.view(np.float16)
        return Rows(self.owners, self.spans, vectors)

    def search(self, queries: NDArray[np.float32], k: int, mask: Mask | None) -> Found:
        """See `Block.search`."""
        import faiss

        faiss.omp_set_num_threads(1)
        share = 1.0 if mask is None else max(mask.count / len(self), 1e-9)
        probes = min(int(np.ceil(PROBES / share)), self.index.nlist)
        selector, parameters = cast(Any, faiss.IDSelectorBitmap), cast(Any, faiss.SearchParametersIVF)
        chosen = {} if mask is None else {"sel": selector(mask.bits)}
        return self._found(*self.index.search(queries, k, params=parameters(nprobe=probes, **chosen)))


def _index(centres: Any, count: int) -> Any:
    """An empty FAISS index around so many centres, which are found already or yet to be found."""
    import faiss

    fp16, inner = faiss.ScalarQuantizer.QT_fp16, faiss.METRIC_INNER_PRODUCT
    index = faiss.IndexIVFScalarQuantizer(centres, centres.d, count, fp16, inner, False)
    index.is_trained = centres.ntotal == count
    return index


def _sorted_in(rows: Rows, centres: Any, index: Any) -> ClusteredBlock:
    """The rows in an empty index. NumPy's product finds the nearest centres five times as fast as FAISS does."""
    import faiss

    across = centres.reconstruct_n(0, centres.ntotal).T
    for first in range(0, len(rows), _CHUNK):
        vectors = rows.vectors[first : first + _CHUNK].astype(np.float32)
        nearest, places = np.argmax(vectors @ across, axis=1), np.arange(first, first + len(vectors))
        index.add_core(len(places), *map(faiss.swig_ptr, (vectors, places, nearest)))
    return ClusteredBlock(rows.owners, rows.spans, index, centres)


def _lists(parts: Sequence[Part]) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.uint8]]]:
    """For each cluster that has any: the places of its rows among all rows of all parts, and their codes (n, bytes)."""
    import faiss

    first, places = 0, []
    for part in parts:
        places.append(np.where(part.there, np.cumsum(part.there) + (first - 1), -1))
        first += len(part)
    indexes = [part.block.index for part in parts]
    for cluster in range(indexes[0].nlist):
        found = []
        for index, place in zip(indexes, places, strict=True):
            lists, size = index.invlists, index.code_size
            if count := lists.list_size(cluster):
                there = place[faiss.rev_swig_ptr(lists.get_ids(cluster), count)]
                codes = faiss.rev_swig_ptr(lists.get_codes(cluster), count * size).reshape(count, size)
                found.append((there[there >= 0], codes[there >= 0]))
        if found:
            yield cluster, np.concatenate([there for there, _ in found]), np.concatenate([codes for _, codes in found])
