"""Sentences that fit a motion: ranked, each once, each as strong as the motion would be as its hit."""

from __future__ import annotations

import pickle

import numpy as np

from search.ranking.description import Description, describe_motion
from tests.search.answers import KnownAnswers, motion

CALIBRATION = {
    "motions": np.eye(6, dtype=np.float16)[[4, 5]],
    "words": np.array(["one", "two"]),
    "sentence_coefficients": np.array([-2.0, 4.0, 0.0]),
}
CAPTIONS = ("one", "two", "three", "one")


def described(kind: int, calibration: dict[str, np.ndarray] | None) -> list[tuple[str, str]]:
    encoder = KnownAnswers(calibration)
    found = describe_motion(encoder, motion(kind), 2, CAPTIONS, encoder.encode_texts(CAPTIONS))
    return [(sentence.text, sentence.strength) for sentence in found]


def test_a_sentence_is_as_strong_as_the_motion_would_be_as_its_hit() -> None:
    assert described(1, CALIBRATION)[0] == ("one", "strong")
    assert described(1, CALIBRATION)[1][1] == "weak"


def test_a_sentence_of_words_that_were_not_learned_is_downgraded() -> None:
    assert described(3, CALIBRATION)[0] == ("three", "plausible")


def test_without_calibration_there_is_no_strength() -> None:
    assert [strength for _, strength in described(1, None)] == ["", ""]


def test_it_is_a_pair_that_can_be_pickled() -> None:
    text, score = one = Description("a person walks", 0.5, "plausible")
    again = pickle.loads(pickle.dumps(one))
    assert (text, score) == ("a person walks", 0.5) == again
    assert again.strength == "plausible"
