"""Clip scores: a clip scores as its best window or its whole, and windows of one clip do not overlap."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
import pytest

from search.ranking.clip_scores import (
    WINDOW_MARGIN,
    ClipScore,
    best_clips,
    rank_candidate_clips,
    rank_windows,
)

QUERY = np.array([1.0, 0.0], np.float32)


def _unit(cosine: float) -> list[float]:
    return [cosine, float(np.sqrt(1 - cosine**2))]


class Gallery:
    """A library of clips given as {id: whole} and windows as (clip, start, end, cosine)."""

    def __init__(self, clip_scores: dict[int, float], windows: list[tuple[int, float, float, float]]) -> None:
        self.clip_scores, self.rows = clip_scores, windows
        self.most_asked = 0

    def __len__(self) -> int:
        return len(self.clip_scores)

    def nearest_clips(self, queries: np.ndarray, k: int, *, allowed: Any = None) -> Any:
        ids = [i for i in self.clip_scores if allowed is None or i in allowed]
        return self._best(queries, k, [(i, self.clip_scores[i]) for i in ids])

    def nearest_windows(self, queries: np.ndarray, k: int, *, allowed: Any = None) -> Any:
        self.most_asked = max(self.most_asked, k)
        rows = [r for r in self.rows if allowed is None or r[0] in allowed]
        scores, order = self._best(queries, k, [(n, r[3]) for n, r in enumerate(rows)])
        columns = np.array([(r[0], r[1], r[2]) for r in rows] + [(-1, 0, 0)], float)[order]
        return scores, columns[..., 0].astype(int), columns[..., 1], columns[..., 2]

    @staticmethod
    def _best(queries: np.ndarray, k: int, named: list[tuple[int, float]]) -> tuple[np.ndarray, np.ndarray]:
        vectors = np.array([_unit(cosine) for _, cosine in named]).reshape(-1, 2)
        scores = queries @ vectors.T
        order = np.argsort(-scores, axis=1)[:, :k]
        missing = ((0, 0), (0, max(k - order.shape[1], 0)))
        best = np.pad(np.take_along_axis(scores, order, axis=1), missing, constant_values=-np.inf)
        return best, np.pad(np.array([i for i, _ in named])[order], missing, constant_values=-1)


def _ask(gallery: Gallery, k: int, **more: Any) -> list[ClipScore]:
    return best_clips(gallery, QUERY, k, **more)


def _windows(gallery: Gallery, k: int) -> list[ClipScore]:
    return list(islice(rank_windows(gallery, QUERY), k))


def test_a_short_action_in_a_long_clip_is_found_and_named() -> None:
    gallery = Gallery({1: 0.5, 2: 0.2}, [(1, 0, 2, 0.5), (2, 30, 32, 0.9)])
    first, second = _ask(gallery, 2)
    assert (first.clip_id, first.start, first.end) == (2, 30, 32)
    assert (second.clip_id, second.start) == (1, None)


def test_a_window_that_is_hardly_better_is_not_its_score() -> None:
    gallery = Gallery({1: 0.5}, [(1, 0, 2, 0.5 + WINDOW_MARGIN / 2)])
    assert _ask(gallery, 1) == [ClipScore(1, pytest.approx(0.5))]


def test_one_clip_with_many_windows_does_not_keep_others_out() -> None:
    crowd = [(1, i * 0.1, i * 0.1 + 2, 0.9) for i in range(500)]
    gallery = Gallery({1: 0.1, 2: 0.1, 3: 0.1}, [*crowd, (2, 0, 2, 0.5), (3, 0, 2, 0.4)])
    assert [e.clip_id for e in _ask(gallery, 3)] == [1, 2, 3]


def _galleries() -> Iterator[Gallery]:
    """Galleries in which windows and whole clips disagree, and one clip's windows fill the first fetch."""
    for seed in range(40):
        rng = np.random.default_rng(seed)
        count, spread = 30 + 20 * seed, (0.01, 0.1, 0.5)[seed % 3]
        clip_scores = {i: float(0.4 + spread * rng.uniform()) for i in range(count)}
        crowd = [(0, i * 0.1, i * 0.1 + 2, 0.41 + spread) for i in range(60 * (seed % 4))]
        heights = 0.4 + spread * rng.uniform(size=4 * count)
        yield Gallery(clip_scores, crowd + [(i % count, i, i + 2, float(score)) for i, score in enumerate(heights)])


@pytest.mark.parametrize("windows", [True, False])
def test_the_first_clips_do_not_depend_on_how_many_are_asked_for(windows: bool) -> None:
    for gallery in _galleries():
        many = _ask(gallery, len(gallery), windows=windows)
        assert sorted(e.clip_id for e in many) == sorted(gallery.clip_scores)
        assert many == sorted(many, key=lambda e: (-e.score, e.clip_id))
        for k in (1, 3, 10, 25):
            assert _ask(gallery, k, windows=windows) == many[:k]


def test_a_clip_counts_as_its_whole_unless_a_window_is_clearly_better() -> None:
    for gallery in _galleries():
        windows = {clip: max(r[3] for r in gallery.rows if r[0] == clip) for clip in gallery.clip_scores}
        for e in _ask(gallery, 10):
            whole, window = gallery.clip_scores[e.clip_id], windows[e.clip_id]
            assert e.score == pytest.approx(window if window > whole + WINDOW_MARGIN else whole, abs=1e-5)


def test_few_rows_are_fetched_for_few_clips() -> None:
    gallery = Gallery(dict.fromkeys(range(3000), 0.0), [(i, 0, 2, 0.9 - i / 4000) for i in range(3000)])
    _ask(gallery, 10)
    assert gallery.most_asked < 300


def test_only_allowed_clips_answer() -> None:
    gallery = Gallery({1: 0.9, 2: 0.5}, [(1, 0, 2, 0.9), (2, 0, 2, 0.4)])
    assert [e.clip_id for e in _ask(gallery, 5, allowed=np.array([2]))] == [2]
    assert _ask(gallery, 5, allowed=np.array([], np.int64)) == []


def test_an_empty_library_and_more_asked_than_there_is() -> None:
    assert _ask(Gallery({}, []), 5) == []
    assert len(_ask(Gallery({1: 0.9}, [(1, 0, 2, 0.8)]), 100)) == 1


def test_spans_of_one_clip_do_not_overlap_and_those_of_others_may() -> None:
    gallery = Gallery({1: 0, 2: 0}, [(1, 0, 2, 0.9), (1, 0.5, 2.5, 0.8), (1, 10, 12, 0.7), (2, 0.5, 2.5, 0.6)])
    found = _windows(gallery, 5)
    assert [(e.clip_id, e.start) for e in found] == [(1, 0), (1, 10), (2, 0.5)]


def test_the_first_spans_do_not_depend_on_how_many_are_asked_for() -> None:
    crowd = [(1, i * 0.01, i * 0.01 + 2, 0.9 - i * 1e-4) for i in range(700)]  # fills the first fetch with few spans
    others = [(2 + i % 7, i * 3.0, i * 3.0 + 2, 0.7 - i * 1e-3) for i in range(100)]
    gallery = Gallery(dict.fromkeys(range(1, 9), 0.0), crowd + others)
    many = _windows(gallery, 200)
    assert {e.clip_id for e in many} == set(range(1, 9))
    for k in (1, 5, 20, 90):
        assert _windows(gallery, k) == many[:k]


def test_every_likely_clip_comes_once() -> None:
    gallery = Gallery(dict.fromkeys(range(50), 0.0), [(i, 0, 2, 0.9 - i / 100) for i in range(50)])
    assert list(rank_candidate_clips(gallery, QUERY[None])) == list(range(50))


def test_the_clips_most_likely_to_answer_several_sentences() -> None:
    both = np.array([[1, 0], [0, 1]], np.float32)
    rows = [(1, 0, 2, 0.99), (2, 0, 2, 0.05), (3, 0, 2, 0.75)]
    assert next(rank_candidate_clips(Gallery({1: 0, 2: 0, 3: 0}, rows), both)) == 3
