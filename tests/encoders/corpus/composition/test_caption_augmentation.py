"""What people said of real clips, as facts and in other words."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.caption_augmentation import augment_captions


def test_it_is_told_in_other_words_that_state_no_more_than_was_said() -> None:
    told = augment_captions(["a person walks backwards slowly"], np.random.default_rng(0), count=8)
    assert told is not None
    assert len(set(told.captions)) > 4
    assert len(told.meanings) == 9
    assert told.facts == {"walk", "walk.direction=backward", "walk.speed=slow"}
    assert all("walk" in meaning and meaning <= told.facts for meaning in told.meanings)


def test_who_goes_without_a_word_of_direction_goes_ahead_but_no_sentence_says_so() -> None:
    told = augment_captions(["a person walks"], np.random.default_rng(0))
    assert told is not None
    assert told.facts == {"walk", "walk.direction=forward"}
    assert set(told.meanings) == {frozenset({"walk"})}


def test_what_looks_alike_but_is_false_comes_with_it() -> None:
    told = augment_captions(["a person walks to the left"], np.random.default_rng(0), count=8)
    assert told is not None
    assert any("right" in text and "left" not in text for text in told.hard_negatives)


def test_what_several_people_said_is_all_known_to_be_shown() -> None:
    told = augment_captions(["a person walks forward", "a man walks quickly"], np.random.default_rng(0))
    assert told is not None
    assert told.facts == {"walk", "walk.direction=forward", "walk.speed=fast"}


def test_a_sentence_not_understood_states_the_actions_that_others_name() -> None:
    told = augment_captions(
        ["some quite unlikely goings-on", "a person walks forward and then sits down"], np.random.default_rng(0)
    )
    assert told is not None
    assert told.meanings[0] == {"walk", "sit down"}


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        ("a man jogs forward in a relaxed fashion", {"jog", "run", "jog.direction=forward", "run.direction=forward"}),
        ("walk/stroll", {"walk", "walk.direction=forward"}),
        ("a man walks with his left arm raised", None),
        ("a man walks in a large circle", {"walk", "walk.direction=around"}),
        ("run/jog, veer left", None),
    ],
)
def test_a_mere_manner_need_not_be_understood(said: str, shown: set[str] | None) -> None:
    told = augment_captions([said], np.random.default_rng(0))
    assert (told and told.facts) == shown


def test_of_what_nobody_understands_nothing_is_told() -> None:
    assert augment_captions(["some quite unlikely goings-on"], np.random.default_rng(0)) is None
