"""Windows compared with queries: bounded memory, whole coverage, curves."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.bundle.windows import window_starts
from search.moments.window_scores import WindowScores, score_windows, similarity_at
from tests.search.fakes import MeanEncoder, queried, query, take


def test_memory_is_bounded() -> None:
    encoder = MeanEncoder()
    score_windows(encoder, take(7200), window_starts(72_000, 16), 16, query(0))
    assert encoder.most_at_once <= 4096


def test_the_curve_interpolates_between_the_centres_of_windows() -> None:
    windows = WindowScores(np.array([0.0, 1.0]), np.array([2.0, 3.0]), np.array([[0.0, 1.0]], np.float32))
    assert similarity_at(windows, np.array([0.0, 1.0, 1.5, 2.0, 9.0]))[0].tolist() == pytest.approx([0, 0, 0.5, 1, 1])


def test_similarity_over_time_has_a_value_for_every_frame_and_stands_high_where_it_happens() -> None:
    curve = queried(take(20, (8, 12, 3)), 3, 5).similarity
    assert curve.shape == (2, 200)
    assert curve[0, 90:110].min() > curve[0, :60].max()


@pytest.mark.parametrize("frames", [1, 3, 15, 30])
def test_similarity_over_time_of_a_short_motion(frames: int) -> None:
    assert queried(take(5)[:frames], 0).similarity.shape == (1, frames)
