"""The vector index: search over unit vectors in half precision, and a cheap way to keep it in step with a library.

An index is immutable: `update` gives a new one and the old one goes on answering, so a search in one thread never
meets a change made by another.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from indexer.vectors.blocks import Block, Found, Part, Rows
from indexer.vectors.clustered import ClusteredBlock
from indexer.vectors.memo import MemoisedPart

if TYPE_CHECKING:
    from typing_extensions import Self

__all__ = ["CLUSTERED_FROM", "LOOSE", "LOOSE_WHERE_SETTLED", "FlatVectors", "Found", "Rows", "Vectors", "block_around"]

#: Rows from which on a main block is searched by clusters: exact search then costs more than 2 ms a query.
CLUSTERED_FROM = 80_000

#: Rows from which on what came later has clusters of its own, where many searches are to come. Those of the main block
#: would not do: what is new is often unlike what was there, and lies far from all their centres.
LATER_CLUSTERED_FROM = 8192

#: Share of rows that came or went since the main block was made, from which on a new one is made. Whoever answers all
#: the time puts that off: it takes a minute of a core, and what came later is found nearly as fast.
LOOSE, LOOSE_WHERE_SETTLED = 0.05, 0.25


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


def block_of(rows: Rows) -> Block:
    """A main block over `rows`: exact, or in clusters where there are very many."""
    return (ClusteredBlock if len(rows) >= CLUSTERED_FROM else Block).of(rows)


def block_around(owners: NDArray[np.int64], spans: NDArray[np.float32], index: Any) -> Block:
    """The block whose FAISS index this is."""
    return (ClusteredBlock if hasattr(index, "invlists") else Block)(owners, spans, index)


class FlatVectors:
    """Search in a main block, which may lie in a mapped file, and in what came later, as a log-structured merge tree.

    What an update adds is a block of its own. Two blocks of about one size become one, so there are few of them, and a
    row is copied a few times, however many updates there are (O'Neil et al., Acta Informatica 33, 1996). They are exact
    unless many searches are to come: see `settled`.
    """

    def __init__(self, generation: int, main: Part | Block, later: tuple[Part, ...] = ()) -> None:
        self.generation = generation
        self._main = main if isinstance(main, Part) else Part(main)
        self._later = later
        self._count = len(self._main) + sum(map(len, later))

    @classmethod
    def of(cls, generation: int, rows: Rows) -> FlatVectors:
        """An index over `rows`."""
        return cls(generation, block_of(rows))

    @property
    def main(self) -> Block:
        """The main block, of which some rows may have gone."""
        return self._main.block

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
        return self._main.rows if not self._later else Rows.join([part.rows for part in (self._main, *self._later)])

    def __len__(self) -> int:
        return self._count

    def update(self, generation: int, *, remove: NDArray[np.int64], add: Rows, loose: float = LOOSE) -> FlatVectors:
        """See `Vectors.update`; costs about as much as what is removed and added, or `loose` is reached."""
        main, *later = (part.without(remove) for part in (self._main, *self._later))
        later += [Part(Block.of(add))] if len(add) else []
        changed = FlatVectors(generation, main, _merged(later))
        lost = len(main.block) - len(main)
        return changed if lost + sum(map(len, later)) <= loose * len(main.block) else changed.compacted()

    def settled(self) -> FlatVectors:
        """The same for whoever will search often: all that is large in clusters, and the main block's answers held.

        To find the clusters of some rows takes as long as to compare them with two hundred queries.
        """
        main = self._main if isinstance(self._main, MemoisedPart) else MemoisedPart(self._main.block, self._main.kept)
        later = tuple(Part(ClusteredBlock.of(part.rows)) if _is_slow(part) else part for part in self._later)
        return FlatVectors(self.generation, main, later)

    def compacted(self) -> FlatVectors:
        """The same with all rows in the main block."""
        compact = not self._later and self._main.kept is None
        return self if compact else FlatVectors.of(self.generation, self.rows)

    def search(self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None) -> Found:
        """See `Vectors.search`."""
        queries = np.ascontiguousarray(queries, np.float32)
        found = [part.search(queries, k, allowed) for part in (self._main, *self._later) if len(part)]
        if not found:
            blank = np.zeros((len(queries), k), np.float32)
            return blank - np.inf, np.full(blank.shape, -1), blank, blank
        return found[0] if len(found) == 1 else _best(found, k)


def _merged(later: list[Part]) -> tuple[Part, ...]:
    """The same rows in parts, the size of each of more bits than that of the next."""
    later = [part for part in later if len(part)]
    first = max(len(later) - 1, 0)
    size = sum(map(len, later[first:]))
    while first and len(later[first - 1]).bit_length() <= size.bit_length():
        first -= 1
        size += len(later[first])
    if len(later) - first < 2:
        return tuple(later)
    return (*later[:first], Part(Block.of(Rows.join([part.rows for part in later[first:]]))))


def _is_slow(part: Part) -> bool:
    return len(part) >= LATER_CLUSTERED_FROM and not isinstance(part.block, ClusteredBlock)


def _best(found: list[Found], k: int) -> Found:
    scores, owners, starts, ends = (np.concatenate(parts, axis=1) for parts in zip(*found, strict=True))
    best = np.argsort(-scores, axis=1, kind="stable")[:, :k]
    return tuple(np.take_along_axis(part, best, axis=1) for part in (scores, owners, starts, ends))  # type: ignore[return-value]
