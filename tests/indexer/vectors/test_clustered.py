"""Many rows in clusters: nearly always what a plain scan finds, exactly where filters leave little."""

import faiss
import numpy as np
import pytest

from indexer.vectors import clustered_file, faiss_index, index_files
from indexer.vectors.blocks import IndexRows
from indexer.vectors.clustered import ClusteredBlock
from indexer.vectors.clustered_file import RowSource
from indexer.vectors.faiss_index import FaissIndex

SIZE, EACH = 32, 10


@pytest.fixture(scope="module")
def rows():
    """40,000 rows of 4,000 owners, each owner's alike and many owners alike."""
    rng = np.random.default_rng(0)
    kinds = rng.standard_normal((60, SIZE))
    owners = np.repeat(np.arange(1, 4001), EACH)
    own = kinds[rng.integers(0, 60, 4000)] + 0.5 * rng.standard_normal((4000, SIZE))
    latents = own[owners - 1] + 0.3 * rng.standard_normal((len(owners), SIZE))
    latents /= np.linalg.norm(latents, axis=1, keepdims=True)
    starts = np.tile(np.arange(EACH, dtype=np.float32), 4000)
    return IndexRows(owners, np.stack([starts, starts + 1], axis=1), latents.astype(np.float16))


@pytest.fixture(scope="module")
def clustered(rows):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(faiss_index, "CLUSTERED_FROM", 30_000)
        return FaissIndex.of(1, rows)


@pytest.fixture(scope="module")
def exact(rows):
    return FaissIndex.of(1, rows)


def queries(count=50):
    asked = np.random.default_rng(7).standard_normal((count, SIZE)).astype(np.float32)
    return asked / np.linalg.norm(asked, axis=1, keepdims=True)


def share_found(got, want):
    return np.mean([len(set(a) & set(b)) / len(set(b)) for a, b in zip(got, want, strict=True)])


def test_many_rows_are_clustered_and_few_are_not(clustered, exact):
    assert isinstance(clustered.main, ClusteredBlock)
    assert not isinstance(exact.main, ClusteredBlock)


def test_nearly_all_of_the_best_are_found_with_their_scores_and_spans(clustered, exact):
    scores, owners, starts, ends = clustered.search(queries(), 50)
    want_scores, want_owners, _, _ = exact.search(queries(), 50)
    assert share_found(owners, want_owners) > 0.95
    np.testing.assert_allclose(scores[:, 0], want_scores[:, 0], atol=1e-3)
    np.testing.assert_array_equal(ends, starts + 1)


@pytest.mark.parametrize("allowed", [[17], [3, 999, 4000], list(range(1, 400)), []])
def test_few_allowed_owners_are_all_found(clustered, exact, allowed):
    allowed = np.array(allowed, np.int64)
    scores, owners, _, _ = clustered.search(queries(5), 30, allowed=allowed)
    want_scores, want_owners, _, _ = exact.search(queries(5), 30, allowed=allowed)
    np.testing.assert_allclose(scores, want_scores, atol=1e-5)
    np.testing.assert_array_equal(owners, want_owners)


@pytest.mark.parametrize("share", [0.1, 0.01])
def test_of_the_rows_that_a_filter_leaves_nearly_all_of_the_best_are_found(clustered, exact, share):
    allowed = np.sort(np.random.default_rng(2).choice(np.arange(1, 4001), round(4000 * share), replace=False))
    _, owners, _, _ = clustered.search(queries(), 10, allowed=allowed)
    _, want, _, _ = exact.search(queries(), 10, allowed=allowed)
    assert share_found(owners, want) > 0.98


@pytest.mark.parametrize("allowed", [None, np.arange(1, 400)])
def test_an_exact_search_misses_nothing(clustered, exact, allowed):
    found = clustered.search(queries(), 50, allowed=allowed, exact=True)
    want = exact.search(queries(), 50, allowed=allowed)
    np.testing.assert_allclose(found[0], want[0], atol=1e-3)
    assert share_found(found[1], want[1]) == 1


def test_the_rows_come_back_in_order(clustered, rows):
    np.testing.assert_array_equal(clustered.rows.owners, rows.owners)
    np.testing.assert_array_equal(clustered.rows.vectors, rows.vectors)


def test_changes_are_seen(clustered, rows):
    new = IndexRows(np.array([9999]), np.array([[0, 1]], np.float32), queries(1).astype(np.float16))
    changed = clustered.update(2, remove=np.array([5]), add=new)
    assert changed.search(queries(1), 1)[1].tolist() == [[9999]]
    of_the_gone = rows.vectors[rows.owners == 5][:1].astype(np.float32)
    assert 5 not in changed.search(of_the_gone, 100)[1]
    assert 5 in clustered.search(of_the_gone, 100)[1]


def test_a_file_holds_the_clusters(clustered, tmp_path):
    index_files.save(clustered, tmp_path, "windows", "model")
    again = index_files.load(tmp_path, "windows", lambda generation: "model", SIZE)
    assert isinstance(again.main, ClusteredBlock)
    for got, want in zip(again.search(queries(), 20), clustered.search(queries(), 20), strict=True):
        np.testing.assert_array_equal(got, want)
    np.testing.assert_array_equal(again.rows.vectors, clustered.rows.vectors)


@pytest.mark.parametrize("piece", [4096, 1000])
def test_a_file_written_in_pieces_is_that_of_the_index_in_memory(rows, tmp_path, piece):
    def pieces():
        for first in range(0, len(rows), piece):
            yield rows[np.arange(len(rows))[first : first + piece]]

    owners, spans = clustered_file.write(tmp_path / "pieces", RowSource(SIZE, pieces))
    faiss.write_index(ClusteredBlock.of(rows).index, str(tmp_path / "whole"))
    assert (tmp_path / "pieces").read_bytes() == (tmp_path / "whole").read_bytes()
    np.testing.assert_array_equal(owners, rows.owners)
    np.testing.assert_array_equal(spans, rows.spans)


def test_a_version_of_faiss_with_other_files_is_noticed(rows, tmp_path, monkeypatch):
    monkeypatch.setattr(clustered_file, "_NO_LISTS", b"new")
    with pytest.raises(RuntimeError, match="other files"):
        clustered_file.write(tmp_path / "pieces", RowSource(SIZE, lambda: iter([rows])))
