"""Moments: found where they are, several of them, in memory that does not grow with the take."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.bundle.windows import window_starts
from search.moments.localisation import Moment, localise, score_take
from search.moments.window_scores import Scored, curve, score_windows
from search.spans import iou, suppress
from tests.search.fakes import FPS, MeanEncoder, query, take


def _overlap(found: object, start: float, end: float) -> float:
    return float(iou([found.start], [found.end], start, end)[0])  # type: ignore[attr-defined]


def test_iou_of_spans() -> None:
    assert iou([0, 0, 5, 20], [10, 5, 15, 30], 0, 10).tolist() == pytest.approx([1, 0.5, 1 / 3, 0])


def test_suppression_keeps_the_best_and_what_does_not_overlap_it() -> None:
    kept = suppress([0, 1, 20, 21], [10, 11, 30, 31], [0.5, 0.9, 0.3, 0.2], 5, overlap=0.3)
    assert kept.tolist() == [1, 2]


def test_suppression_answers_at_most_k() -> None:
    assert len(suppress(np.arange(9) * 10, np.arange(9) * 10 + 5, np.arange(9), 4, overlap=0.3)) == 4


@pytest.mark.parametrize(("start", "end"), [(3.0, 4.5), (11.3, 14.9), (24.0, 30.0)])
def test_a_moment_is_found_where_it_is(start: float, end: float) -> None:
    best = localise(MeanEncoder(), take(40, (start, end, 2), (33, 36, 5)), FPS, query(2), 1)[0]
    assert _overlap(best, start, end) > 0.6


def test_a_moment_may_be_longer_than_any_window() -> None:
    best = localise(MeanEncoder(), take(120, (20, 75, 2)), FPS, query(2), 1)[0]
    assert _overlap(best, 20, 75) > 0.9


def test_several_moments_of_one_query() -> None:
    truth = [(5.0, 7.0), (20.0, 23.0), (31.0, 34.5)]
    found = localise(MeanEncoder(), take(40, *((a, b, 1) for a, b in truth)), FPS, query(1), 3)
    assert all(max(_overlap(moment, a, b) for moment in found) > 0.5 for a, b in truth)


def test_answers_do_not_overlap() -> None:
    found = localise(MeanEncoder(), take(60, (5, 15, 1)), FPS, query(1), 8)
    for i, a in enumerate(found):
        assert all(_overlap(a, b.start, b.end) <= 0.3 + 1e-9 for b in found[i + 1 :])


def test_the_first_answers_do_not_depend_on_how_many_are_asked_for() -> None:
    features = take(400, *((float(at), at + 3.0, 1) for at in range(5, 395, 12)))
    many = localise(MeanEncoder(), features, FPS, query(1), 60)
    assert len(many) == 60, "more than one round of places"
    for k in (1, 7, 31, 45):
        assert localise(MeanEncoder(), features, FPS, query(1), k) == many[:k]


def test_things_at_the_same_time_are_found_where_both_happen() -> None:
    features = take(40, (5, 12, 1), (9, 20, 2))
    best = localise(MeanEncoder(), features, FPS, query(1, 2), 1)[0]
    assert _overlap(best, 9, 12) > 0.5


@pytest.mark.parametrize("frames", [1, 2, 9, 16, 17])
def test_takes_shorter_than_any_window(frames: int) -> None:
    found = localise(MeanEncoder(), take(5)[:frames], FPS, query(0), 3)
    assert found
    assert all(0 <= m.start < m.end <= frames / FPS for m in found)


def test_stored_windows_give_the_same_answer_and_spare_their_encoding() -> None:
    features = take(120, (40, 43, 3))
    fresh, spared = MeanEncoder(), MeanEncoder()
    coarse = score_take(MeanEncoder(), features, FPS, query(3))
    assert localise(fresh, features, FPS, query(3), 2) == localise(spared, features, FPS, query(3), 2, coarse=coarse)
    assert spared.encoded < fresh.encoded


def test_memory_is_bounded() -> None:
    encoder = MeanEncoder()
    score_windows(encoder, take(7200), FPS, window_starts(72_000, 16), 16, query(0))
    assert encoder.most_at_once <= 4096


def test_the_curve_interpolates_between_the_centres_of_windows() -> None:
    windows = Scored(np.array([0.0, 1.0]), np.array([2.0, 3.0]), np.array([[0.0, 1.0]], np.float32))
    assert curve(windows, np.array([0.0, 1.0, 1.5, 2.0, 9.0]))[0].tolist() == pytest.approx([0, 0, 0.5, 1, 1])


def test_a_moment_is_judged_by_its_highest_instant() -> None:
    assert Moment(0.0, 2.0, 0.4, 0.6).height == 0.6
    assert Moment(0.0, 2.0, 0.4).height == 0.4, "a window is as high as its score"
