"""Joining, stitching and feet, on motions whose result is known."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.skeleton import INDEX
from search.compose.body_parts import INDICES
from search.compose.feet import planted, standing
from search.compose.joins import Piece, aligned, heading, joined, longest_half
from search.compose.rotations import Rotated, multiplied
from search.compose.stitching import overlaid
from tests.search.conftest import made_motion

FPS = 20


@pytest.fixture
def clip() -> Rotated:
    return Rotated.of(made_motion(8, 1))


@pytest.fixture
def other() -> Rotated:
    return Rotated.of(made_motion(8, 2))


def test_rotations_give_the_motion_back() -> None:
    motion = made_motion(4, 3)
    assert np.abs(Rotated.of(motion).joints() - motion.joints).max() < 1e-6


def test_a_clip_cut_in_two_is_joined_to_itself(clip: Rotated) -> None:
    pieces = [Piece(clip, 10, 1.0, 50), Piece(clip, 60, 1.0, 60)]
    assert np.abs(joined(pieces, 10).joints() - clip[10:120].joints()).max() < 1e-9


def test_a_piece_is_placed_where_the_one_before_leads(clip: Rotated) -> None:
    elsewhere = clip.moved(2.0, np.array([3.0, 0.0, -4.0]))
    pieces = [Piece(clip, 10, 1.0, 50), Piece(elsewhere, 60, 1.0, 60)]
    assert np.abs(joined(pieces, 10).joints() - clip[10:120].joints()).max() < 1e-9


def test_alignment_never_changes_heights(clip: Rotated, other: Rotated) -> None:
    moved, apart = aligned(other, 7, clip, 30)
    own, goal = moved[7:8].joints()[0], clip[30:31].joints()[0]
    assert np.isclose(apart, np.linalg.norm(own - goal, axis=-1).mean())
    assert np.allclose(moved.root[:, 1], other.root[:, 1])
    assert np.allclose(moved.root[7, [0, 2]], clip.root[30, [0, 2]])
    assert np.isclose(heading(own), heading(goal))


def test_a_join_of_two_clips_moves_no_faster_than_they_do(clip: Rotated, other: Rotated) -> None:
    result = joined([Piece(clip, 0, 1.0, 60), Piece(other, 40, 1.0, 60)], 10).joints()
    assert len(result) == 120
    speeds = np.linalg.norm(np.diff(result, axis=0), axis=-1).max(axis=1)
    own = max(np.linalg.norm(np.diff(one.joints(), axis=0), axis=-1).max() for one in (clip, other))
    assert speeds[45:75].max() < 1.5 * own
    thighs = [
        np.linalg.norm(joints[:, INDEX["left_knee"]] - joints[:, INDEX["left_hip"]], axis=-1)
        for joints in (result, np.concatenate([clip.joints(), other.joints()]))
    ]
    assert thighs[1].min() - 1e-3 < thighs[0].min() <= thighs[0].max() < thighs[1].max() + 1e-3


def test_parts_are_taken_over_and_given_back(clip: Rotated, other: Rotated) -> None:
    margin = longest_half(10)
    result = overlaid(clip, other[: 60 + 2 * margin], ["right arm"], (40, 100), margin, 10)
    arm = INDICES["right arm"]
    rest = [joint for joint in range(22) if joint not in arm]
    assert np.array_equal(result.turns[:, rest], clip.turns[:, rest])
    assert np.array_equal(result.root, clip.root)
    inside = slice(40 + margin, 100 - margin)
    same = np.abs((result.turns[inside, arm] * other.turns[2 * margin : 60, arm]).sum(-1))
    assert np.allclose(same, 1)
    for outside in (slice(0, 40 - margin), slice(100 + margin, None)):
        assert np.array_equal(result.turns[outside], clip.turns[outside])
    steps = np.linalg.norm(np.diff(result.joints()[:, arm], axis=0), axis=-1)
    assert steps.max() < 0.3


def test_a_part_is_taken_over_more_slowly_where_poses_lie_far_apart(clip: Rotated) -> None:
    margin, begins = longest_half(10), []
    waist = INDEX["spine1"]
    for angle in (0.1, 1.5):
        turn = np.broadcast_to([0, 0, np.sin(angle / 2), np.cos(angle / 2)], (len(clip), 4))
        turns = clip.turns.copy()
        turns[:, waist] = multiplied(turn, clip.turns[:, waist])
        layer = Rotated(clip.root, turns, clip.bones)[20 : 120 + margin]
        result = overlaid(clip, layer, ["spine"], (20 + margin, 120), margin, 10)
        changed = ~np.isclose(result.turns, clip.turns).all(axis=(1, 2))
        begins.append(int(changed.argmax()))
    assert begins[0] == 20 + margin - 5
    assert begins[1] < begins[0] - 1


def test_a_resting_foot_that_slides_is_held() -> None:
    joints = np.repeat(made_motion(1, 1).joints[:1].astype(np.float64), 60, axis=0)
    joints += np.linspace(0, 0.3, 60)[:, None, None] * np.array([1.0, 0.0, 0.0])
    rests = np.zeros((60, 2), bool)
    rests[20:40, 0] = True
    held = planted(joints, rests, FPS)
    foot = INDEX["left_foot"]
    assert np.ptp(held[20:40, foot], axis=0).max() < 0.02
    assert np.abs(np.diff(held[:, foot], axis=0)).max() < 0.05
    for end, start in (("left_knee", "left_hip"), ("left_ankle", "left_knee"), ("left_foot", "left_ankle")):
        bones = [np.linalg.norm(j[:, INDEX[end]] - j[:, INDEX[start]], axis=-1) for j in (joints, held)]
        assert np.allclose(*bones)
    right = [INDEX[f"right_{joint}"] for joint in ("hip", "knee", "ankle", "foot")]
    assert np.allclose(held[:, right], joints[:, right])


def test_a_foot_rests_where_it_is_low_and_still() -> None:
    joints = np.repeat(made_motion(1, 1).joints[:1].astype(np.float64), 40, axis=0)
    joints[20:, INDEX["right_foot"]] += np.array([0, 0.3, 0])
    assert standing(joints, FPS)[:18].all()
    assert not standing(joints, FPS)[22:, 1].any()
