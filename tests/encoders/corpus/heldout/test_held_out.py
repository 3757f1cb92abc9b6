"""Held-out actions and styles: never sampled or parsed, but synthesised for evaluation."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.actions.programs import held_out_programs, program_of, programs
from encoders.corpus.composition.long_takes import heldout_take
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.style import STYLES
from encoders.corpus.heldout.heldout_styles import HELD_OUT_STYLES
from encoders.corpus.heldout.queries import ACTION_QUERIES, STYLE_PHRASES
from encoders.corpus.language.lexicon import entries
from encoders.corpus.language.parsing import parse
from encoders.corpus.language.random_scenes import random_scene
from encoders.corpus.scene import ActionStep, Scene

HELD_OUT = sorted(held_out_programs())


def test_held_out_programs_are_disjoint_from_the_training_ones() -> None:
    assert len(HELD_OUT) >= 12
    assert set(HELD_OUT) == set(ACTION_QUERIES)
    assert not set(HELD_OUT) & set(programs())
    assert all(program_of(name).held_out for name in HELD_OUT)
    assert not set(HELD_OUT) & {entry.replace("_", " ") for entry in entries()}


def test_no_random_scene_shows_a_held_out_action_or_style() -> None:
    rng = np.random.default_rng(0)
    steps = [step for _ in range(300) for group in random_scene(rng).steps for step in group]
    assert not {step.action for step in steps} & set(HELD_OUT)
    assert not {step.style for step in steps} & set(HELD_OUT_STYLES)


def test_no_query_is_parsed_to_a_held_out_action() -> None:
    scenes = [parse(sentence) for said in ACTION_QUERIES.values() for sentence in said]
    steps = [step for scene in scenes if scene for group in scene.steps for step in group]
    assert not {step.action for step in steps} & set(HELD_OUT)


def test_held_out_styles_are_disjoint_from_the_training_ones() -> None:
    assert set(HELD_OUT_STYLES) == set(STYLE_PHRASES)
    assert not set(HELD_OUT_STYLES) & set(STYLES)


@pytest.mark.parametrize("action", HELD_OUT)
def test_held_out_actions_give_plausible_motion(action: str) -> None:
    for seed in range(3):
        clip = make_clip(Scene(((ActionStep(action),),)), np.random.default_rng(seed))
        speed = 20 * np.linalg.norm(np.diff(clip.joints, axis=0), axis=-1)
        assert 2.0 < len(clip.joints) / clip.fps < 25.0
        assert np.isfinite(clip.joints).all()
        assert clip.joints[..., 1].min() > -0.2
        assert speed.max() < 20.0


def test_a_held_out_take_mixes_held_out_actions_with_known_ones_in_held_out_styles() -> None:
    taken = heldout_take(np.random.default_rng(0), least=60.0, most=60.0)
    assert {annotation.held_out for annotation in taken.annotations} == {True, False}
    styles = {fact.split("=")[1] for h in taken.events for fact in h.facts if ".style=" in fact}
    assert styles
    assert styles <= set(HELD_OUT_STYLES)
    for annotation in taken.annotations:
        assert list(annotation.spans) == taken.spans(annotation.meaning)
        assert annotation.spans
