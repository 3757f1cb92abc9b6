"""The four protocols give the published figures, and each footing what can be worked out by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.metrics import RECALLS, ranks, recalls
from search.evaluate.retrieval.protocols import (
    ALL,
    BATCHES,
    CREDIT,
    DISSIMILAR,
    SIMILAR,
    STRICT,
    THRESHOLDED,
    evaluate_protocols,
)
from tests.conftest import ROOT

DATA = ROOT / "tests" / "data"
#: Protocol and footing -> the name that the published code gives it.
PUBLISHED = {
    (ALL, STRICT): "normal",
    (THRESHOLDED, SIMILAR): "threshold_0.95",
    (DISSIMILAR, STRICT): "nsim",
    (BATCHES, STRICT): "guo",
}


def test_the_published_run_has_the_published_figures() -> None:
    wanted = json.loads((DATA / "published_protocols.json").read_text())
    with np.load(DATA / "published_protocols.npz", allow_pickle=False) as arrays:
        rows = evaluate_protocols(
            arrays["similarity"],
            wanted["captions"],
            sentence_similarity=arrays["similar"].astype(float),
            subset=arrays["subset"],
            batched=np.argsort(arrays["keys"], kind="stable").tolist(),
        )
        found = {(row.protocol, row.footing): row for row in rows}
    assert len(found) == 7
    for place, name in PUBLISHED.items():
        published, row = wanted["metrics"][name], found[place]
        assert row.gallery == published["t2m/len"]
        for way, short in (("text->motion", "t2m"), ("motion->text", "m2t")):
            figures = [round(row.figures[way][f"R@{k}"], 2) for k in RECALLS]
            assert figures == [published[f"{short}/R{k:02d}"] for k in RECALLS], (name, way)
            assert round(row.figures[way]["MedR"], 2) == published[f"{short}/MedR"]


def test_every_published_case_with_a_threshold_is_matched(golden: Path) -> None:
    cases = json.loads((golden / "retrieval_metrics_cases.json").read_text())
    known = {n: case for n, case in cases.items() if "metrics_unrounded" in case and case["threshold"]}
    assert len(known) >= 5
    with np.load(golden / "retrieval_metrics_cases.npz", allow_pickle=False) as arrays:
        for name, case in known.items():
            sentences, similarity = arrays[f"{name}/emb"], arrays[f"{name}/sim"]
            right = sentences @ sentences.T > 2 * case["threshold"] - 1
            for short, side in (("t2m", similarity), ("m2t", similarity.T)):
                rank = ranks(side, right)
                np.testing.assert_array_equal(rank, arrays[f"{name}/{short}_cols"])
                figures = recalls(rank)
                wanted = case["metrics_unrounded"]
                assert [figures[f"R@{k}"] for k in RECALLS] == pytest.approx(
                    [wanted[f"{short}/R{k:02d}"] for k in RECALLS]
                )


def test_the_footings_by_hand() -> None:
    captions = ["walks", "walks", "walks", "jumps"]
    texts = np.array([[0.1, 0.9, 0.2, 0.5], [0.8, 0.7, 0.3, 0.6]])
    similarity = texts[[0, 0, 0, 1]]  # the same caption, the same row
    rows = {row.footing: row.figures for row in evaluate_protocols(similarity, captions)}
    assert list(rows) == [STRICT, CREDIT], "without sentence similarity, a subset, or 32 items, only the gallery"
    # Text to motion: three captions find motions 0, 1, 2 on places 3, 0, 2; with credit each finds motion 1 first.
    assert rows[STRICT]["text->motion"]["R@1"] == 25.0
    assert rows[CREDIT]["text->motion"]["R@1"] == 75.0
    assert rows[STRICT]["text->motion"]["MedR"] == 3.0
    # Motion to text: for motion 1 "walks" is at the top three times: rank 1 where one of them counts, 0 where all do.
    assert [rows[STRICT]["motion->text"][f"R@{k}"] for k in (1, 2, 3)] == [25.0, 50.0, 100.0]
    assert [rows[CREDIT]["motion->text"][f"R@{k}"] for k in (1, 2, 3)] == [50.0, 100.0, 100.0]


def test_a_tie_with_a_wrong_item_costs_places_on_both_footings() -> None:
    right = np.array([[True, True, False, False]])
    assert ranks([[0.5, 0.5, 0.5, 0.1]], right).tolist() == [1.0]
    assert ranks([[0.5, 0.5, 0.5, 0.1]], right, right_ties=False).tolist() == [0.5]
