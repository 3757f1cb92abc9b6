"""Which amounts a sentence asks for."""

from __future__ import annotations

import pytest

from search.query.amounts import Amounts, amounts_of


@pytest.mark.parametrize(
    ("sentence", "amounts"),
    [
        ("jumps three times", Amounts(times=3)),
        ("claps twice", Amounts(times=2)),
        ("does 4 squats", Amounts(times=4)),
        ("turns 90 degrees to the left", Amounts(degrees=90, side=1)),
        ("turns clockwise by 270°", Amounts(degrees=270, side=-1)),
        ("turns counterclockwise by 45 degrees", Amounts(degrees=45, side=1)),
        ("makes a half turn", Amounts(degrees=180)),
        ("a quarter turn to the right", Amounts(degrees=90, side=-1)),
        ("turns a full circle", Amounts(degrees=360)),
        ("spins twice", Amounts(degrees=720)),
        ("walks forward", Amounts()),
        ("bends the knees 90 degrees", Amounts()),
        ("waves with two hands", Amounts()),
    ],
)
def test_counts_and_angles_of_turns_are_read_from_words(sentence: str, amounts: Amounts) -> None:
    assert amounts_of(sentence) == amounts
    assert bool(amounts_of(sentence)) == (amounts != Amounts())
