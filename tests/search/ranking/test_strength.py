"""Strength: calibrated per query, and honest about nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from search.query.known_words import lexicon
from search.query.question import EncodedQuestion
from search.ranking import strength
from tests.search.fakes import MeanEncoder


def _unit(rows: np.ndarray) -> np.ndarray:
    return rows / np.linalg.norm(rows, axis=-1, keepdims=True)


def judge(bundle: MeanEncoder, query: np.ndarray, scores: Any, *sentences: str) -> list[str]:
    return strength.judge(
        bundle, EncodedQuestion(query[None].astype(np.float32), sentences), np.reshape(scores, (-1, 1))
    )


@pytest.fixture
def bundle() -> MeanEncoder:
    background = _unit(np.random.default_rng(0).normal(size=(500, 64))).astype(np.float16)
    return MeanEncoder({"motions": background, "sentence_coefficients": np.array([-4.0, 2.0, 1.0])})


def test_a_hit_far_above_the_background_is_strong_and_one_inside_it_is_weak(bundle: MeanEncoder) -> None:
    query = _unit(np.ones(64))
    assert judge(bundle, query, [0.9, 0.05]) == ["strong", "weak"]


def test_a_query_near_everything_needs_a_higher_score(bundle: MeanEncoder) -> None:
    near_everything = _unit(bundle.calibration["motions"].astype(np.float64).mean(axis=0))
    away = _unit(np.ones(64))
    score = 0.25
    near, far = (
        strength.score_statistics(score, strength.background_level(bundle.calibration["motions"] @ q))[1]
        for q in (near_everything, away)
    )
    assert near < far


def test_a_higher_score_is_never_weaker(bundle: MeanEncoder) -> None:
    order = {"weak": 0, "plausible": 1, "strong": 2}
    judged = [order[s] for s in judge(bundle, _unit(np.ones(64)), np.linspace(-1, 1, 41))]
    assert judged == sorted(judged)


def test_without_calibration_nothing_is_claimed() -> None:
    assert judge(MeanEncoder(), np.ones(4), [0.5]) == [""]


@pytest.mark.parametrize("missing", ["motions", "sentence_coefficients"])
def test_without_a_part_of_the_calibration_nothing_is_claimed(bundle: MeanEncoder, missing: str) -> None:
    assert bundle.calibration is not None
    partial = {name: values for name, values in bundle.calibration.items() if name != missing}
    assert judge(MeanEncoder(partial), _unit(np.ones(64)), [0.9, 0.1]) == ["", ""]


@pytest.mark.parametrize(
    ("sentence", "judged"),
    [
        ("a person walks", ["strong", "plausible", "weak"]),
        ("a person walks slowly, slowly to the fridge", ["strong", "plausible", "weak"]),  # one in five
        ("a person walks to the fridge", ["plausible", "weak", "weak"]),
        ("zwei Kühlschränke", ["plausible", "weak", "weak"]),
    ],
)
def test_hits_of_a_sentence_a_third_of_which_is_out_of_vocabulary_are_downgraded(
    bundle: MeanEncoder, sentence: str, judged: list[str]
) -> None:
    query, scores = _unit(np.ones(64)), [0.9, 0.45, 0.05]
    assert judge(bundle, query, scores, sentence) == ["strong", "plausible", "weak"], "no words, no downgrade"
    bundle.calibration["words"] = lexicon(["a person walks slowly"])
    assert judge(bundle, query, scores, sentence) == judged
    assert judge(bundle, query, scores, "a person walks", sentence) == judged, "one of several is enough"
    assert judge(bundle, query, scores) == ["strong", "plausible", "weak"], "a vector has no words"
