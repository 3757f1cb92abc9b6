"""Spans: overlap, suppression, and what a moment's strength is calibrated on."""

from __future__ import annotations

import pytest

from search.spans import Moment, temporal_iou, temporal_nms


def test_temporal_iou_of_spans() -> None:
    assert temporal_iou([0, 0, 5, 20], [10, 5, 15, 30], 0, 10).tolist() == pytest.approx([1, 0.5, 1 / 3, 0])


def test_suppression_keeps_the_best_and_what_does_not_overlap_it() -> None:
    kept = temporal_nms([0, 1, 20, 21], [10, 11, 30, 31], [0.5, 0.9, 0.3, 0.2], most=0.3)
    assert list(kept) == [1, 2]


def test_a_moment_is_calibrated_on_its_highest_instant() -> None:
    assert Moment(0.0, 2.0, 0.4, 0.6).peak_score == 0.6
    assert Moment(0.0, 2.0, 0.4).peak_score == 0.4, "a window is as high as its score"
