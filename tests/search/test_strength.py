"""Strength: calibrated per query, and honest about nothing."""

from __future__ import annotations

import numpy as np
import pytest

from search.query.known_words import lexicon
from search.ranking import strength
from tests.search.fakes import MeanEncoder


def _unit(rows: np.ndarray) -> np.ndarray:
    return rows / np.linalg.norm(rows, axis=-1, keepdims=True)


@pytest.fixture
def bundle() -> MeanEncoder:
    background = _unit(np.random.default_rng(0).normal(size=(500, 64))).astype(np.float16)
    return MeanEncoder({"motions": background, "sentence_coefficients": np.array([-4.0, 2.0, 1.0])})


def test_a_hit_far_above_the_background_is_strong_and_one_inside_it_is_weak(bundle: MeanEncoder) -> None:
    query = _unit(np.ones(64))
    assert strength.judge(bundle, query, [0.9, 0.05]) == ["strong", "weak"]


def test_a_query_near_everything_needs_a_higher_score(bundle: MeanEncoder) -> None:
    near_everything = _unit(bundle.calibration["motions"].astype(np.float64).mean(axis=0))
    away = _unit(np.ones(64))
    score = 0.25
    near, far = (strength.evidence(q, [score], bundle.calibration["motions"])[0, 1] for q in (near_everything, away))
    assert near < far


def test_a_higher_score_is_never_weaker(bundle: MeanEncoder) -> None:
    order = {"weak": 0, "plausible": 1, "strong": 2}
    judged = [order[s] for s in strength.judge(bundle, _unit(np.ones(64)), np.linspace(-1, 1, 41))]
    assert judged == sorted(judged)


def test_without_calibration_nothing_is_claimed() -> None:
    assert strength.judge(MeanEncoder(), np.ones(4), [0.5]) == [""]


@pytest.mark.parametrize(
    ("sentence", "judged"),
    [
        ("a person walks", ["strong", "plausible", "weak"]),
        ("walks to the fridge", ["plausible", "weak", "weak"]),
        ("zwei Kühlschränke", ["plausible", "weak", "weak"]),
    ],
)
def test_a_sentence_in_words_that_nobody_uses_of_motion_is_doubted(
    bundle: MeanEncoder, sentence: str, judged: list[str]
) -> None:
    said = ["strong", "plausible", "weak"]
    assert strength.downgrade(bundle, [sentence], said) == said, "a calibration without words doubts nothing"
    bundle.calibration["words"] = lexicon(["a person walks slowly"])
    assert strength.downgrade(bundle, [sentence], said) == judged
    assert strength.downgrade(bundle, ["a person walks", sentence], said) == judged, "one of several is enough"


def test_the_fit_recovers_a_known_curve() -> None:
    rng = np.random.default_rng(1)
    x = rng.normal(size=(20_000, 2))
    truth = np.array([-0.5, 1.5, 0.7])
    right = rng.random(len(x)) < strength.chance(x, truth)
    assert strength.fit(x, right, penalty=0) == pytest.approx(truth, abs=0.1)


def test_all_weak_means_nothing_matches() -> None:
    assert strength.nothing_matches(["weak", "weak"])
    assert not strength.nothing_matches(["plausible", "weak"])
    assert not strength.nothing_matches([])
