"""Generated captions are true of their scene, varied, and never held-out sentences."""

from __future__ import annotations

import random
import re

import numpy as np
import pytest

from encoders.corpus.language.caption_generation import captions, describe
from encoders.corpus.language.held_out_sentences import HeldOutSentences
from encoders.corpus.language.random_scenes import random_scene
from encoders.corpus.scene import ActionStep, Scene
from tests.encoders.corpus.scenes import one


def caption_texts(scene: Scene, count: int = 300) -> list[str]:
    rng = random.Random(0)
    return [describe(scene, rng).text.lower() for _ in range(count)]


def test_captions_are_varied_and_of_the_wanted_count() -> None:
    texts = captions(one("walk", direction="backward"), random.Random(3), 40)
    assert len(texts) == 40
    assert len(set(texts)) >= 36


@pytest.mark.parametrize(("side", "other"), [("left", "right"), ("right", "left")])
def test_no_caption_names_the_wrong_side(side: str, other: str) -> None:
    for action in ("wave", "kick", "throw", "punch", "salute"):
        assert not [text for text in caption_texts(one(action, side=side)) if f"{other} " in text + " "]
    assert not [text for text in caption_texts(one("turn", direction=side)) if other in text.split()]


def test_most_but_not_all_captions_mention_a_specified_field() -> None:
    named = [bool(describe(one("wave", side="left"), random.Random(i)).scene.steps[0][0].side) for i in range(200)]
    assert 0.6 < np.mean(named) < 1.0


def test_the_scene_of_a_caption_is_part_of_the_described_one() -> None:
    rng = np.random.default_rng(4)
    for _ in range(50):
        scene = random_scene(rng)
        said = describe(scene, rng).scene
        true = [step for group in scene.steps for step in group]
        for step in (step for group in said.steps for step in group):
            assert any(
                other.action == step.action
                and all(value in (getattr(other, name), "", 0) for name, value in vars(step).items())
                for other in true
            )


def test_captions_keep_the_order_of_steps() -> None:
    scene = Scene(((ActionStep("clap"),), (ActionStep("cartwheel"),)))
    for text in caption_texts(scene):
        clap, wheel = text.find("clap"), text.find("cartwheel")
        if clap >= 0 and wheel >= 0:
            assert (clap < wheel) != bool(re.search(" after (?!that)", text)), text


def test_captions_state_no_wrong_count() -> None:
    for text in caption_texts(one("jump", count=3)):
        assert not [wrong for wrong in ("twice", "two times", "two jumps", "four", "2", "4") if wrong in text]


def test_held_out_sentences_are_never_generated() -> None:
    scene = one("clap")
    common = max(set(caption_texts(scene)), key=caption_texts(scene).count)
    held_out = HeldOutSentences([common.upper() + "!"])
    assert held_out(common)
    assert not [text for text in captions(scene, random.Random(5), 200, held_out) if held_out(text)]


def test_short_labels_are_sometimes_names_of_files() -> None:
    rng = random.Random(0)
    scene = Scene(((ActionStep("die", direction="backward"),),))
    written = {describe(scene, rng).text for _ in range(600)}
    names = [text for text in written if "_" in text]
    assert any(name.lower().startswith("death_back") for name in names)
    assert all(" " not in name and len(name.split("_")) <= 6 for name in names)


def test_counts_are_sometimes_left_vague_and_then_not_stated() -> None:
    rng = random.Random(1)
    scene = Scene(((ActionStep("wave", count=4),),))
    said = [describe(scene, rng) for _ in range(300)]
    vague = [c.scene.steps[0][0].count for c in said if re.search(r"\b(several times|repeatedly)", c.text)]
    assert len(vague) >= 5
    assert not any(vague)


def test_angles_that_a_caption_gives_are_those_of_the_turn() -> None:
    rng = random.Random(2)
    for degrees in (90, 270):
        scene = Scene(((ActionStep("turn", direction="left", degrees=degrees),),))
        given = {n for _ in range(200) for n in re.findall(r"\b(45|90|135|180|270|360)\b", describe(scene, rng).text)}
        assert given == {str(degrees)}
