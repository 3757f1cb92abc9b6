"""Caption augmentation: facts and paraphrases of real captions."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.caption_augmentation import augment_captions


def test_paraphrases_state_no_more_than_the_captions() -> None:
    augmented = augment_captions(["a person walks backwards slowly"], np.random.default_rng(0), count=8)
    assert augmented is not None
    assert len(set(augmented.captions)) > 4
    assert len(augmented.meanings) == 9
    assert augmented.facts == {"walk", "walk.direction=backward", "walk.speed=slow"}
    assert all("walk" in meaning and meaning <= augmented.facts for meaning in augmented.meanings)


def test_locomotion_without_a_direction_is_forward_in_the_facts_only() -> None:
    augmented = augment_captions(["a person walks"], np.random.default_rng(0))
    assert augmented is not None
    assert augmented.facts == {"walk", "walk.direction=forward"}
    assert set(augmented.meanings) == {frozenset({"walk"})}


def test_paraphrases_come_with_hard_negatives() -> None:
    augmented = augment_captions(["a person walks to the left"], np.random.default_rng(0), count=8)
    assert augmented is not None
    assert any("right" in text and "left" not in text for text in augmented.hard_negatives)


def test_the_facts_of_several_captions_are_united() -> None:
    augmented = augment_captions(["a person walks forward", "a man walks quickly"], np.random.default_rng(0))
    assert augmented is not None
    assert augmented.facts == {"walk", "walk.direction=forward", "walk.speed=fast"}


def test_a_caption_that_cannot_be_parsed_states_the_actions_of_the_others() -> None:
    augmented = augment_captions(
        ["some quite unlikely goings-on", "a person walks forward and then sits down"], np.random.default_rng(0)
    )
    assert augmented is not None
    assert augmented.meanings[0] == {"walk", "sit down"}


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
def test_a_phrase_of_manner_need_not_be_parsed(said: str, shown: set[str] | None) -> None:
    augmented = augment_captions([said], np.random.default_rng(0))
    assert (augmented and augmented.facts) == shown


def test_captions_that_cannot_be_parsed_give_nothing() -> None:
    assert augment_captions(["some quite unlikely goings-on"], np.random.default_rng(0)) is None
