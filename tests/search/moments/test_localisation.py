"""Moments of one motion: found where they are, several of them, in an order that does not depend on k."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest

from search.moments.localisation import rank_moments
from search.spans import Moment, temporal_iou
from tests.search.fakes import FPS, MeanEncoder, queried, take


def best(features: np.ndarray, *kinds: int, k: int) -> list[Moment]:
    return list(islice(rank_moments(queried(features, *kinds)), k))


def _overlap(found: Moment, start: float, end: float) -> float:
    return float(temporal_iou([found.start], [found.end], start, end)[0])


@pytest.mark.parametrize(("start", "end"), [(3.0, 4.5), (11.3, 14.9), (24.0, 30.0)])
def test_a_moment_is_found_where_it_is(start: float, end: float) -> None:
    found = best(take(40, (start, end, 2), (33, 36, 5)), 2, k=1)[0]
    assert _overlap(found, start, end) > 0.6


def test_a_moment_may_be_longer_than_any_window() -> None:
    found = best(take(120, (20, 75, 2)), 2, k=1)[0]
    assert _overlap(found, 20, 75) > 0.9


def test_several_moments_of_one_query() -> None:
    truth = [(5.0, 7.0), (20.0, 23.0), (31.0, 34.5)]
    found = best(take(40, *((a, b, 1) for a, b in truth)), 1, k=3)
    assert all(max(_overlap(moment, a, b) for moment in found) > 0.5 for a, b in truth)


def test_answers_do_not_overlap() -> None:
    found = best(take(60, (5, 15, 1)), 1, k=8)
    for i, a in enumerate(found):
        assert all(_overlap(a, b.start, b.end) <= 0.3 + 1e-9 for b in found[i + 1 :])


def test_the_first_answers_do_not_depend_on_how_many_are_asked_for() -> None:
    features = take(400, *((float(at), at + 3.0, 1) for at in range(5, 395, 12)))
    many = best(features, 1, k=60)
    assert len(many) == 60, "more than one round of places"
    for k in (1, 7, 31, 45):
        assert best(features, 1, k=k) == many[:k]


def test_things_at_the_same_time_are_found_where_both_happen() -> None:
    features = take(40, (5, 12, 1), (9, 20, 2))
    found = best(features, 1, 2, k=1)[0]
    assert _overlap(found, 9, 12) > 0.5


@pytest.mark.parametrize("frames", [1, 2, 9, 16, 17])
def test_takes_shorter_than_any_window(frames: int) -> None:
    found = best(take(5)[:frames], 0, k=3)
    assert found
    assert all(0 <= m.start < m.end <= frames / FPS for m in found)


def test_stored_windows_give_the_same_answer_and_spare_their_encoding() -> None:
    fresh, spared = (queried(take(120, (40, 43, 3)), 3, encoder=MeanEncoder()) for _ in range(2))
    stored = SimpleNamespace(windows=lambda id: fresh.source.windows(MeanEncoder()))
    spared = replace(spared, source=replace(spared.source, library=stored, clip_id=1))
    assert list(islice(rank_moments(fresh), 2)) == list(islice(rank_moments(spared), 2))
    assert spared.encoder.encoded < fresh.encoder.encoded
