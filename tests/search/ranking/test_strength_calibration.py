"""Strength calibration: right hits come out strong, and out-of-domain ones weak."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.synthetic_pairs import SyntheticClip
from encoders.corpus.scene import ActionStep, Scene
from search.query.question import EncodedQuestion
from search.ranking.strength import judge, probability
from search.ranking.strength_calibration import calibrate, fit_logistic, fit_together
from tests.search.answers import SENTENCES, KnownAnswers


def clip(kind: int, seed: int) -> SyntheticClip:
    """Mostly of its kind, with something of all others."""
    rows = np.random.default_rng(seed).uniform(0, 0.5, size=(10, len(SENTENCES))).astype(np.float32)
    rows[:, kind] += 1
    action = f"kind{kind}"
    return SyntheticClip(
        rows, Scene(((ActionStep(action),),)), ((0.0, 1.0),), (SENTENCES[kind],), (frozenset({action}),), ()
    )


@pytest.fixture
def calibration() -> dict[str, np.ndarray]:
    clips = [clip(i % 5, i) for i in range(60)]
    return calibrate(KnownAnswers(), clips[:20], clips[20:], ["a person", "lorem ipsum"])


def test_it_holds_what_judging_needs(calibration: dict[str, np.ndarray]) -> None:
    assert calibration["motions"].shape == (20, len(SENTENCES))
    assert calibration["motions"].dtype == np.float16
    assert set(SENTENCES[:5]) <= set(calibration["words"].tolist())
    assert calibration["words"].tolist() == sorted(set(calibration["words"].tolist()))
    for asked in ("sentence", "motion"):
        assert calibration[f"{asked}_coefficients"].shape == (3,)
        assert np.isfinite(calibration[f"{asked}_coefficients"]).all()


def test_right_hits_are_strong_and_out_of_domain_ones_weak(calibration: dict[str, np.ndarray]) -> None:
    bundle = KnownAnswers(calibration)
    right = bundle.encode_features([clip(1, 99).features])[0]
    one, nothing = bundle.encode_texts(["one", "nothing"])
    assert judge(bundle, EncodedQuestion(one[None]), [[float(one @ right)]]) == ["strong"]
    assert judge(bundle, EncodedQuestion(nothing[None]), [[float(nothing @ right)]]) == ["weak"]


def test_hits_of_a_sentence_out_of_vocabulary_are_downgraded(calibration: dict[str, np.ndarray]) -> None:
    bundle = KnownAnswers(calibration)
    right = bundle.encode_features([clip(1, 99).features])[0]
    (one,) = bundle.encode_texts(["one"])
    for sentence, strength in (("one", "strong"), ("lorem ipsum", "plausible")):
        assert judge(bundle, EncodedQuestion(one[None], (sentence,)), [[float(one @ right)]]) == [strength]


def test_a_motion_is_judged_by_other_motions_never_by_itself(calibration: dict[str, np.ndarray]) -> None:
    bundle = KnownAnswers(calibration)
    motion, alike, other = bundle.encode_features([clip(1, 99).features, clip(1, 98).features, clip(2, 97).features])
    scores = [[float(motion @ alike)], [float(motion @ other)]]
    assert judge(bundle, EncodedQuestion(motion[None], kind="motion"), scores) == ["strong", "weak"]


def test_the_fit_recovers_a_known_curve() -> None:
    rng = np.random.default_rng(1)
    x = rng.normal(size=(20_000, 2))
    truth = np.array([-0.5, 1.5, 0.7])
    right = rng.random(len(x)) < probability(x, truth)
    assert fit_logistic(x, right, penalty=0) == pytest.approx(truth, abs=0.1)


def test_a_hit_that_is_higher_is_never_weaker() -> None:
    rng = np.random.default_rng(2)
    x = rng.normal(size=(4000, 2))
    right = rng.random(len(x)) < probability(x, np.array([0.0, 2.0, -1.0]))
    _, rising, falling = fit_logistic(x, right)
    assert rising > 1
    assert falling == 0


def test_a_large_archive_does_not_decide_alone() -> None:
    rng = np.random.default_rng(3)
    large, small = rng.normal(size=(9000, 2)), rng.normal(size=(90, 2))
    often, seldom = (large, rng.random(9000) < 0.9), (small, rng.random(90) < 0.1)
    at_zero = probability(np.zeros((1, 2)), fit_together([often, seldom]))[0]
    assert 0.75 < at_zero < 0.85  # by the root of the hits, 30 to 3; by the hits it would be 0.89


def test_real_hits_decide_alone_where_there_are_some(calibration: dict[str, np.ndarray]) -> None:
    clips, rng = [clip(i % 5, i) for i in range(60)], np.random.default_rng(4)
    real = rng.normal(size=(400, 2)), rng.random(400) < 0.5
    seen = []
    again = calibrate(
        KnownAnswers(), clips[:20], clips[20:], [], lambda unrelated: [seen.append(unrelated) or real][:1]
    )
    np.testing.assert_array_equal(seen[0], calibration["motions"])
    np.testing.assert_array_equal(again["sentence_coefficients"], fit_together([real]))
    np.testing.assert_array_equal(again["motion_coefficients"], calibration["motion_coefficients"])
