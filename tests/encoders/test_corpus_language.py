"""The language of the corpus: captions are true and varied, sentences are read surely, hard negatives are false."""

from __future__ import annotations

import random
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.actions.programs import programs
from encoders.corpus.language.caption_generation import captions, describe
from encoders.corpus.language.clause import choose_phrase, fill
from encoders.corpus.language.coverage import coverage, phrase_counts
from encoders.corpus.language.hard_negatives import contrasting_scenes
from encoders.corpus.language.held_out_sentences import HeldOutSentences
from encoders.corpus.language.lexicon import entries, entry_of
from encoders.corpus.language.parsing import parse
from encoders.corpus.language.random_scenes import random_scene
from encoders.corpus.language.subjects import Subject
from encoders.corpus.scene import ActionStep, Scene
from encoders.english import gerund, past, third_person
from search.query.paraphrases import paraphrases

COMMON = "walk run wave bow sit_down punch kick throw clap point guide turn jump".split()


def one(action: str, **fields: object) -> Scene:
    return Scene(((ActionStep(action, **fields),),))  # type: ignore[arg-type]


def many(scene: Scene, count: int = 300) -> list[str]:
    rng = random.Random(0)
    return [describe(scene, rng).text.lower() for _ in range(count)]


def test_every_program_has_phrases() -> None:
    assert [name for name in programs() if entry_of(name) is None] == []


def test_phrases_are_many_for_common_actions_and_enough_for_all() -> None:
    counts = phrase_counts()
    assert {name: counts[name] for name in COMMON if counts[name] < 60} == {}
    assert {name: count for name, count in counts.items() if count < 10} == {}


def test_every_phrase_can_be_said_of_every_legal_step() -> None:
    rng = random.Random(1)
    person = Subject("a person", "they")
    for name, program in programs().items():
        for side in ("", *program.sides):
            for direction in ("", *program.directions):
                step = ActionStep(name, side=side, direction=direction)
                phrase = choose_phrase(step, "verbs", rng)
                assert phrase is not None, step
                assert "{" not in fill(phrase.text, step, person, rng)


def test_phrases_use_no_unknown_slot() -> None:
    rng = random.Random(2)
    person = Subject("a person", "they")
    for entry in entries().values():
        for kind in ("verbs", "nouns", "parts", "as_if"):
            for phrase in entry.phrases(kind):
                step = ActionStep(entry.action, side="left", direction="left", count=2)
                assert "{" not in fill(phrase.text, step, person, rng)


def test_captions_are_varied_and_as_many_as_asked_for() -> None:
    texts = captions(one("walk", direction="backward"), random.Random(3), 40)
    assert len(texts) == 40
    assert len(set(texts)) >= 36


@pytest.mark.parametrize(("side", "other"), [("left", "right"), ("right", "left")])
def test_no_caption_names_the_wrong_side(side: str, other: str) -> None:
    for action in ("wave", "kick", "throw", "punch", "salute"):
        assert not [text for text in many(one(action, side=side)) if f"{other} " in text + " "]
    assert not [text for text in many(one("turn", direction=side)) if other in text.split()]


def test_most_but_not_all_captions_name_a_field_that_is_set() -> None:
    named = [bool(describe(one("wave", side="left"), random.Random(i)).scene.steps[0][0].side) for i in range(200)]
    assert 0.6 < np.mean(named) < 1.0


def test_what_a_caption_says_is_part_of_the_scene() -> None:
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
    for text in many(scene):
        clap, wheel = text.find("clap"), text.find("cartwheel")
        if clap >= 0 and wheel >= 0:
            assert (clap < wheel) != bool(re.search(" after (?!that)", text)), text


def test_captions_say_the_right_count() -> None:
    for text in many(one("jump", count=3)):
        assert not [wrong for wrong in ("twice", "two times", "two jumps", "four", "2", "4") if wrong in text]


def test_a_held_out_sentence_is_never_written() -> None:
    scene = one("clap")
    common = max(set(many(scene)), key=many(scene).count)
    held_out = HeldOutSentences([common.upper() + "!"])
    assert held_out(common)
    assert not [text for text in captions(scene, random.Random(5), 200, held_out) if held_out(text)]


def test_random_scenes_are_legal_and_chain_postures() -> None:
    rng = np.random.default_rng(6)
    known = programs()
    for _ in range(100):
        scene = random_scene(rng)
        assert 1 <= len(scene.steps) <= 4
        firsts = [known[group[0].action] for group in scene.steps]
        assert all(before.ends == after.starts for before, after in pairwise(firsts))
        for group in scene.steps:
            for step in group:
                program = known[step.action]
                assert step.side in ("", *program.sides)
                assert step.direction in ("", *program.directions)


@pytest.mark.parametrize(
    ("sentence", "scene"),
    [
        ("a person walks forward then turns around and walks back.", "walk, forward; then turn, around; then walk"),
        ("A man waves with his left hand", "wave, left"),
        ("the person is jumping up and down", "jump, in place"),
        ("someone walks in a counter-clockwise circle", "walk, counterclockwise"),
        ("a person slowly walks to the right while waving", "walk, right, slow while wave"),
        ("person bends down and picks something up with both hands", "pick up, both, low"),
        ("a person sits down, then stands up", "sit down; then stand up"),
        ("she raises her right arm and waves", "wave, right"),
        ("a person does 5 jumping jacks", None),
        ("after clapping, the man bows", "clap; then bow"),
        ("a person throws a ball twice", "throw, 2 times"),
        ("running in place", "run, in place"),
    ],
)
def test_sentences_are_read(sentence: str, scene: str | None) -> None:
    read = parse(sentence)
    if scene is not None:
        assert str(read) == scene


@pytest.mark.parametrize(
    "sentence",
    [
        "",
        "invoice for March",
        "a person walks without moving their arms",
        "a person frobnicates the left widget",
        "a person walks like nothing on earth while whistling",
        "une personne marche",
        "a person almost falls",
    ],
)
def test_what_is_not_understood_gives_no_scene(sentence: str) -> None:
    assert parse(sentence) is None


def test_what_is_read_can_be_acted_out() -> None:
    scene = parse("a person walks forward, claps twice and then sits down")
    assert scene is not None
    assert all(step.action in programs() for group in scene.steps for step in group)


def test_our_own_plain_captions_are_mostly_read() -> None:
    rng = np.random.default_rng(7)
    found = coverage(captions(one("walk", direction="forward"), rng, 60))
    assert found.verbs_known > 0.5


def test_swaps_differ_in_one_thing_and_stay_legal() -> None:
    scene = Scene(((ActionStep("wave", side="left", count=3),), (ActionStep("turn", direction="right"),)))
    found = {str(other) for other in contrasting_scenes(scene)}
    assert "turn, right; then wave, left, 3 times" in found
    assert "wave, right, 3 times; then turn, right" in found
    assert "wave, left, 3 times; then turn, left" in found
    assert "wave, left, 4 times; then turn, right" in found
    assert str(scene) not in found
    assert contrasting_scenes(one("clap")) == []


def test_verb_forms() -> None:
    assert [gerund(verb) for verb in ("run", "wave", "lie", "tiptoe", "hop", "kick")] == [
        "running", "waving", "lying", "tiptoeing", "hopping", "kicking",
    ]  # fmt: skip
    assert [past(verb) for verb in ("run", "clap", "carry", "bow")] == ["ran", "clapped", "carried", "bowed"]
    assert [third_person(verb) for verb in ("go", "crouch", "carry")] == ["goes", "crouches", "carries"]


def test_a_query_comes_first_among_its_wordings() -> None:
    words = paraphrases("A person walks backwards.")
    assert words[0] == "A person walks backwards."
    assert "walking backwards" in words
    assert len(words) == 3
    assert "a person turns right" in paraphrases("turn right")


@pytest.mark.parametrize("query", ["", "   ", "Rechnung für März", "歩く", "0x3f", "a " * 500])
def test_any_query_can_be_worded(query: str) -> None:
    assert paraphrases(query)[0] == query


@pytest.mark.slow
def test_human_sentences_are_covered(shared: Path) -> None:
    lines = (shared / "data/texts/sentences_humanml3d.txt").read_text(encoding="utf-8").splitlines()
    found = coverage(random.Random(0).sample(lines, 1500))
    assert found.verbs_known > 0.78
    assert found.read > 0.25
