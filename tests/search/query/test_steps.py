"""Steps: sentences divide at words of order."""

from __future__ import annotations

import pytest

from search.query.steps import split


@pytest.mark.parametrize(
    ("sentence", "steps"),
    [
        ("walks forward, then sits down, then waves", ["walks forward", "sits down", "waves"]),
        ("A person walks then sits down and then waves", ["A person walks", "A person sits down", "A person waves"]),
        ("a man walks, turns around, then sits", ["a man walks", "a man turns around", "a man sits"]),
        ("after running, he jumps", ["he is running", "he jumps"]),
        ("jumps before sitting down", ["jumps", "sitting down"]),
        ("walks, followed by a jump", ["walks", "a jump"]),
        ("stretches; bows; finally jumps", ["stretches", "bows", "jumps"]),
        ("the woman is walking. Then she stops.", ["the woman is walking", "she stops"]),
        ("walks slowly, carefully", ["walks slowly, carefully"]),
        ("walks slowly, as on ice, then sits", ["walks slowly, as on ice", "sits"]),
        ("walks, arms stretched out, steps aside, then sits", ["walks, arms stretched out", "steps aside", "sits"]),
        ("a person waves", ["a person waves"]),
        ("walks and then", ["walks"]),
    ],
)
def test_sentences_divide_at_words_of_order(sentence: str, steps: list[str]) -> None:
    assert split(sentence) == steps
