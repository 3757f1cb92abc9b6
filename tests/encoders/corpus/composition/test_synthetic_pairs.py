"""Made training pairs: reproducible, true, and without a held-out sentence."""

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
def unacted(monkeypatch: pytest.MonkeyPatch) -> FeatureKind:
    """Scenes are described but not acted out, so that many can be looked at."""
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


def test_a_share_of_the_clips_may_just_go(unacted: FeatureKind) -> None:
    clips = list(synthetic_clips(2, 100, unacted, sentences=SENTENCES, gait_share=0.6))
    goes = [clip.scene.steps[0][0] for clip in clips if len(clip.scene.steps) == len(clip.scene.steps[0]) == 1]
    gaits = [step for step in goes if step.action in ("walk", "run", "jog", "sprint", "sidestep", "turn")]
    assert 50 <= len(gaits) <= 80
    assert {step.action for step in gaits} >= {"walk", "run", "jog", "sprint"}
    assert len({step.style for step in gaits}) > 8


def test_clips_are_as_long_as_was_asked_at_most() -> None:
    for clip in synthetic_clips(1, 3, BODY, longest=5.0):
        assert 1 <= len(clip.features) <= 50
        assert clip.features.shape[1] == BODY.size


def test_everything_a_caption_states_is_true_of_its_clip(unacted: FeatureKind) -> None:
    for clip in synthetic_clips(3, 60, unacted, sentences=SENTENCES):
        assert len(clip.captions) == len(clip.meanings)
        assert all(meaning and meaning <= facts(clip.scene) for meaning in clip.meanings)


def test_a_twin_says_nearly_the_same_in_nearly_the_same_words(unacted: FeatureKind) -> None:
    changed = [
        len(set(text.split()) ^ set(twin.split()))
        for clip in synthetic_clips(6, 60, unacted)
        for text, twin in zip(clip.captions, clip.hard_negatives, strict=True)
        if twin
    ]
    assert len(changed) > 30
    assert np.median(changed) <= 4


def test_swapped_captions_are_false(unacted: FeatureKind) -> None:
    read = [
        (facts(meant), facts(clip.scene), text)
        for clip in synthetic_clips(4, 300, unacted)
        for text in clip.hard_negatives
        if (meant := parse(text)) is not None
    ]
    assert len(read) > 10
    seem_true = [text for meant, true, text in read if meant <= true]
    assert len(seem_true) <= 0.02 * len(read), seem_true  # the reader may miss a word


def test_held_out_sentences_are_never_used(unacted: FeatureKind) -> None:
    def used(clips: list[SyntheticClip]) -> set[str]:
        return {text for clip in clips for text in (*clip.captions, *clip.hard_negatives)}

    free = used(list(synthetic_clips(5, 40, unacted, sentences=SENTENCES)))
    held_out = HeldOutSentences(sorted(free)[::2])
    kept = used(list(synthetic_clips(5, 40, unacted, sentences=SENTENCES, held_out=held_out)))
    assert any(map(held_out, free))
    assert not any(map(held_out, kept))


def test_human_sentences_are_acted_out_and_kept_as_captions(unacted: FeatureKind) -> None:
    clips = synthetic_clips(6, 20, unacted, sentences=SENTENCES, human_share=1.0)
    assert {clip.captions[0] for clip in clips} == set(SENTENCES)


def test_what_a_scene_leaves_open_is_decided_and_what_it_says_stays() -> None:
    rng = np.random.default_rng(0)
    sided = next(name for name, program in programs().items() if program.sides)
    assert complete_scene(Scene(((ActionStep(sided),),)), rng).steps[0][0].side in programs()[sided].sides
    said = Scene(((ActionStep("wave", side="left"), ActionStep("walk", direction="backward")),))
    assert complete_scene(said, rng) == said
    assert complete_scene(Scene(((ActionStep("walk"),),)), rng).steps[0][0].direction == "forward"


def test_a_sentence_is_true_of_its_clip_and_of_those_that_show_the_same() -> None:
    def clip(said: Scene, shown: Scene) -> SyntheticClip:
        return SyntheticClip(np.zeros((4, 1), np.float32), shown, (), ("words",), (facts(said),), ())

    walk, left = Scene(((ActionStep("walk"),),)), Scene(((ActionStep("walk", direction="left"),),))
    right = Scene(((ActionStep("walk", direction="right"),),))
    assert relevance([clip(walk, right), clip(left, left), clip(right, right)]).tolist() == [
        [True, True, True],
        [False, True, False],
        [True, False, True],
    ]


def test_some_captions_leave_open_which_hand_it_is_and_count_for_either() -> None:
    rng = np.random.default_rng(0)
    said = [caption_and_hard_negative(Scene(((ActionStep("wave", side="right"),),)), rng)[:2] for _ in range(200)]
    left = facts(Scene(((ActionStep("wave", side="left"),),)))
    either = [text for text, stated in said if stated <= left]
    assert 40 < len(either) < 120
    assert not any(re.search(r"\b(left|right|both)\b", text.lower()) for text in either)
