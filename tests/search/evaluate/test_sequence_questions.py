"""Overlap of steps in order, by hand."""

from __future__ import annotations

from search.evaluate.sequence_questions import sequence_overlap


def test_a_sequence_is_as_good_as_its_worst_step() -> None:
    truths = [[(0.0, 2.0)], [(2.0, 4.0)], [(4.0, 6.0)]]
    assert sequence_overlap([(0.0, 2.0), (2.0, 4.0), (4.0, 6.0)], truths) == 1.0
    assert sequence_overlap([(0.0, 2.0), (2.0, 3.0), (4.0, 6.0)], truths) == 0.5


def test_a_sequence_over_a_repeated_action_is_right_too_if_it_is_in_order() -> None:
    walk, sit = [(0.0, 2.0), (8.0, 10.0)], [(4.0, 6.0)]
    assert sequence_overlap([(0.0, 2.0), (4.0, 6.0), (8.0, 10.0)], [walk, sit, walk]) == 1.0
    assert sequence_overlap([(8.0, 10.0), (4.0, 6.0)], [walk, sit]) == 0.0
