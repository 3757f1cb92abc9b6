"""An index grows by what is added to it: cheaply, without a search that is answered worse, and never under a reader."""

import threading

import numpy as np
import pytest

from indexer.vectors import faiss_index
from indexer.vectors.blocks import Block, IndexRows, Mask, MaskedBlock
from indexer.vectors.clustered import ClusteredBlock
from indexer.vectors.faiss_index import FaissIndex

SIZE, BATCH = 32, 250
FIRST, LATER = 20_000, 40


def kinds():
    return np.random.default_rng(0).standard_normal((60, SIZE))


def some_rows(count, first_owner, seed):
    """Rows of which many are alike, ten to an owner."""
    rng = np.random.default_rng(seed)
    latents = kinds()[rng.integers(0, 60, count)] + 0.5 * rng.standard_normal((count, SIZE))
    latents /= np.linalg.norm(latents, axis=1, keepdims=True)
    spans = np.tile(np.arange(count, dtype=np.float32)[:, None], (1, 2))
    return IndexRows(first_owner + np.arange(count) // 10, spans, latents.astype(np.float16))


@pytest.fixture
def small_limits(monkeypatch):
    monkeypatch.setattr(faiss_index, "CLUSTERED_FROM", FIRST)
    monkeypatch.setattr(faiss_index, "ADDED_CLUSTERED_FROM", 4 * BATCH)


@pytest.fixture
def touched(monkeypatch):
    """How many rows went into each block that was made."""
    counts = []

    def counted(made):
        def make(*given):
            block = made(*given)
            counts.append(len(block))
            return block

        return make

    monkeypatch.setattr(Block, "of", staticmethod(counted(Block.of)))
    monkeypatch.setattr(ClusteredBlock, "of", staticmethod(counted(ClusteredBlock.of)))
    return counts


def grown(index, batches=LATER, *, compact_at=10.0):
    """The index after `batches` updates, and all they added."""
    added = [some_rows(BATCH, 10_000 + 100 * i, seed=i + 1) for i in range(batches)]
    for i, rows in enumerate(added):
        index = index.update(i + 2, remove=np.unique(rows.owners), add=rows, compact_at=compact_at).for_serving()
    return index, IndexRows.join(added)


def asked(count=40):
    rng = np.random.default_rng(7)
    latents = kinds()[rng.integers(0, 60, count)] + 0.5 * rng.standard_normal((count, SIZE))
    return (latents / np.linalg.norm(latents, axis=1, keepdims=True)).astype(np.float32)


def exactly(rows, queries, k=20):
    return FaissIndex(0, Block.of(rows)).search(queries, k)


def share_found(got, want):
    return np.mean([len(set(a) & set(b)) / len(set(b)) for a, b in zip(got, want, strict=True)])


def test_a_row_is_touched_a_few_times_however_many_updates_there_are(small_limits, touched):
    index = FaissIndex.of(1, some_rows(FIRST, 1, seed=0))
    touched.clear()
    grown(index)
    assert max(touched) <= LATER * BATCH  # never the library
    assert sum(touched) <= LATER * BATCH * (1 + np.log2(LATER))


def test_few_parts_are_searched_and_all_that_are_large_are_in_clusters(small_limits):
    index, _ = grown(FaissIndex.of(1, some_rows(FIRST, 1, seed=0)))
    added = index.blocks[1:]
    assert len(added) <= np.log2(LATER)
    assert all(isinstance(block, ClusteredBlock) for block in added if len(block) >= 4 * BATCH)


def test_a_small_index_stays_exact_as_it_grows():
    first = some_rows(2000, 1, seed=0)
    index, added = grown(FaissIndex.of(1, first))
    assert len(index.blocks) > 1
    for got, want in zip(index.search(asked(), 20), exactly(IndexRows.join([first, added]), asked()), strict=True):
        np.testing.assert_array_equal(got, want)


def test_what_was_added_to_clusters_is_found_as_what_was_there_before(small_limits):
    first = some_rows(FIRST, 1, seed=0)
    index, added = grown(FaissIndex.of(1, first))
    assert len(index) == FIRST + LATER * BATCH
    found = share_found(index.search(asked(), 20)[1], exactly(IndexRows.join([first, added]), asked())[1])
    before = share_found(FaissIndex.of(1, first).search(asked(), 20)[1], exactly(first, asked())[1])
    assert found >= before - 0.01 > 0.9
    own = added.vectors[::100].astype(np.float32)
    np.testing.assert_array_equal(index.search(own, 1)[1][:, 0], added.owners[::100])


def test_what_came_is_exact_until_many_searches_are_to_come(small_limits):
    new = some_rows(8 * BATCH, 50_000, seed=3)
    index = FaissIndex.of(1, some_rows(FIRST, 1, seed=0)).update(
        2, remove=np.empty(0, np.int64), add=new, compact_at=1.0
    )
    assert [type(block) for block in index.blocks[1:]] == [Block]
    assert [type(block) for block in index.for_serving().blocks[1:]] == [ClusteredBlock]
    assert len(index.for_serving().for_serving().blocks[1]) == len(new)


@pytest.mark.parametrize("limits", ["exact", "clusters"])
def test_what_is_removed_is_gone_wherever_it_lay(limits, request):
    if limits == "clusters":
        request.getfixturevalue("small_limits")
    first = some_rows(FIRST, 1, seed=0)
    index, added = grown(FaissIndex.of(1, first))
    remove = np.array([3, 1500, 10_000, 10_907, 13_907, 77_777])
    changed = index.update(100, remove=remove, add=IndexRows.none(SIZE))
    everything = IndexRows.join([first, added])
    left = everything[~np.isin(everything.owners, remove)]
    assert len(changed) == len(left)
    assert sorted(changed.rows.owners) == sorted(left.owners)
    gone = everything[np.isin(everything.owners, remove)].vectors.astype(np.float32)
    assert not np.isin(changed.search(gone, 10)[1], remove).any()
    assert np.isin(index.search(gone, 10)[1], remove).any(axis=1).all()  # the old index has them still
    allowed = np.arange(1, 20_000, 7)
    want = exactly(left[np.isin(left.owners, allowed)], asked())
    assert share_found(changed.search(asked(), 20, allowed=allowed)[1], want[1]) > 0.9


def test_a_grown_index_becomes_one_block_with_the_same_rows(small_limits):
    first = some_rows(FIRST, 1, seed=0)
    index, added = grown(FaissIndex.of(1, first))
    left = (everything := IndexRows.join([first, added]))[~np.isin(everything.owners, [5, 10_100])]
    whole = index.update(50, remove=np.array([5, 10_100]), add=IndexRows.none(SIZE)).compacted()
    assert whole.blocks == [whole.main]
    np.testing.assert_array_equal(whole.rows.owners, left.owners)
    np.testing.assert_array_equal(whole.rows.spans, left.spans)
    np.testing.assert_array_equal(whole.rows.vectors, left.vectors)


def test_readers_of_an_older_index_never_meet_a_change(small_limits):
    first = some_rows(FIRST, 1, seed=0)
    index, _ = grown(FaissIndex.of(1, first), 6)
    before, wrong, done = index.search(asked(), 20), [], threading.Event()

    def read():
        while not done.is_set():
            wrong.extend(1 for a, b in zip(index.search(asked(), 20), before, strict=True) if (a != b).any())

    reader = threading.Thread(target=read)
    reader.start()
    grown(index)
    done.set()
    reader.join()
    assert not wrong


def test_a_mask_loses_rows_once():
    chosen = np.arange(21) % 3 > 0
    mask = Mask.of(chosen)
    less = mask.without(np.array([1, 3, 20]))  # 3 was not chosen
    assert less.count == mask.count - 2 == less.chosen(21).sum()
    assert sorted(np.flatnonzero(mask.chosen(21) & ~less.chosen(21))) == [1, 20]
    assert (mask.chosen(21) == chosen).all()
    assert (less & Mask.of(np.arange(21) < 5)).count == 2


@pytest.mark.parametrize("order", ["as they come", "shuffled"])
def test_the_rows_of_owners_are_found(order):
    owners = np.repeat(np.arange(50), 3)
    if order == "shuffled":
        owners = np.random.default_rng(0).permutation(owners)
    held = some_rows(150, 0, seed=1)
    block = Block.of(IndexRows(owners, held.spans, held.vectors))
    for wanted in ([7], [3, 49, 3, 1000], [-1], [], range(50)):
        got = np.sort(block.rows_of(np.array(wanted, np.int64)))
        np.testing.assert_array_equal(got, np.flatnonzero(np.isin(owners, list(wanted))))
    assert len(MaskedBlock(block).without(np.array([4, 5]))) == 144


def test_an_index_for_serving_searches_its_main_block_once(monkeypatch):
    """The same answers, before and after it grew and lost clips, and none from what was there no more."""
    searched = []
    search = Block.search
    monkeypatch.setattr(Block, "search", lambda block, *a, **b: searched.append(len(block)) or search(block, *a, **b))
    plain = FaissIndex.of(1, some_rows(5000, 0, seed=0))
    serving, query = plain.for_serving(), some_rows(1, 0, seed=9).vectors.astype(np.float32)
    first, again = (serving.search(query, 10) for _ in range(2))
    assert searched == [5000]
    added, gone = some_rows(BATCH, 10_000, seed=1), np.unique(first[1])
    grown, shrunk = (serving.update(2, remove=gone[:n], add=added).for_serving() for n in (0, len(gone)))
    assert searched == [5000]
    for index, removed in ((grown, gone[:0]), (shrunk, gone)):
        exact = plain.update(2, remove=removed, add=added)
        for got, wanted in zip(index.search(query, 10), exact.search(query, 10), strict=True):
            np.testing.assert_array_equal(got, wanted)
    assert not set(shrunk.search(query, 10)[1][0]) & set(gone)
    for got, wanted in zip(again, plain.search(query, 10), strict=True):
        np.testing.assert_array_equal(got, wanted)
