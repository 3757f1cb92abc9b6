"""FaissIndex: search over unit vectors in half precision, and a cheap way to keep it up to date with a library."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_count, checked_vectors
from indexer.vectors.blocks import Block, IndexRows, MaskedBlock, SearchResult
from indexer.vectors.cached_block import CachedBlock
from indexer.vectors.clustered import PROBES, ClusteredBlock

#: Rows from which on a main block is searched by clusters: exact search then costs more than 2 ms a query.
CLUSTERED_FROM = 80_000

#: Rows from which on an added block has clusters of its own where many searches are to come. Those of the main block
#: would not do: new rows are often unlike the old ones and lie far from all their centres.
ADDED_CLUSTERED_FROM = 8192

#: Share of rows added or removed since the main block was built from which on it is built anew. A server puts that off:
#: it takes a minute of a core, and added rows are found nearly as fast.
COMPACT_AT, COMPACT_AT_SERVING = 0.05, 0.25


def kind_of(rows: int) -> str:
    """What an index of so many rows is, in words."""
    return "every vector compared" if rows < CLUSTERED_FROM else f"{int(rows**0.5):,} clusters, {PROBES} of them probed"


def make_block(rows: IndexRows) -> Block:
    """A main block over `rows`: exact, or in clusters where there are very many."""
    return (ClusteredBlock if len(rows) >= CLUSTERED_FROM else Block).of(rows)


def block_from_index(owners: NDArray[np.int64], spans: NDArray[np.float32], index: Any) -> Block:
    """The block that a FAISS index read from a file belongs to."""
    return (ClusteredBlock if hasattr(index, "invlists") else Block)(owners, spans, index)


class FaissIndex:
    """A `VectorIndex` of a main block, which may lie in a mapped file, and added ones: a log-structured merge tree.

    An update adds a block. Two blocks of about one size are merged, so that there are few of them and a row is copied a
    few times, however many updates there are (O'Neil et al., Acta Informatica 33, 1996). Added blocks are exact unless
    many searches are to come: see `for_serving`.
    """

    def __init__(self, generation: int, main: MaskedBlock | Block, added: tuple[MaskedBlock, ...] = ()) -> None:
        self.generation = generation
        self._main = main if isinstance(main, MaskedBlock) else MaskedBlock(main)
        self._added = added
        self._count = len(self._main) + sum(map(len, added))

    @classmethod
    def of(cls, generation: int, rows: IndexRows) -> FaissIndex:
        """An index over `rows`."""
        return cls(generation, make_block(rows))

    @property
    def main(self) -> Block:
        """The main block; some of its rows may be removed."""
        return self._main.block

    @property
    def blocks(self) -> list[Block]:
        """The main block and those added to it, largest first."""
        return [part.block for part in (self._main, *self._added)]

    @property
    def size(self) -> int:
        """Size D of a vector."""
        return int(self.main.index.d)

    def shares_block(self, other: FaissIndex) -> bool:
        """Whether both have the same main block."""
        return self.main is other.main

    @property
    def rows(self) -> IndexRows:
        """All rows that can be found."""
        return (
            self._main.rows if not self._added else IndexRows.join([part.rows for part in (self._main, *self._added)])
        )

    def pieces(self) -> Iterator[IndexRows]:
        """The same in pieces, in any order."""
        for part in (self._main, *self._added):
            yield from part.pieces()

    def __len__(self) -> int:
        return self._count

    def update(
        self, generation: int, *, remove: NDArray[np.int64], add: IndexRows, compact_at: float = COMPACT_AT
    ) -> FaissIndex:
        """See `VectorIndex.update`; the cost grows with what is removed and added, until `compact_at` is reached."""
        main, *added = (part.without(remove) for part in (self._main, *self._added))
        added += [MaskedBlock(Block.of(add))] if len(add) else []
        changed = FaissIndex(generation, main, _merged(added))
        return changed if changed.changes <= compact_at * len(main.block) else changed.compacted()

    @property
    def changes(self) -> int:
        """Rows that were added to the main block or removed from it."""
        return len(self._main.block) - len(self._main) + sum(map(len, self._added))

    def for_serving(self) -> FaissIndex:
        """The same index for many searches: large blocks in clusters, and results in the main block cached.

        To find the clusters of some rows takes as long as to compare them with two hundred queries.
        """
        main = self._main if isinstance(self._main, CachedBlock) else CachedBlock(self._main.block, self._main.mask)
        added = tuple(MaskedBlock(ClusteredBlock.of(part.rows)) if _is_slow(part) else part for part in self._added)
        return FaissIndex(self.generation, main, added)

    def compacted(self) -> FaissIndex:
        """The same index with all rows in the main block."""
        compact = not self._added and self._main.mask is None
        return self if compact else FaissIndex.of(self.generation, self.rows)

    def rows_of(self, owners: NDArray[np.int64]) -> IndexRows:
        """All rows of some owners."""
        return IndexRows.join([part.rows_of(owners) for part in (self._main, *self._added)])

    def search(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None, exact: bool = False
    ) -> SearchResult:
        """See `VectorIndex.search`; where it is to be `exact`, every row is compared."""
        size = self.size if len(self) else np.shape(queries)[-1]  # an empty index takes vectors of any size
        queries, k = checked_vectors("queries", queries, size), checked_count(k)
        found = [part.search(queries, k, allowed, exact=exact) for part in (self._main, *self._added) if len(part)]
        if not found:
            blank = np.zeros((len(queries), k), np.float32)
            return blank - np.inf, np.full(blank.shape, -1), blank, blank
        return found[0] if len(found) == 1 else _best(found, k)


def _merged(added: list[MaskedBlock]) -> tuple[MaskedBlock, ...]:
    """The same rows in blocks, the size of each of more bits than that of the next."""
    added = [part for part in added if len(part)]
    first = max(len(added) - 1, 0)
    size = sum(map(len, added[first:]))
    while first and len(added[first - 1]).bit_length() <= size.bit_length():
        first -= 1
        size += len(added[first])
    if len(added) - first < 2:
        return tuple(added)
    return (*added[:first], MaskedBlock(Block.of(IndexRows.join([part.rows for part in added[first:]]))))


def _is_slow(part: MaskedBlock) -> bool:
    return len(part) >= ADDED_CLUSTERED_FROM and not isinstance(part.block, ClusteredBlock)


def _best(found: list[SearchResult], k: int) -> SearchResult:
    scores, owners, starts, ends = (np.concatenate(parts, axis=1) for parts in zip(*found, strict=True))
    best = np.argsort(-scores, axis=1, kind="stable")[:, :k]
    return tuple(np.take_along_axis(part, best, axis=1) for part in (scores, owners, starts, ends))  # type: ignore[return-value]
