"""Blocks of rows: what an index consists of. A block is immutable; removed rows are masked."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

SearchResult = tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]]

#: Products of a query and a row from which on threads pay for their start.
_WORTH_THREADS = 1 << 22
#: Rows that are looked at together where all are.
_PIECE = 1 << 12


@dataclass(frozen=True)
class IndexRows:
    """The rows of an index: a vector, the clip that owns it and the span of the clip that it encodes.

    Attributes
    ----------
    owners : int64 array (n,)
        Clip ids.
    spans : float32 array (n, 2)
        Start and end in seconds.
    vectors : float16 array (n, D)
        Unit vectors; of rows that were looked up perhaps the same numbers in single precision.
    """

    owners: NDArray[np.int64]
    spans: NDArray[np.float32]
    vectors: NDArray[np.floating]

    def __len__(self) -> int:
        return len(self.owners)

    def __getitem__(self, mask: NDArray[np.bool_]) -> IndexRows:
        return IndexRows(self.owners[mask], self.spans[mask], self.vectors[mask])

    @staticmethod
    def none(size: int) -> IndexRows:
        """No rows, of vectors of `size` numbers."""
        return IndexRows(np.empty(0, np.int64), np.empty((0, 2), np.float32), np.empty((0, size), np.float16))

    @staticmethod
    def join(parts: list[IndexRows]) -> IndexRows:
        """All rows of all parts, in order."""
        return IndexRows(
            np.concatenate([part.owners for part in parts]),
            np.concatenate([part.spans for part in parts]),
            np.concatenate([part.vectors for part in parts]),
        )


@dataclass(frozen=True)
class Mask:
    """Some rows of a block: a bit for each, lowest first, as FAISS reads them, and how many are set."""

    bits: NDArray[np.uint8]
    count: int

    @staticmethod
    def of(chosen: NDArray[np.bool_]) -> Mask:
        """The rows that are chosen."""
        return Mask(np.packbits(chosen, bitorder="little"), int(chosen.sum()))

    def __and__(self, other: Mask) -> Mask:
        bits = self.bits & other.bits
        return Mask(bits, int(np.unpackbits(bits).sum()))

    def without(self, rows: NDArray[np.int64]) -> Mask:
        """A mask with the bits of these rows, each named once, cleared."""
        bits, byte, bit = self.bits.copy(), rows >> 3, (rows & 7).astype(np.uint8)
        cleared = int((bits[byte] >> bit & 1).sum())
        np.bitwise_and.at(bits, byte, ~(np.uint8(1) << bit))
        return Mask(bits, self.count - cleared)

    def chosen(self, count: int) -> NDArray[np.bool_]:
        """A bool for each of the `count` rows of the block."""
        return np.unpackbits(self.bits, count=count, bitorder="little").view(np.bool_)


class _Codes:
    """The memory of a FAISS index as an array (n, D) that keeps the index alive."""

    def __init__(self, index: Any, count: int, size: int) -> None:
        import faiss

        self.index = index
        address = faiss.rev_swig_ptr(index.codes.data(), 1).ctypes.data
        self.__array_interface__ = {"version": 3, "typestr": "<f2", "shape": (count, size), "data": (address, True)}


class Block:
    """Rows and the FAISS index over them; the vectors lie in the FAISS index alone. Search compares every row."""

    def __init__(self, owners: NDArray[np.int64], spans: NDArray[np.float32], index: Any) -> None:
        self.owners, self.spans, self.index = owners, spans, index

    @classmethod
    def of(cls, rows: IndexRows) -> Block:
        """A block over `rows`."""
        import faiss

        size = rows.vectors.shape[1]
        index = faiss.IndexScalarQuantizer(size, faiss.ScalarQuantizer.QT_fp16, faiss.METRIC_INNER_PRODUCT)
        if len(rows):
            index.add_sa_codes(np.ascontiguousarray(rows.vectors).view(np.uint8))  # fp16 codes are the numbers
        return cls(rows.owners, rows.spans, index)

    def __len__(self) -> int:
        return len(self.owners)

    @property
    def rows(self) -> IndexRows:
        """The rows; the vectors are a view of the index's memory."""
        count, size = self.index.ntotal, self.index.d
        if not count:
            return IndexRows.none(size)
        return IndexRows(self.owners, self.spans, np.asarray(_Codes(self.index, count, size)))

    def pieces(self) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float16]]]:
        """Numbers of rows and their vectors, each row once, in pieces of a bounded size or a cluster."""
        vectors = self.rows.vectors
        for first in range(0, len(vectors), _PIECE):
            piece = vectors[first : first + _PIECE]
            yield np.arange(first, first + len(piece)), piece

    @cached_property
    def _order(self) -> NDArray[np.int64] | None:
        """Row numbers in order of owners, None where rows lie so already; found once for a block."""
        in_order = bool((self.owners[1:] >= self.owners[:-1]).all())
        return None if in_order else np.argsort(self.owners, kind="stable")

    def rows_of(self, owners: NDArray[np.int64]) -> NDArray[np.int64]:
        """The numbers of the rows of some owners, each once."""
        wanted = np.unique(owners)
        first, last = (np.searchsorted(self.owners, wanted, side, sorter=self._order) for side in ("left", "right"))
        counts = last - first
        places = np.repeat(last - np.cumsum(counts), counts) + np.arange(counts.sum())
        return places if self._order is None else self._order[places]

    def vectors_of(self, rows: NDArray[np.int64]) -> NDArray[np.floating]:
        """The vectors (n, D) of some rows, of the numbers that are stored in half precision."""
        return self.rows.vectors[rows]

    def search(self, queries: NDArray[np.float32], k: int, mask: Mask | None, *, exact: bool = False) -> SearchResult:
        """The k best rows by inner product, of those in the mask; see `FaissIndex.search`."""
        import faiss

        # Threads share queries out. For one query, or little to do, they only wait for memory and for each other.
        worth = len(queries) * len(self) >= _WORTH_THREADS
        faiss.omp_set_num_threads(min(len(queries), os.cpu_count() or 1) if worth else 1)
        only = None
        if mask is not None:
            selector, parameters = cast(Any, faiss.IDSelectorBitmap), cast(Any, faiss.SearchParameters)
            only = parameters(sel=selector(mask.bits))
        return self._found(*self.index.search(queries, k, params=only))

    def _found(self, scores: NDArray[np.float32], rows: NDArray[np.int64]) -> SearchResult:
        owners = np.where(rows < 0, -1, self.owners[rows])
        spans = self.spans[rows]
        return np.where(rows < 0, -np.inf, scores).astype(np.float32), owners, spans[..., 0], spans[..., 1]


@dataclass(frozen=True)
class MaskedBlock:
    """A block and the mask of its rows that are not removed; None for all."""

    block: Block
    mask: Mask | None = None

    def __len__(self) -> int:
        return len(self.block) if self.mask is None else self.mask.count

    @property
    def present(self) -> NDArray[np.bool_]:
        """For each row of the block, whether it is not removed."""
        count = len(self.block)
        return np.ones(count, np.bool_) if self.mask is None else self.mask.chosen(count)

    @property
    def rows(self) -> IndexRows:
        """The rows that are not removed."""
        return self.block.rows if self.mask is None else self.block.rows[self.present]

    def pieces(self) -> Iterator[IndexRows]:
        """The same in pieces; see `Block.pieces`."""
        present = self.present
        for places, vectors in self.block.pieces():
            kept = present[places]
            places = places[kept]
            yield IndexRows(self.block.owners[places], self.block.spans[places], vectors[kept])

    def without(self, owners: NDArray[np.int64]) -> MaskedBlock:
        """The block without the rows of these owners."""
        rows = self.block.rows_of(owners)
        if not len(rows):
            return self
        mask = self.mask or Mask.of(np.ones(len(self.block), np.bool_))
        return MaskedBlock(self.block, mask.without(rows))

    def rows_of(self, owners: NDArray[np.int64]) -> IndexRows:
        """The rows of some owners that are not removed."""
        rows = self.block.rows_of(owners)
        if self.mask is not None:
            rows = rows[self.mask.bits[rows >> 3] >> (rows & 7) & 1 > 0]
        return IndexRows(self.block.owners[rows], self.block.spans[rows], self.block.vectors_of(rows))

    def search(
        self, queries: NDArray[np.float32], k: int, allowed: NDArray[np.int64] | None, *, exact: bool = False
    ) -> SearchResult:
        """The k best rows of the allowed owners, None for all."""
        mask = self.mask
        if allowed is not None:
            among = Mask.of(_among(self.block.owners, allowed))
            mask = among if mask is None else among & mask
        return self.block.search(queries, k, mask, exact=exact)


def _among(owners: NDArray[np.int64], allowed: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which owners are allowed, through a table: owners are small dense integers, so it beats a search."""
    table = np.zeros(int(owners.max()) + 1, np.bool_)
    table[allowed[(allowed >= 0) & (allowed < len(table))]] = True
    return table[owners]
