"""Boundaries: a moment extends from its peak as far as similarity stays high."""

from __future__ import annotations

import numpy as np

from search.moments.boundaries import grow
from tests.search.fakes import FPS


def test_a_moment_ends_where_similarity_falls_by_a_third_of_its_height() -> None:
    similarity = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)])
    start, end = grow(similarity, 0.0, FPS, 45, 55)
    assert similarity[start] >= 0.65 > similarity[start - 1]
    assert similarity[end - 1] >= 0.65 > similarity[end]


def test_a_flat_curve_is_one_moment() -> None:
    noise = np.random.default_rng(0).normal(scale=0.01, size=60) + 0.7
    assert grow(noise, 0.69, FPS, 20, 30) == (0, 60)


def test_a_short_dip_does_not_end_a_moment_but_a_long_one_does() -> None:
    similarity = np.ones(90)
    similarity[50:52] = 0.5
    assert grow(similarity, 0.0, FPS, 30, 40) == (0, 90)
    similarity[50:60] = 0.5
    assert grow(similarity, 0.0, FPS, 30, 40) == (0, 50)


def test_a_moment_does_not_go_on_into_a_higher_one() -> None:
    similarity = np.full(100, 0.3)
    similarity[20:40], similarity[45:70] = 0.5, 0.8
    assert grow(similarity, 0.0, FPS, 25, 35) == (20, 40)
    assert grow(similarity, 0.0, FPS, 50, 60) == (45, 70)
