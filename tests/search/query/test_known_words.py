"""The lexicon: words are known in any form, and others are out of vocabulary."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from search.query.encoding import encode_queries
from search.query.known_words import lexicon, out_of_vocabulary_share, spelled_out

KNOWN = lexicon(
    ["a person walks forward", "walk", "someone is dancing", "he raises the left arm, then waves", "circle"]
)


@pytest.mark.parametrize(
    ("sentence", "share"),
    [
        ("a person walks", 0),
        ("The PERSON is walking forwards!", 0),  # other forms, other letters
        ("circling", 0),
        ("walks to the fridge", 1 / 2),
        ("how do I walk to my fridge, and why?", 1 / 2),  # words that say nothing of what it is about do not count
        ("tax return for the fridge", 1),
        ("eine Person geht vorwärts", 3 / 4),
        ("人が歩く", 1),
        ("1234 %&", 1),
        ("", 1),
    ],
)
def test_the_out_of_vocabulary_share(sentence: str, share: float) -> None:
    assert out_of_vocabulary_share(sentence, KNOWN) == share


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("HitReactLeft", "Hit React Left"),
        ("walk_cycle-02", "walk cycle"),
        ("Idle01", "Idle"),
        ("TPose", "T Pose"),
        ("jump360", "jump360"),  # a number that may mean something
        ("T-pose", "T-pose"),
        ("a person walks 2", "a person walks 2"),
        ("17", "17"),
        ("", ""),
    ],
)
def test_names_of_clips_are_spelled_out(name: str, words: str) -> None:
    assert spelled_out(name) == words
    assert spelled_out(words) == words


def test_a_name_is_asked_as_its_words() -> None:
    named, said = encode_queries(Bundle.load(), ["WalkForward_03", "Walk Forward"])
    np.testing.assert_array_equal(named, said)
    assert out_of_vocabulary_share("WalkForward_03", KNOWN) == 0


def test_short_words_are_not_cut_to_what_they_are_not() -> None:
    assert out_of_vocabulary_share("bus", lexicon(["bu"])) == 1


def test_words_are_sorted_and_distinct() -> None:
    assert lexicon(["waves, walks", "walks and x"]).tolist() == ["and", "walks", "waves"]


def test_without_words_everything_is_out_of_vocabulary() -> None:
    assert out_of_vocabulary_share("walks", lexicon([])) == 1
