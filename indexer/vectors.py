"""The vector index: exact search over unit vectors in half precision.

An index is immutable: `update` gives a new one and the old one goes on answering, so a search in one thread
never meets a change made by another.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from typing_extensions import Self

Found = tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]]

#: Products of a query and a row from which on threads are worth their start.
_WORTH_THREADS = 1 << 22

#: Rows from which on a main block is searched by clusters: exact search then costs more than 2 ms a query.
CLUSTERED_FROM = 80_000

#: Share of rows that came or went since the main block was made, from which on a new one is made.
_LOOSE = 0.05


@dataclass(frozen=True)
class Rows:
    """What an index holds: one vector a row, whose it is and which stretch of it.

    Attributes
    ----------
    owners : int64 array (n,)
        Clip ids.
    spans : float32 array (n, 2)
        Start and end in seconds.
    vectors : float16 array (n, D)
        Unit vectors.
    """

    owners: NDArray[np.int64]
    spans: NDArray[np.float32]
    vectors: NDArray[np.float16]

    def __len__(self) -> int:
        return len(self.owners)

    def __getitem__(self, mask: NDArray[np.bool_]) -> Rows:
        return Rows(self.owners[mask], self.spans[mask], self.vectors[mask])

    @staticmethod
    def none(size: int) -> Rows:
        """No rows, of vectors of `size` numbers."""
        return Rows(np.empty(0, np.int64), np.empty((0, 2), np.float32), np.empty((0, size), np.float16))

    @staticmethod
    def join(parts: list[Rows]) -> Rows:
        """All rows of all parts, in order."""
        return Rows(
            np.concatenate([part.owners for part in parts]),
            np.concatenate([part.spans for part in parts]),
            np.concatenate([part.vectors for part in parts]),
        )


class Vectors(Protocol):
    """What the library asks of a vector index; `FlatVectors` is the one in the box."""

    @property
    def generation(self) -> int:
        """The library generation whose vectors this holds."""

    def __len__(self) -> int: ...

    def update(self, generation: int, *, remove: NDArray[np.int64], add: Rows) -> Self:
        """An index without any row of the owners in `remove` and then with the rows of `add`."""

    def search(self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None) -> Found:
        """The k best rows by inner product: scores, owners, starts, ends, each (Q, k), best first.

        `allowed` (sorted owners) leaves all others out. Where fewer than k are left the owner is -1 and the
        score minus infinity.
        """


class _Codes:
    """The memory of a FAISS index as an array (n, D) that keeps the index alive."""

    def __init__(self, index: Any, count: int, size: int) -> None:
        import faiss

        self.index = index
        address = faiss.rev_swig_ptr(index.codes.data(), 1).ctypes.data
        self.__array_interface__ = {"version": 3, "typestr": "<f2", "shape": (count, size), "data": (address, True)}


class Block:
    """Rows and the FAISS index over them; the vectors lie in the FAISS index alone."""

    def __init__(self, owners: NDArray[np.int64], spans: NDArray[np.float32], index: Any) -> None:
        self.owners, self.spans, self.index = owners, spans, index

    @classmethod
    def of(cls, rows: Rows) -> Block:
        import faiss

        size = rows.vectors.shape[1]
        index = faiss.IndexScalarQuantizer(size, faiss.ScalarQuantizer.QT_fp16, faiss.METRIC_INNER_PRODUCT)
        if len(rows):
            index.add_sa_codes(np.ascontiguousarray(rows.vectors).view(np.uint8))  # fp16 codes are the numbers
        return cls(rows.owners, rows.spans, index)

    @property
    def rows(self) -> Rows:
        """The rows; the vectors are a view of the index's memory."""
        count, size = self.index.ntotal, self.index.d
        if not count:
            return Rows.none(size)
        return Rows(self.owners, self.spans, np.asarray(_Codes(self.index, count, size)))

    def search(self, queries: NDArray[np.float32], k: int, mask: NDArray[np.bool_] | None) -> Found:
        import faiss

        # Threads share queries out. For one query, or little to do, they only wait for memory and for each other.
        worth = len(queries) * len(self.owners) >= _WORTH_THREADS
        faiss.omp_set_num_threads(min(len(queries), os.cpu_count() or 1) if worth else 1)
        only = None
        if mask is not None:
            selector, parameters = cast(Any, faiss.IDSelectorBitmap), cast(Any, faiss.SearchParameters)
            bits = np.packbits(mask, bitorder="little")  # held until the search is done: FAISS only points at it
            only = parameters(sel=selector(bits))
        return self._found(*self.index.search(queries, k, params=only))

    def _found(self, scores: NDArray[np.float32], rows: NDArray[np.int64]) -> Found:
        owners = np.where(rows < 0, -1, self.owners[rows])
        spans = self.spans[rows]
        return np.where(rows < 0, -np.inf, scores).astype(np.float32), owners, spans[..., 0], spans[..., 1]


def block_of(rows: Rows) -> Block:
    """A block over `rows`: exact, or in clusters where there are very many."""
    from indexer.clustered import ClusteredBlock

    return (ClusteredBlock if len(rows) >= CLUSTERED_FROM else Block).of(rows)


def block_around(owners: NDArray[np.int64], spans: NDArray[np.float32], index: Any) -> Block:
    """The block whose FAISS index this is."""
    from indexer.clustered import ClusteredBlock

    return (ClusteredBlock if hasattr(index, "invlists") else Block)(owners, spans, index)


class FlatVectors:
    """Search in a main block, which may lie in a mapped file, and a small block of what came later."""

    def __init__(
        self,
        generation: int,
        main: Block,
        later: Block | None = None,
        gone: NDArray[np.int64] | None = None,
    ) -> None:
        self.generation = generation
        self.main, self._later = main, later
        self._gone = np.empty(0, np.int64) if gone is None else gone
        self._kept = ~np.isin(main.owners, self._gone) if len(self._gone) else None

    @classmethod
    def of(cls, generation: int, rows: Rows) -> FlatVectors:
        """An index over `rows`."""
        return cls(generation, block_of(rows))

    @property
    def size(self) -> int:
        """Numbers a vector."""
        return int(self.main.index.d)

    def shares_block(self, other: FlatVectors) -> bool:
        """Whether both have the same main block, so that they differ by little."""
        return self.main is other.main

    @property
    def rows(self) -> Rows:
        """Every row that can be found."""
        main = self.main.rows if self._kept is None else self.main.rows[self._kept]
        return main if self._later is None else Rows.join([main, self._later.rows])

    def __len__(self) -> int:
        main = len(self.main.owners) if self._kept is None else int(self._kept.sum())
        return main + (0 if self._later is None else len(self._later.owners))

    def update(self, generation: int, *, remove: NDArray[np.int64], add: Rows) -> FlatVectors:
        """See `Vectors.update`; costs as much as what changed since the main block was made."""
        gone = np.union1d(self._gone, remove[np.isin(remove, self.main.owners)])
        later = Rows.none(self.size) if self._later is None else self._later.rows
        later = Rows.join([later[~np.isin(later.owners, remove)], add])
        changed = FlatVectors(generation, self.main, Block.of(later) if len(later) else None, gone)
        lost = 0 if changed._kept is None else len(changed._kept) - int(changed._kept.sum())
        return changed if len(later) + lost <= _LOOSE * len(self.main.owners) else changed.compacted()

    def compacted(self) -> FlatVectors:
        """The same with all rows in the main block."""
        compact = self._later is None and self._kept is None
        return self if compact else FlatVectors.of(self.generation, self.rows)

    def search(self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None) -> Found:
        """See `Vectors.search`."""
        queries = np.ascontiguousarray(queries, np.float32)
        found = []
        for block, kept in ((self.main, self._kept), (self._later, None)):
            if block is not None and len(block.owners):
                mask = kept
                if allowed is not None:
                    among = _among(block.owners, allowed)
                    mask = among if kept is None else among & kept
                found.append(block.search(queries, k, mask))
        if not found:
            blank = np.zeros((len(queries), k), np.float32)
            return blank - np.inf, np.full(blank.shape, -1), blank, blank
        return found[0] if len(found) == 1 else _merge(found, k)


def _among(owners: NDArray[np.int64], allowed: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which owners are allowed, through a table: owners are small dense integers, so it beats a search."""
    table = np.zeros(int(owners.max()) + 1, np.bool_)
    table[allowed[(allowed >= 0) & (allowed < len(table))]] = True
    return table[owners]


def _merge(found: list[Found], k: int) -> Found:
    scores, owners, starts, ends = (np.concatenate(parts, axis=1) for parts in zip(*found, strict=True))
    best = np.argsort(-scores, axis=1, kind="stable")[:, :k]
    return tuple(np.take_along_axis(part, best, axis=1) for part in (scores, owners, starts, ends))  # type: ignore[return-value]
