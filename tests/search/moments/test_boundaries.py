"""Boundaries: a moment extends from its peak as far as similarity stays high."""

from __future__ import annotations

import numpy as np

from search.moments import boundaries
from search.moments.boundaries import local_maxima
from tests.search.fakes import FPS


def grow(similarity: np.ndarray, level: float, peak: int) -> tuple[int, int]:
    (start,), (end,) = boundaries.grow(similarity, level, FPS, np.array([peak]))
    return start, end


def test_a_moment_ends_where_similarity_falls_by_a_third_of_its_height() -> None:
    similarity = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)])
    start, end = grow(similarity, 0.0, 50)
    assert similarity[start] >= 0.65 > similarity[start - 1]
    assert similarity[end - 1] >= 0.65 > similarity[end]


def test_a_flat_curve_is_one_moment() -> None:
    noise = np.random.default_rng(0).normal(scale=0.01, size=60) + 0.7
    assert grow(noise, 0.69, 20 + int(noise[20:30].argmax())) == (0, 60)


def test_a_short_dip_does_not_end_a_moment_but_a_long_one_does() -> None:
    similarity = np.ones(90)
    similarity[50:52] = 0.5
    assert grow(similarity, 0.0, 30) == (0, 90)
    similarity[50:60] = 0.5
    assert grow(similarity, 0.0, 30) == (0, 50)


def test_a_moment_does_not_go_on_into_a_higher_one() -> None:
    similarity = np.full(100, 0.3)
    similarity[20:40], similarity[45:70] = 0.5, 0.8
    assert grow(similarity, 0.0, 25) == (20, 40)
    assert grow(similarity, 0.0, 50) == (45, 70)


def test_moments_longer_than_the_first_reach_and_many_of_them() -> None:
    similarity = np.zeros(30_000)
    similarity[100:20_000] = 0.8
    similarity[20_100::100] = 0.8
    peaks = local_maxima(similarity)[1:]  # without the level beginning
    starts, ends = boundaries.grow(similarity, 0.0, FPS, peaks)
    assert (starts[0], ends[0]) == (100, 20_000)
    assert len(peaks) > 90
    assert set(ends[1:] - starts[1:]) == {1}


def test_every_peak_is_a_local_maximum_and_there_is_always_one() -> None:
    assert local_maxima(np.array([0.1, 0.5, 0.2, 0.2, 0.9])).tolist() == [1, 4]
    assert local_maxima(np.array([0.3])).tolist() == local_maxima(np.zeros(5)).tolist() == [0]
