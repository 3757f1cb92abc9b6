"""Retrieval metrics: the published numbers, ties, and what cannot be asked."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders import metrics
from tests.conftest import ROOT

DATA = ROOT / "tests" / "data"


CASES = json.loads((DATA / "published_retrieval.json").read_text())


def assert_published(similarity: np.ndarray, wanted: dict[str, float]) -> None:
    got = metrics.text_motion(similarity)
    for way, short in (("text->motion", "t2m"), ("motion->text", "m2t")):
        assert [got[way][f"R@{k}"] for k in metrics.RECALLS] == pytest.approx(
            [wanted[f"{short}/R{k:02d}"] for k in metrics.RECALLS]
        )
        assert got[way]["MedR"] == pytest.approx(wanted[f"{short}/MedR"])


@pytest.mark.parametrize("name", CASES)
def test_a_published_case_is_matched(name: str) -> None:
    with np.load(DATA / "published_retrieval.npz", allow_pickle=False) as arrays:
        assert_published(arrays[name], CASES[name])


def test_every_published_case_is_matched(golden: Path) -> None:
    cases = json.loads((golden / "retrieval_metrics_cases.json").read_text())
    known = {n: case for n, case in cases.items() if "metrics_unrounded" in case and not case["has_emb"]}
    assert len(known) >= 10
    with np.load(golden / "retrieval_metrics_cases.npz", allow_pickle=False) as arrays:
        for name, case in known.items():
            assert_published(arrays[f"{name}/sim"], case["metrics_unrounded"])


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


def test_a_non_square_matrix_needs_the_right_items() -> None:
    with pytest.raises(ValueError, match="square"):
        metrics.ranks(np.zeros((2, 3)))
