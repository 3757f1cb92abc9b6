"""Metrics of moment retrieval, by hand."""

from __future__ import annotations

import pytest

from search.evaluate.moment_metrics import Overlaps


@pytest.fixture
def overlaps() -> Overlaps:
    """Two questions: the first answered exactly, the second half right at the second try."""
    found = Overlaps()
    found.add([(0.0, 2.0), (5.0, 6.0)], [(0.0, 2.0)])
    found.add([(8.0, 9.0), (4.0, 6.0)], [(5.0, 6.0), (20.0, 30.0)])
    return found


def test_recall_counts_questions_with_a_right_answer_among_the_first(overlaps: Overlaps) -> None:
    assert overlaps.recall(1, 0.9) == 50.0
    assert overlaps.recall(2, 0.5) == 100.0
    assert overlaps.recall(2, 0.6) == 50.0


def test_the_first_answers_overlap(overlaps: Overlaps) -> None:
    assert overlaps.mean_iou() == 50.0


def test_average_precision_is_the_reciprocal_rank_of_the_first_right_answer(overlaps: Overlaps) -> None:
    assert overlaps.mean_ap() == pytest.approx(100 * (1 + 0.5 * 5 / 7) / 2)


def test_any_true_span_will_do() -> None:
    found = Overlaps()
    found.add([(20.0, 30.0)], [(5.0, 6.0), (20.0, 30.0)])
    assert found.figures()["accuracy at 0.9"] == 100.0


def test_no_answer_is_wrong() -> None:
    found = Overlaps()
    found.add([], [(0.0, 1.0)])
    assert found.mean_iou() == found.mean_ap() == found.recall(10, 0.1) == 0.0


def test_an_answer_where_nothing_is_true_is_wrong() -> None:
    found = Overlaps()
    found.add([(0.0, 1.0)], [])
    assert found.recall(10, 0.1) == 0.0
