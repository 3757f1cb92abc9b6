"""Sums over rows tell two indexes apart in any order, and an index gives each of its rows once."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from indexer.maintenance.row_sums import sum_of_rows
from indexer.vectors import faiss_index
from indexer.vectors.blocks import IndexRows
from indexer.vectors.faiss_index import FaissIndex


def rows(count: int, size: int = 16, first: int = 0) -> IndexRows:
    """Rows of random vectors, three for each owner."""
    rng = np.random.default_rng(count)
    vectors = rng.standard_normal((count, size), np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    spans = np.tile(np.array([[0, 1.6], [0.4, 2], [0.8, 2.4]], np.float32), (count // 3 + 1, 1))[:count]
    return IndexRows(first + np.arange(count, dtype=np.int64) // 3, spans, vectors.astype(np.float16))


def test_order_and_pieces_do_not_matter() -> None:
    all_of_them = rows(9000)
    shuffled = all_of_them[np.random.default_rng(0).permutation(9000)]
    assert sum_of_rows([all_of_them]) == sum_of_rows([shuffled[np.arange(9000) % 2 == half] for half in (0, 1)])
    assert sum_of_rows([]) == (0, 0, 0)


@pytest.mark.parametrize("part", ["owners", "spans", "vectors"])
def test_a_flipped_bit_changes_the_sum(part: str) -> None:
    given = rows(50)
    before = sum_of_rows([given])
    words = getattr(given, part).view(np.uint16).reshape(-1)
    for place in np.random.default_rng(0).integers(0, len(words), 50):
        for bit in range(16):
            words[place] ^= 1 << bit
            assert sum_of_rows([given]) != before
            words[place] ^= 1 << bit
    assert sum_of_rows([given]) == before


def test_rows_that_exchange_their_owners_change_the_sum() -> None:
    given = rows(60)
    other = IndexRows(given.owners[::-1].copy(), given.spans, given.vectors)
    assert sum_of_rows([given]) != sum_of_rows([other])


@pytest.mark.parametrize("clustered", [False, True])
def test_an_index_gives_its_rows_in_pieces(monkeypatch: pytest.MonkeyPatch, clustered: bool) -> None:
    monkeypatch.setattr(faiss_index, "CLUSTERED_FROM", 1000 if clustered else 10**9)
    index = FaissIndex.of(1, rows(6000)).update(2, remove=np.array([3, 700]), add=rows(90, first=5000))
    assert len(index) == 6084
    assert sum_of_rows(index.pieces()) == sum_of_rows([index.rows])


def test_memory_does_not_grow_with_the_rows() -> None:
    given = rows(60_000, 256)
    tracemalloc.start()
    sum_of_rows([given])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 40e6
