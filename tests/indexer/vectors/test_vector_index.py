"""What every `VectorIndex` promises: FAISS and Milvus answer alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

from indexer.vectors.blocks import IndexRows
from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.vector_index import VectorIndex
from tests.indexer.vectors.milvus_clips import filled, opened
from tests.indexer.vectors.test_faiss_index import SIZE, plainly, queries, rows

Make = Callable[[IndexRows], VectorIndex]


@pytest.fixture(params=["faiss", "milvus"])
def make(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Make]:
    """Makes an index over rows."""
    if request.param == "faiss":
        yield lambda held: FaissIndex.of(1, held)
        return
    pytest.importorskip("milvus_lite")
    from indexer.vectors.milvus.milvus_index import MilvusIndex

    with ExitStack() as stack:

        def of(held: IndexRows) -> VectorIndex:
            collection = stack.enter_context(opened(tmp_path / "vectors.db", SIZE))
            filled(collection, held)
            return MilvusIndex(collection, "windows")

        yield of


def in_order(held: IndexRows) -> IndexRows:
    order = np.lexsort((held.spans[:, 0], held.owners))
    return IndexRows(held.owners[order], held.spans[order], held.vectors[order])


def test_search_compares_every_row(make: Make) -> None:
    held = rows(np.repeat(np.arange(1, 41), 5))
    index = make(held)
    scores, owners, starts, ends = index.search(queries(7), 10)
    want_scores, want_owners = plainly(held, queries(7), 10)
    np.testing.assert_allclose(scores, want_scores, atol=1e-5)
    np.testing.assert_array_equal(owners, want_owners)
    np.testing.assert_array_equal(ends, starts + 1)
    assert scores.dtype == starts.dtype == ends.dtype == np.float32
    assert owners.dtype == np.int64
    assert len(index) == len(held)


def test_only_allowed_owners_are_found(make: Make) -> None:
    held = rows(np.repeat(np.arange(1, 41), 5))
    index = make(held)
    for allowed in ([3], [1, 7, 39], list(range(0, 60, 2)), [-5, 10**9], []):
        scores, owners, _, _ = index.search(queries(3), 12, allowed=np.array(allowed, np.int64))
        want_scores, want_owners = plainly(held, queries(3), 12, allowed)
        found = want_owners.shape[1]
        np.testing.assert_array_equal(owners[:, :found], want_owners)
        np.testing.assert_allclose(scores[:, :found], want_scores, atol=1e-5)
        assert (owners[:, found:] == -1).all()
        assert np.isneginf(scores[:, found:]).all()


def test_the_rows_of_some_owners_are_as_they_were_given(make: Make) -> None:
    held = rows(np.repeat(np.arange(1, 21), 3))
    got = in_order(make(held).rows_of(np.array([4, 17, 99])))
    want = in_order(held[np.isin(held.owners, [4, 17])])
    np.testing.assert_array_equal(got.owners, want.owners)
    np.testing.assert_array_equal(got.spans, want.spans)
    np.testing.assert_array_equal(got.vectors, want.vectors)
    assert got.vectors.dtype == np.float16


def test_an_empty_index_finds_nothing(make: Make) -> None:
    index = make(IndexRows.none(SIZE))
    scores, owners, starts, ends = index.search(queries(2), 3)
    assert owners.tolist() == [[-1] * 3] * 2
    assert scores.shape == starts.shape == ends.shape == (2, 3)
    assert len(index) == 0
    assert len(index.rows_of(np.array([1]))) == 0
