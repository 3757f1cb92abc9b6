"""The vector index: exact, filtered, caught up with changes."""

import os

import faiss
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from indexer.vectors.blocks import IndexRows
from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.vector_index import VectorIndex

SIZE = 16


def rows(owners, seed=0):
    owners = np.asarray(owners, np.int64)
    latents = np.random.default_rng(seed).standard_normal((len(owners), SIZE))
    latents /= np.linalg.norm(latents, axis=1, keepdims=True)
    starts = np.arange(len(owners), dtype=np.float32)
    return IndexRows(owners, np.stack([starts, starts + 1], axis=1), latents.astype(np.float16))


def queries(count, seed=9):
    return np.random.default_rng(seed).standard_normal((count, SIZE)).astype(np.float32)


def plainly(held, asked, k, allowed=None):
    """Scores and owners by a plain scan."""
    if allowed is not None:
        held = held[np.isin(held.owners, allowed)]
    scores = asked @ held.vectors.astype(np.float32).T
    best = np.argsort(-scores, axis=1)[:, :k]
    return np.take_along_axis(scores, best, axis=1), held.owners[best]


def test_search_is_a_plain_scan():
    held = rows(np.repeat(np.arange(1, 41), 5))
    scores, owners, starts, ends = FaissIndex.of(1, held).search(queries(7), 10)
    want_scores, want_owners = plainly(held, queries(7), 10)
    np.testing.assert_allclose(scores, want_scores, atol=1e-5)
    np.testing.assert_array_equal(owners, want_owners)
    np.testing.assert_array_equal(ends, starts + 1)
    assert scores.dtype == starts.dtype == np.float32
    assert owners.dtype == np.int64


@pytest.mark.parametrize("allowed", [[3], [1, 7, 39], list(range(0, 60, 2)), [-5, 10**9], []])
def test_only_allowed_owners_are_found(allowed):
    held = rows(np.repeat(np.arange(1, 41), 5))
    scores, owners, _, _ = FaissIndex.of(1, held).search(queries(3), 12, allowed=np.array(allowed, np.int64))
    want_scores, want_owners = plainly(held, queries(3), 12, allowed)
    found = want_owners.shape[1]
    np.testing.assert_array_equal(owners[:, :found], want_owners)
    np.testing.assert_allclose(scores[:, :found], want_scores, atol=1e-5)
    assert (owners[:, found:] == -1).all()
    assert np.isneginf(scores[:, found:]).all()


def test_where_there_are_fewer_rows_than_asked_for_the_rest_is_minus_one():
    scores, owners, _, _ = FaissIndex.of(1, rows([4, 4])).search(queries(1), 5)
    assert owners.tolist() == [[4, 4, -1, -1, -1]]
    assert np.isneginf(scores[0, 2:]).all()


def test_an_empty_index_finds_nothing():
    scores, owners, starts, ends = FaissIndex.of(0, IndexRows.none(SIZE)).search(queries(2), 3)
    assert owners.tolist() == [[-1] * 3] * 2
    assert scores.shape == starts.shape == ends.shape == (2, 3)


changes = st.lists(
    st.tuples(st.lists(st.integers(1, 30), max_size=6), st.lists(st.integers(1, 30), max_size=40)), max_size=6
)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.integers(1, 30), max_size=60), changes)
def test_after_any_changes_an_index_answers_as_one_built_anew(first, later):
    index, held = FaissIndex.of(0, rows(first)), rows(first)
    for generation, (remove, add) in enumerate(later, start=1):
        added = rows(add, seed=generation)
        index = index.update(generation, remove=np.array(remove, np.int64), add=added)
        held = IndexRows.join([held[~np.isin(held.owners, remove)], added])
    assert index.generation == len(later)
    assert len(index) == len(held)
    for allowed in (None, np.arange(1, 30, 3)):
        got = index.search(queries(4), 8, allowed=allowed)
        want = FaissIndex.of(0, held).search(queries(4), 8, allowed=allowed)
        np.testing.assert_allclose(got[0], want[0], atol=1e-5)


def test_the_old_index_answers_as_before_when_a_new_one_is_made():
    index = FaissIndex.of(1, rows([1, 2, 3]))
    before = index.search(queries(2), 3)
    index.update(2, remove=np.array([1, 2]), add=rows([9] * 50))
    for got, want in zip(index.search(queries(2), 3), before, strict=True):
        np.testing.assert_array_equal(got, want)


def test_rows_outlive_their_index():
    held = FaissIndex.of(1, rows(np.arange(5000))).rows
    np.testing.assert_array_equal(held.vectors, rows(np.arange(5000)).vectors)
    assert not held.vectors.flags.writeable


def test_small_changes_leave_the_main_block_alone_and_large_ones_make_a_new_one():
    index = FaissIndex.of(1, rows(np.arange(100)))
    assert index.update(2, remove=np.array([5]), add=rows([200])).shares_block(index)
    assert not index.update(2, remove=np.arange(50), add=IndexRows.none(SIZE)).shares_block(index)
    assert index.update(2, remove=np.arange(20), add=IndexRows.none(SIZE), compact_at=0.25).shares_block(index)


@pytest.mark.parametrize(("asked", "held", "shared"), [(1, 70_000, False), (2, 10, False), (64, 70_000, True)])
def test_threads_share_out_many_queries_of_many_rows_and_never_a_single_one(asked, held, shared, monkeypatch):
    """FAISS shares out queries, not rows: for one, further threads would only wait; see `Block.search`."""
    threads = []
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(faiss, "omp_set_num_threads", threads.append)
    FaissIndex.of(1, rows(np.arange(held))).search(queries(asked), 10)
    assert {count > 1 for count in threads} == {shared}


def test_it_is_a_vector_index():
    index: VectorIndex = FaissIndex.of(3, rows(range(10)))
    assert (index.generation, len(index)) == (3, 10)
