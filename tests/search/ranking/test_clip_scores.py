"""Clip scores: a clip scores as a whole and by its best windows, and windows of one clip do not overlap."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
import pytest

from encoders.bundle.windows import LENGTHS
from indexer.vectors.blocks import IndexRows
from search.ranking import clip_scores as clip_scores_module
from search.ranking.clip_scores import WHOLE_SHARE, ClipScore, best_clips, clip_scores, highest_scores
from search.ranking.window_ranking import rank_candidate_clips, rank_windows

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

    def vectors_of(self, ids: np.ndarray) -> tuple[IndexRows, IndexRows]:
        wanted = set(ids.tolist())
        shown = [i for i in reversed(self.clip_scores) if i in wanted]
        rows = [row for row in self.rows if row[0] in wanted]
        return self._rows([(i, 0, 9, self.clip_scores[i]) for i in shown]), self._rows(rows)

    @staticmethod
    def _rows(rows: Any) -> IndexRows:
        owners, spans = np.array([r[0] for r in rows], np.int64), np.array([r[1:3] for r in rows], np.float32)
        return IndexRows(owners, spans.reshape(-1, 2), np.array([_unit(r[3]) for r in rows], np.float32).reshape(-1, 2))

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


def expected(gallery: Gallery, clip: int, share: float = WHOLE_SHARE) -> float:
    """The definition, written out."""
    whole, best = gallery.clip_scores[clip], dict.fromkeys(LENGTHS, -1.0)
    for owner, start, end, cosine in gallery.rows:
        length = min(LENGTHS, key=lambda length: abs(length - (end - start)))
        best[length] = max(best[length], cosine) if owner == clip else best[length]
    return share * whole + (1 - share) * float(np.mean([whole if best[n] == -1 else best[n] for n in LENGTHS]))


def test_a_clip_that_is_wholly_about_it_comes_before_one_that_is_partly() -> None:
    gallery = Gallery({1: 0.5, 2: 0.2, 3: 0.1}, [(1, 0, 1.6, 0.5), (2, 30, 31.6, 0.6), (3, 5, 6.6, 0.2)])
    assert [e.clip_id for e in _ask(gallery, 3)] == [1, 2, 3]


def test_a_window_of_each_length_counts_and_where_there_is_none_the_whole() -> None:
    gallery = Gallery({1: 0.4}, [(1, 0, 1.6, 0.6), (1, 3, 4.6, 0.9), (1, 2, 5.2, 0.7)])
    assert _ask(gallery, 1)[0].score == pytest.approx(0.5 * 0.4 + 0.5 * (0.9 + 0.7 + 0.4) / 3)
    assert _ask(gallery, 1, whole_share=0.0)[0].score == pytest.approx((0.9 + 0.7 + 0.4) / 3)
    assert _ask(gallery, 1, whole_share=1.0)[0].score == pytest.approx(0.4)


def test_a_short_clip_counts_by_its_only_window() -> None:
    assert _ask(Gallery({1: 0.4}, [(1, 0, 0.7, 0.4)]), 1)[0].score == pytest.approx(0.4)


def test_one_clip_with_many_windows_does_not_keep_others_out() -> None:
    crowd = [(1, i * 0.1, i * 0.1 + 1.6, 0.9) for i in range(5000)]
    gallery = Gallery({1: 0.1, 2: 0.1, 3: 0.1}, [*crowd, (2, 0, 1.6, 0.5), (3, 0, 1.6, 0.4)])
    assert [e.clip_id for e in _ask(gallery, 3)] == [1, 2, 3]


def _galleries() -> Iterator[Gallery]:
    """Galleries in which windows and whole clips disagree, and one clip's windows fill the first fetch."""
    for seed in range(40):
        rng = np.random.default_rng(seed)
        count, spread = 30 + 20 * seed, (0.01, 0.1, 0.5)[seed % 3]
        clip_scores = {i: float(0.4 + spread * rng.uniform()) for i in range(count)}
        crowd = [(0, i * 0.1, i * 0.1 + 1.6, 0.41 + spread) for i in range(60 * (seed % 4))]
        heights = 0.4 + spread * rng.uniform(size=4 * count)
        lengths = rng.choice(LENGTHS, len(heights))
        windows = [(i % count, i, i + n, float(h)) for i, (n, h) in enumerate(zip(lengths, heights, strict=True))]
        yield Gallery(clip_scores, crowd + windows)


@pytest.fixture
def small_fetches(monkeypatch: pytest.MonkeyPatch) -> None:
    """So few rows are fetched first that small galleries need a second fetch."""
    monkeypatch.setattr(clip_scores_module, "_FIRST_CLIPS_RANKED", 80)
    monkeypatch.setattr(clip_scores_module, "_FIRST_WINDOWS_RANKED", 160)


@pytest.mark.usefixtures("small_fetches")
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_first_clips_do_not_depend_on_how_many_are_asked_for(share: float) -> None:
    for gallery in _galleries():
        many = _ask(gallery, len(gallery), whole_share=share)
        assert sorted(e.clip_id for e in many) == sorted(gallery.clip_scores)
        assert many == sorted(many, key=lambda e: (-e.score, e.clip_id))
        for k in (1, 3, 10, 25):
            assert _ask(gallery, k, whole_share=share) == many[:k]


@pytest.mark.usefixtures("small_fetches")
def test_every_score_is_that_of_its_definition_and_none_that_is_higher_is_missed() -> None:
    for gallery in list(_galleries())[:12]:
        truth = {clip: expected(gallery, clip) for clip in gallery.clip_scores}
        found = _ask(gallery, 10)
        assert [e.score for e in found] == pytest.approx(sorted(truth.values(), reverse=True)[:10], abs=1e-5)
        assert [e.score for e in found] == pytest.approx([truth[e.clip_id] for e in found], abs=1e-5)


def test_the_highest_scores_of_added_clips() -> None:
    queries = np.array([[1, 0], [0, 1]], np.float32)
    for gallery in list(_galleries())[:3]:
        rows = gallery.vectors_of(np.array(list(gallery.clip_scores)))
        assert highest_scores(queries, *rows).tolist() == pytest.approx(
            clip_scores(queries, *rows).max(axis=1).tolist()
        )
    nothing = gallery.vectors_of(np.array([], np.int64))
    assert highest_scores(queries, *nothing).tolist() == [-np.inf, -np.inf]


@pytest.mark.usefixtures("small_fetches")
def test_few_rows_are_fetched_for_few_clips() -> None:
    heights = {i: 0.9 - i / 4000 for i in range(3000)}
    gallery = Gallery(heights, [(i, 0, 1.6, height) for i, height in heights.items()])
    _ask(gallery, 10)
    assert gallery.most_asked == 160


def test_only_allowed_clips_answer() -> None:
    gallery = Gallery({1: 0.9, 2: 0.5}, [(1, 0, 2, 0.9), (2, 0, 2, 0.4)])
    assert [e.clip_id for e in _ask(gallery, 5, allowed=np.array([2]))] == [2]
    assert _ask(gallery, 5, allowed=np.array([], np.int64)) == []


def test_few_allowed_clips_rank_as_among_all() -> None:
    heights = {i: 0.2 + (i * 37 % 100) / 200 for i in range(100)}
    gallery = Gallery(heights, [(i, 0, 1.6, 1 - height) for i, height in heights.items()])
    some = np.arange(0, 100, 7)
    wanted = [score for score in _ask(gallery, 100) if score.clip_id in some]
    assert _ask(gallery, 100, allowed=some) == wanted


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
