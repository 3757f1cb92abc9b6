"""Synthetic training pairs: deterministic, true, and without held-out sentences."""

from __future__ import annotations

import re

import numpy as np
import pytest

from encoders.corpus.actions.programs import programs
from encoders.corpus.composition import synthetic_pairs
from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.synthetic_pairs import (
    SyntheticClip,
    caption_and_hard_negative,
    complete_scene,
    relevance,
    synthetic_clips,
)
from encoders.corpus.language.held_out_sentences import HeldOutSentences
from encoders.corpus.language.parsing import parse
from encoders.corpus.scene import ActionStep, Scene, SceneClip
from encoders.features.registry import FEATURE_KINDS, FeatureKind

BODY = FEATURE_KINDS["body"]
SENTENCES = ("a person walks forward and sits down", "someone waves with the left hand")


@pytest.fixture
def without_motion(monkeypatch: pytest.MonkeyPatch) -> FeatureKind:
    """A feature kind for captions without motion, which are fast to generate in numbers."""
    still = np.zeros((20, 22, 3), np.float32)
    monkeypatch.setattr(synthetic_pairs, "make_clip", lambda scene, rng: SceneClip(still, scene=scene))
    return FeatureKind("none", 1, 10.0, lambda motion: np.zeros((len(motion), 1), np.float32))


def test_the_same_seed_makes_the_same_clips() -> None:
    first, again = (list(synthetic_clips(7, 2, BODY, sentences=SENTENCES)) for _ in range(2))
    other = next(synthetic_clips(8, 1, BODY, sentences=SENTENCES))
    for a, b in zip(first, again, strict=True):
        assert np.array_equal(a.features, b.features)
        assert (a.captions, a.hard_negatives, a.spans) == (b.captions, b.hard_negatives, b.spans)
    assert other.captions != first[0].captions


def test_gait_share_gives_plain_locomotion(without_motion: FeatureKind) -> None:
    clips = list(synthetic_clips(2, 100, without_motion, sentences=SENTENCES, gait_share=0.6))
    goes = [clip.scene.steps[0][0] for clip in clips if len(clip.scene.steps) == len(clip.scene.steps[0]) == 1]
    gaits = [step for step in goes if step.action in ("walk", "run", "jog", "sprint", "sidestep", "turn")]
    assert 50 <= len(gaits) <= 80
    assert {step.action for step in gaits} >= {"walk", "run", "jog", "sprint"}
    assert len({step.style for step in gaits}) > 8


def test_clips_are_no_longer_than_the_limit() -> None:
    for clip in synthetic_clips(1, 3, BODY, longest=5.0):
        assert 1 <= len(clip.features) <= 50
        assert clip.features.shape[1] == BODY.size


def test_the_facts_of_captions_hold_in_their_clip(without_motion: FeatureKind) -> None:
    for clip in synthetic_clips(3, 60, without_motion, sentences=SENTENCES):
        assert len(clip.captions) == len(clip.meanings)
        assert all(meaning and meaning <= facts(clip.scene) for meaning in clip.meanings)


def test_a_hard_negative_differs_from_its_caption_in_few_words(without_motion: FeatureKind) -> None:
    changed = [
        len(set(text.split()) ^ set(negative.split()))
        for clip in synthetic_clips(6, 60, without_motion)
        for text, negative in zip(clip.captions, clip.hard_negatives, strict=True)
        if negative
    ]
    assert len(changed) > 30
    assert np.median(changed) <= 4


def test_hard_negatives_are_false(without_motion: FeatureKind) -> None:
    parsed = [
        (facts(meant), facts(clip.scene), text)
        for clip in synthetic_clips(4, 300, without_motion)
        for text in clip.hard_negatives
        if (meant := parse(text)) is not None
    ]
    assert len(parsed) > 10
    seem_true = [text for meant, true, text in parsed if meant <= true]
    assert len(seem_true) <= 0.02 * len(parsed), seem_true  # the parser may miss a word


def test_held_out_sentences_are_never_used(without_motion: FeatureKind) -> None:
    def used(clips: list[SyntheticClip]) -> set[str]:
        return {text for clip in clips for text in (*clip.captions, *clip.hard_negatives)}

    free = used(list(synthetic_clips(5, 40, without_motion, sentences=SENTENCES)))
    held_out = HeldOutSentences(sorted(free)[::2])
    kept = used(list(synthetic_clips(5, 40, without_motion, sentences=SENTENCES, held_out=held_out)))
    assert any(map(held_out, free))
    assert not any(map(held_out, kept))


def test_human_sentences_become_captions_of_their_scenes(without_motion: FeatureKind) -> None:
    clips = synthetic_clips(6, 20, without_motion, sentences=SENTENCES, human_share=1.0)
    assert {clip.captions[0] for clip in clips} == set(SENTENCES)


def test_a_completed_scene_has_sides_and_directions_and_keeps_those_given() -> None:
    rng = np.random.default_rng(0)
    sided = next(name for name, program in programs().items() if program.sides)
    assert complete_scene(Scene(((ActionStep(sided),),)), rng).steps[0][0].side in programs()[sided].sides
    said = Scene(((ActionStep("wave", side="left"), ActionStep("walk", direction="backward")),))
    assert complete_scene(said, rng) == said
    assert complete_scene(Scene(((ActionStep("walk"),),)), rng).steps[0][0].direction == "forward"


def test_a_caption_is_relevant_to_its_clip_and_to_those_with_the_same_facts() -> None:
    def clip(said: Scene, shown: Scene) -> SyntheticClip:
        return SyntheticClip(np.zeros((4, 1), np.float32), shown, (), ("words",), (facts(said),), ())

    walk, left = Scene(((ActionStep("walk"),),)), Scene(((ActionStep("walk", direction="left"),),))
    right = Scene(((ActionStep("walk", direction="right"),),))
    assert relevance([clip(walk, right), clip(left, left), clip(right, right)]).tolist() == [
        [True, True, True],
        [False, True, False],
        [True, False, True],
    ]


def test_some_captions_omit_the_side_and_hold_for_either() -> None:
    rng = np.random.default_rng(0)
    said = [caption_and_hard_negative(Scene(((ActionStep("wave", side="right"),),)), rng)[:2] for _ in range(200)]
    left = facts(Scene(((ActionStep("wave", side="left"),),)))
    either = [text for text, stated in said if stated <= left]
    assert 40 < len(either) < 120
    assert not any(re.search(r"\b(left|right|both)\b", text.lower()) for text in either)
