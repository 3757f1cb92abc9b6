"""Boundaries: the spans that add up to most, in order."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from search.moments.boundaries import best_spans, frame_curve, grow
from tests.search.fakes import FPS, MeanEncoder, query, take


def _brute(rows: np.ndarray) -> float:
    count, frames = rows.shape
    cuts = itertools.combinations_with_replacement(range(frames + 1), 2 * count)
    spans = (list(zip(cut[::2], cut[1::2], strict=True)) for cut in cuts)
    return max(
        sum(row[a:b].sum() for row, (a, b) in zip(rows, chain, strict=True))
        for chain in spans
        if all(a < b for a, b in chain)
    )


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_the_spans_add_up_to_most_of_all_in_order(count: int, seed: int) -> None:
    rows = np.random.default_rng(seed).normal(size=(count, 8))
    found = best_spans(list(rows))
    assert sum(row[a:b].sum() for row, (a, b) in zip(rows, found, strict=True)) == pytest.approx(_brute(rows))
    assert all(0 <= a < b <= 8 for a, b in found)
    assert all(before[1] <= after[0] for before, after in itertools.pairwise(found))


def test_spans_have_a_least_length_where_there_is_room() -> None:
    gain = -np.ones((2, 20))
    assert all(b - a == 5 for a, b in best_spans(list(gain), 5))
    assert all(b - a == 10 for a, b in best_spans(list(gain), 50))


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


def test_the_curve_has_a_value_for_every_frame_and_stands_high_where_it_happens() -> None:
    curve = frame_curve(MeanEncoder(), take(20, (8, 12, 3)), FPS, query(3, 5))
    assert curve.shape == (2, 200)
    assert curve[0, 85:115].min() > curve[0, :60].max()


@pytest.mark.parametrize("frames", [1, 3, 15, 30])
def test_the_curve_of_a_short_motion(frames: int) -> None:
    assert frame_curve(MeanEncoder(), take(5)[:frames], FPS, query(0)).shape == (1, frames)


def test_a_moment_does_not_go_on_into_a_higher_one() -> None:
    similarity = np.full(100, 0.3)
    similarity[20:40], similarity[45:70] = 0.5, 0.8
    assert grow(similarity, 0.0, FPS, 25, 35) == (20, 40)
    assert grow(similarity, 0.0, FPS, 50, 60) == (45, 70)
