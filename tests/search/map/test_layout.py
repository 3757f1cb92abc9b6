"""The map of a library."""

from __future__ import annotations

import numpy as np
import pytest

from search.map import layout


def _groups(count: int, each: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors around `count` directions, and which each belongs to."""
    rng = np.random.default_rng(seed)
    group = np.repeat(np.arange(count), each)
    vectors = rng.standard_normal((count, 32))[group] + 0.4 * rng.standard_normal((len(group), 32))
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32), group


def _same_group_nearest(points: np.ndarray, group: np.ndarray) -> float:
    far = ((points[:, None] - points) ** 2).sum(axis=-1)
    np.fill_diagonal(far, np.inf)
    return float((group[far.argmin(axis=1)] == group).mean())


def test_what_is_alike_lies_together():
    vectors, group = _groups(12, 20)
    points = layout.lay_out(vectors)
    assert _same_group_nearest(points, group) > 0.97
    assert points.min() >= 0
    assert points.max() <= 1
    assert np.ptp(points, axis=0).max() == pytest.approx(1, abs=1e-5)


def test_what_is_not_in_the_sample_lies_with_its_like():
    vectors, group = _groups(8, 60)
    assert _same_group_nearest(layout.lay_out(vectors, sample=160), group) > 0.95


@pytest.mark.slow
def test_a_large_sample_is_laid_out_by_the_library_and_tells_how_far_it_is():
    pytest.importorskip("openTSNE")
    vectors, group = _groups(10, 30)
    told: list[float] = []
    points = layout.lay_out(vectors, library=True, progress=told.append)
    assert _same_group_nearest(points, group) > 0.95
    assert len(told) > 20
    assert told == sorted(told)
    assert 0 <= told[0] < told[-1] <= 1
    assert np.isfinite(layout.lay_out(np.ones((30, 16), np.float32) / 4, library=True)).all()


def test_a_map_is_the_same_each_time():
    vectors, _ = _groups(4, 10)
    np.testing.assert_array_equal(layout.lay_out(vectors), layout.lay_out(vectors))


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_few_clips_have_a_map_too(count):
    points = layout.lay_out(np.eye(count, 16, dtype=np.float32))
    assert points.shape == (count, 2)
    assert np.isfinite(points).all()


def test_clips_that_are_all_the_same_have_a_map():
    assert np.isfinite(layout.lay_out(np.ones((30, 16), np.float32) / 4)).all()


def test_labels_are_the_nearest_sentences_the_most_frequent_first():
    texts, sentences = ["sits", "walks", "waves"], np.eye(3, 8, dtype=np.float32)
    vectors = np.repeat(np.eye(3, 8, dtype=np.float32), [1, 0, 4], axis=0)
    library_map = layout.make_map(7, np.arange(1, 6), vectors, texts, sentences)
    assert library_map.labels == ("waves", "sits")
    assert library_map.label.tolist() == [1, 0, 0, 0, 0]


def test_an_empty_library_has_an_empty_map():
    library_map = layout.make_map(
        0, np.empty(0, np.int64), np.empty((0, 8), np.float32), ["a"], np.ones((1, 8), np.float32)
    )
    assert library_map.document() == {"generation": 0, "clips": [], "x": [], "y": [], "labels": [], "label": []}
