"""Human sentences are parsed exactly or not at all."""

from __future__ import annotations

import pytest

from encoders.corpus.actions.programs import programs
from encoders.corpus.language.parsing import parse


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
        ("a person does 5 jumping jacks", "jumping jacks, 5 times"),
        ("after clapping, the man bows", "clap; then bow"),
        ("a person is lying on their stomach", "lie, forward"),
        ("a person lies down on the left side", "lie down, left"),
        ("a person gets up from the floor", "get up"),
        ("a person sits down and gets up", "sit down; then stand up"),
        ("a person trips and falls", "trip and fall"),
        ("a person turns 90 degrees to the left", "turn, left, 90 degrees"),
        ("a person makes a quarter turn to the right", "turn, right, 90 degrees"),
        ("a person does a half turn", "turn, 180 degrees"),
        ("a person spins 360 degrees", "spin dance, 1 times"),
        ("a person gets hit in the head", "hit reaction, high"),
        ("a person touches the left elbow to the right knee", "elbow to knee, right"),
        ("a person touches the left shoulder with the right hand", "touch opposite shoulder, right"),
        ("a person touches the right shoulder with the right hand", "touch shoulder, right"),
        ("a person stands on tiptoes with bent knees", "tiptoes with bent knees"),
        ("a person throws a ball twice", "throw, 2 times"),
        ("running in place", "run, in place"),
    ],
)
def test_sentences_are_parsed(sentence: str, scene: str) -> None:
    assert str(parse(sentence)) == scene


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
        "a person walks 90 degrees",
    ],
)
def test_doubtful_sentences_give_no_scene(sentence: str) -> None:
    assert parse(sentence) is None


def test_parsed_actions_have_programs() -> None:
    scene = parse("a person walks forward, claps twice and then sits down")
    assert scene is not None
    assert all(step.action in programs() for group in scene.steps for step in group)
