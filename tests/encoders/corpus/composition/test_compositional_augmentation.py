"""Compositional augmentation: concatenated segments and arm overlays."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake
from encoders.corpus.composition.compositional_augmentation import (
    CaptionedSegment,
    augmented_clips,
    captioned_segments,
    concatenate_segments,
    overlay_arms,
    replace_arms,
    synthetic_gesture,
)
from encoders.corpus.engine.posing import OFFSETS
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import Motion
from encoders.skeleton import INDEX, PARENTS

ARMS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("elbow", "wrist")]


def standing(frames: int) -> np.ndarray:
    """Joints (T, 22, 3) of a body in its rest pose, a metre above the ground."""
    joints = np.zeros((22, 3), np.float32)
    for joint, parent in enumerate(PARENTS):
        joints[joint] = OFFSETS[joint] + (joints[parent] if parent >= 0 else [0, 1, 0])
    return np.repeat(joints[None], frames, axis=0)


def walking(frames: int) -> np.ndarray:
    """The same body carried forward at one metre per second."""
    joints = standing(frames)
    joints[..., 2] += np.arange(frames)[:, None] / 20
    return joints


def turned(joints: np.ndarray, angle: float) -> np.ndarray:
    """The joints rotated about the vertical."""
    c, s = np.cos(angle), np.sin(angle)
    return joints @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]], np.float32)


def arms_up(frames: int) -> np.ndarray:
    """Both arms straight up."""
    joints = standing(frames)
    for side in ("left", "right"):
        for upper, lower in (("shoulder", "elbow"), ("elbow", "wrist")):
            joints[:, INDEX[f"{side}_{lower}"]] = joints[:, INDEX[f"{side}_{upper}"]] + [0, 0.27, 0]
    return joints


def test_segments_last_one_to_seven_seconds_and_have_short_captions() -> None:
    spans = (
        CaptionedSpan(("walks.",), 0.0, 3.0),
        CaptionedSpan(("walks, then sits",), 0.0, 3.0),
        CaptionedSpan(("blinks",), 1.0, 1.5),
        CaptionedSpan(("goes on and on",), 0.0, 9.0),
    )
    take = CaptionedTake("a.bvh", "1", Motion(walking(200)), "", spans)
    assert [(len(p.joints), p.captions) for p in captioned_segments([take])] == [(60, ("walks",))]


def test_concatenated_segments_have_captions_in_order_and_hard_negatives_in_reverse() -> None:
    first, second = (
        CaptionedSegment(walking(40), ("a man walks",)),
        CaptionedSegment(arms_up(30), ("the person raises both arms",)),
    )
    joined = concatenate_segments(first, second, np.random.default_rng(0))
    assert len(joined.motion.joints) == 70
    assert all(said.index("walk") < said.index("rais") for said in joined.captions)
    assert all(said.index("rais") < said.index("walk") for said in joined.hard_negatives)


def test_the_second_subject_is_not_repeated() -> None:
    pair = (
        CaptionedSegment(walking(40), ("a man walks",)),
        CaptionedSegment(arms_up(30), ("the person is raising both arms",)),
    )
    said = {text for seed in range(20) for text in concatenate_segments(*pair, np.random.default_rng(seed)).captions}
    assert "a man walks before raising both arms" in said
    assert not any("person" in text for text in said)


@pytest.mark.parametrize("angle", [0.0, 2.0])
def test_replaced_arms_follow_the_trunk(angle: float) -> None:
    body = turned(walking(10), angle)
    moved = replace_arms(body, arms_up(10))
    up = moved[:, INDEX["left_wrist"]] - moved[:, INDEX["left_shoulder"]]
    assert np.allclose(up / np.linalg.norm(up, axis=1)[:, None], [0, 1, 0], atol=0.02)
    rest = np.delete(np.arange(22), ARMS)
    assert np.array_equal(moved[:, rest], body[:, rest])


def test_replaced_arms_have_the_bone_lengths_of_the_body() -> None:
    body = walking(10) * 1.1
    moved = replace_arms(body, arms_up(10))
    for upper, lower in (("shoulder", "elbow"), ("elbow", "wrist")):
        joints = [INDEX[f"left_{upper}"], INDEX[f"left_{lower}"]]
        lengths = [np.linalg.norm(np.diff(x[:, joints], axis=1), axis=-1) for x in (body, moved)]
        assert lengths[1] == pytest.approx(lengths[0], abs=1e-5)


def test_an_overlay_is_as_long_as_the_shorter_clip_and_its_captions_name_both() -> None:
    laid = overlay_arms(
        CaptionedSegment(walking(60), ("walks forward",)),
        CaptionedSegment(arms_up(40), ("raises both arms",)),
        np.random.default_rng(1),
    )
    assert len(laid.motion.joints) == 40
    assert all("walk" in said and "rais" in said for said in laid.captions)
    assert not laid.hard_negatives


def test_captions_of_a_one_handed_gesture_may_omit_the_side() -> None:
    made = [synthetic_gesture(np.random.default_rng(seed)) for seed in range(60)]
    said = {text for piece in made for text in piece.captions if "one hand" in text or "one arm" in text}
    assert said
    assert not any(side in text for text in said for side in ("left", "right"))


def test_a_composed_clip_has_a_scene_if_both_captions_can_be_parsed() -> None:
    walk, up, odd = (
        CaptionedSegment.parsed(walking(40), (said,)) for said in ("a man walks", "raises both arms", "gnarls")
    )
    rng = np.random.default_rng(0)
    assert concatenate_segments(walk, up, rng).scene == Scene(
        ((ActionStep("walk"),), (ActionStep("raise arm", side="both"),))
    )
    assert overlay_arms(walk, up, rng).scene == Scene(((ActionStep("walk"), ActionStep("raise arm", side="both")),))
    assert concatenate_segments(walk, odd, rng).scene is overlay_arms(odd, up, rng).scene is None


def test_augmentation_is_deterministic_and_gives_the_wanted_count() -> None:
    spans = (CaptionedSpan(("walks",), 0.0, 3.0), CaptionedSpan(("strolls",), 2.0, 6.0))
    take = CaptionedTake("a.bvh", "1", Motion(walking(200)), "", spans)
    runs = [list(augmented_clips([take], 6, np.random.default_rng(3))) for _ in range(2)]
    assert len(runs[0]) == 6
    for a, b in zip(*runs, strict=True):
        assert a.captions == b.captions
        assert np.array_equal(a.motion.joints, b.motion.joints)


def test_a_single_segment_gives_no_augmented_clip() -> None:
    take = CaptionedTake("a.bvh", "1", Motion(walking(60)), "", (CaptionedSpan(("walks",), 0.0, 3.0),))
    assert list(augmented_clips([take], 5, np.random.default_rng(0))) == []
