"""The lexicon: words are known in any form, and others are out of vocabulary."""

from __future__ import annotations

import pytest

from search.query.known_words import lexicon, out_of_vocabulary_share

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
        ("tax return for the fridge", 1),
        ("eine Person geht vorwärts", 3 / 4),
        ("人が歩く", 1),
        ("1234 %&", 1),
        ("", 1),
    ],
)
def test_the_out_of_vocabulary_share(sentence: str, share: float) -> None:
    assert out_of_vocabulary_share(sentence, KNOWN) == share


def test_short_words_are_not_cut_to_what_they_are_not() -> None:
    assert out_of_vocabulary_share("bus", lexicon(["bu"])) == 1


def test_words_are_sorted_and_distinct() -> None:
    assert lexicon(["waves, walks", "walks and x"]).tolist() == ["and", "walks", "waves"]


def test_without_words_everything_is_out_of_vocabulary() -> None:
    assert out_of_vocabulary_share("walks", lexicon([])) == 1
