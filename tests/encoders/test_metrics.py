"""Retrieval metrics: the published numbers, ties, and what cannot be asked."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders import metrics


def test_every_published_case_is_matched(golden: Path) -> None:
    cases = json.loads((golden / "retrieval_metrics_cases.json").read_text())
    arrays = np.load(golden / "retrieval_metrics_cases.npz")
    checked = 0
    for name, case in cases.items():
        if case.get("threshold") is not None or case.get("has_emb") or "metrics_unrounded" not in case:
            continue
        similarity = arrays[f"{name}/sim"]
        if np.isnan(similarity).any():
            continue
        got = metrics.text_motion(similarity)
        for way, short in (("text->motion", "t2m"), ("motion->text", "m2t")):
            for k in metrics.RECALLS:
                assert got[way][f"R@{k}"] == pytest.approx(case["metrics_unrounded"][f"{short}/R{k:02d}"]), (name, k)
            assert got[way]["MedR"] == pytest.approx(case["metrics_unrounded"][f"{short}/MedR"]), name
        checked += 1
    assert checked >= 10


def test_a_two_way_tie_at_the_top_counts_as_found_and_a_three_way_tie_does_not() -> None:
    two = metrics.ranks([[0.5, 0.5, 0.1]], [[True, False, False]])
    three = metrics.ranks([[0.5, 0.5, 0.5]], [[True, False, False]])
    assert two.tolist() == [0.5]
    assert three.tolist() == [1.0]


def test_the_best_of_several_right_items_counts() -> None:
    assert metrics.ranks([[0.9, 0.2, 0.8]], [[False, True, True]]).tolist() == [1.0]


def test_a_query_without_a_right_item_is_left_out() -> None:
    rank = metrics.ranks([[0.9, 0.2], [0.1, 0.3]], [[False, False], [False, True]])
    assert np.isnan(rank[0])
    assert metrics.recalls(rank)["R@1"] == 100.0


def test_average_precision_by_hand() -> None:
    assert metrics.average_precision([0.9, 0.8, 0.7], [True, False, True]) == pytest.approx((1 + 2 / 3) / 2)


def test_ties_do_not_flatter_average_precision() -> None:
    assert metrics.average_precision([0.5, 0.5], [True, False]) == 0.5


def test_batches_are_reproducible_and_drop_the_remainder() -> None:
    similarity = np.random.default_rng(0).normal(size=(70, 70))
    assert metrics.in_batches(similarity) == metrics.in_batches(similarity)
    with pytest.raises(ValueError, match="fewer than one batch"):
        metrics.in_batches(similarity[:10, :10])


def test_a_non_square_matrix_needs_to_be_told_what_is_right() -> None:
    with pytest.raises(ValueError, match="square"):
        metrics.ranks(np.zeros((2, 3)))
