"""People who wait: clips of their own, and before, after and under other actions."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.compositional_augmentation import CaptionedSegment
from encoders.corpus.composition.idle_motion import idle_clips, idle_segments
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import Motion


def waiting(*arms: str) -> Motion:
    """Fifteen seconds of standing, with an action of the arms if one is given."""
    group = (ActionStep("stand"), *map(ActionStep, arms))
    joints = np.concatenate([make_clip(Scene((group,)), np.random.default_rng(0), variation=0.0).joints[20:60]] * 8)
    return Motion(joints, 20.0)


def test_pieces_are_short_and_say_that_somebody_waits() -> None:
    pieces = idle_segments([waiting()], np.random.default_rng(0))
    assert pieces
    assert all(1.9 <= len(piece.joints) / 20 <= 7 for piece in pieces)
    assert all(piece.scene == Scene(((ActionStep("wait"),),)) for piece in pieces)


@pytest.mark.parametrize(
    ("action", "words"), [("cross arms", ("arm", "fold")), ("hands behind back", ("behind", "back"))]
)
def test_what_the_hands_do_is_read_from_the_motion(action: str, words: tuple[str, ...]) -> None:
    piece = idle_segments([waiting(action)], np.random.default_rng(0))[0]
    assert piece.scene is not None
    assert [step.action for step in piece.scene.steps[0]] == ["wait", action]
    assert any(word in caption for caption in piece.captions for word in words)


def test_an_action_among_waiting_keeps_its_own_captions() -> None:
    walk = make_clip(Scene(((ActionStep("walk"),),)), np.random.default_rng(1)).joints[:100]
    other = CaptionedSegment.parsed(walk, ("a person walks",))
    clips = list(idle_clips([waiting()], [other], 40, np.random.default_rng(2)))
    assert len(clips) == 40
    walks = [clip for clip in clips if clip.captions == ("a person walks",)]
    assert walks
    assert max(len(clip.motion.joints) for clip in walks) > len(walk) / 0.85 + 5  # the slowest playback, and waiting
    assert all(np.isfinite(clip.motion.joints).all() and clip.scene is not None for clip in clips)


def test_without_idle_takes_there_are_no_clips() -> None:
    assert not list(idle_clips([], [], 5, np.random.default_rng(0)))
