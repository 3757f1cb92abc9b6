"""Captioned real motion: cropped to caption spans, mirrored with its captions, at several speeds."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake, mirror_words, real_clips
from encoders.features.registry import FEATURE_KINDS, FeatureKind
from encoders.motion import Motion

#: Every second frame's root: what a feature kind at 10 frames a second could be.
ROOT = FeatureKind("root", 3, 10.0, lambda motion: np.ascontiguousarray(motion.joints[::2, 0]))


@pytest.mark.parametrize(
    ("sentence", "mirrored"),
    [
        ("steps to the left", "steps to the right"),
        ("Left hand, right foot", "Right hand, left foot"),
        ("turns clockwise", "turns counterclockwise"),
        ("turns counter clockwise", "turns clockwise"),
        ("turns counter-clockwise", "turns clockwise"),
        ("a right-handed throw", "a left-handed throw"),
        ("drifts leftwards", "drifts rightwards"),
        ("sits down right away", "sits down right away"),
        ("stands upright", "stands upright"),
        ("with bright leftovers", "with bright leftovers"),
        ("walks", "walks"),
    ],
)
def test_mirroring_swaps_words_for_sides_only(sentence: str, mirrored: str) -> None:
    assert mirror_words(sentence) == mirrored


def motion(seconds: float) -> Motion:
    """Noise, and a root whose x counts the seconds."""
    frames = round(20 * seconds)
    joints = np.random.default_rng(0).normal(size=(frames, 22, 3)).astype(np.float32)
    joints[:, 0, 0] = np.arange(frames) / 20
    return Motion(joints)


def take(seconds: float, *spans: CaptionedSpan, description: str = "") -> CaptionedTake:
    return CaptionedTake("take.bvh", "1", motion(seconds), description, spans)


def test_features_are_cropped_to_the_caption_span() -> None:
    [(features, captions)] = real_clips(take(10, CaptionedSpan(("waves",), 2.0, 5.0)), ROOT, varied=False)
    assert captions == ("waves",)
    assert features[:, 0] == pytest.approx(np.arange(2, 5, 0.1), abs=1e-5)


def test_a_short_take_is_captioned_by_its_description() -> None:
    assert [said for _, said in real_clips(take(6, description="jumping"), ROOT, varied=False)] == [("jumping",)]
    assert list(real_clips(take(20, description="jumping"), ROOT, varied=False)) == []


def test_spans_end_with_the_take_and_are_cropped_to_the_longest() -> None:
    spans = (CaptionedSpan(("a",), 8.0, float("inf")), CaptionedSpan(("b",), 0.0, 9.0))
    lengths = [len(f) for f, _ in real_clips(take(10, *spans), ROOT, varied=False, longest=4.0)]
    assert lengths == [20, 40]


def test_very_short_spans_are_dropped() -> None:
    assert list(real_clips(take(10, CaptionedSpan(("a",), 3.0, 3.2)), ROOT, varied=False)) == []


def test_mirrored_clips_are_clips_of_the_mirrored_motion() -> None:
    body = FEATURE_KINDS["body"]
    whole = take(4, CaptionedSpan(("lifts the left arm",), 1.0, 3.0))
    varied = {captions[0]: features for features, captions in list(real_clips(whole, body))[2:4]}
    assert np.array_equal(varied["lifts the left arm"], body.compute(whole.motion)[10:30])
    assert np.array_equal(varied["lifts the right arm"], body.compute(whole.motion.mirror())[10:30])


def test_playback_speed_changes_the_length_and_not_the_content() -> None:
    clips = list(real_clips(take(10, CaptionedSpan(("a",), 2.0, 8.0)), ROOT))
    assert len(clips) == 6
    for features, _ in clips:
        assert abs(features[0, 0]) == pytest.approx(2.0, abs=0.15)
        assert abs(features[-1, 0]) == pytest.approx(8.0, abs=0.25)
    assert sorted({len(features) for features, _ in clips}) == pytest.approx([50, 60, 71], abs=1)
