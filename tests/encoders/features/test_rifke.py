"""RIFKE features: what each number is, that nothing says where a motion is, and that joints come back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.features.registry import feature_kind
from encoders.features.rifke import LAYOUT, SIZE, joints_to_rifke, rifke_to_joints
from encoders.motion import Motion
from encoders.skeleton import INDEX
from tests.encoders.features.test_canonical import turned, walk

PLACED = {name: i - 1 for name, i in INDEX.items()}  # among the joints but the root


def standing() -> np.ndarray:
    """Joints (22, 3) that face +X, hips at 0.9 m; all others lie in the hips but those below."""
    joints = np.tile([0.0, 0.9, 0.0], (22, 1))
    for side, z in (("left", -0.1), ("right", 0.1)):
        joints[INDEX[f"{side}_hip"]] = [0, 0.9, z]
        joints[INDEX[f"{side}_shoulder"]] = [0, 1.4, 2 * z]
        joints[INDEX[f"{side}_foot"]] = [0.15, 0, z]
    return joints


def test_a_body_that_walks_ahead_in_numbers_worked_out_by_hand():
    joints = np.stack([standing() + np.array([2 + 0.05 * frame, 0.3, -1]) for frame in range(4)])
    rows = joints_to_rifke(joints)
    assert rows.shape == (4, SIZE) == (4, 67)
    np.testing.assert_allclose(rows[:, LAYOUT["height"]], 0.9, atol=1e-6)  # above the lowest point of the motion
    np.testing.assert_allclose(rows[:, LAYOUT["turn"]], 0, atol=1e-6)
    np.testing.assert_allclose(rows[:, LAYOUT["way"]], [[0, 0], [0.05, 0], [0.05, 0], [0.05, 0]], atol=1e-6)
    local = rows[0, LAYOUT["joints"]].reshape(21, 3)
    np.testing.assert_allclose(local[PLACED["left_foot"]], [0.15, 0, 0.1], atol=1e-6)  # forward, up, left
    np.testing.assert_allclose(local[PLACED["right_shoulder"]], [0, 1.4, -0.2], atol=1e-6)


def test_a_quarter_turn_to_the_left_and_a_step_to_the_side():
    before = standing()
    after = turned(before, np.pi / 2) + np.array([0, 0, -0.2])  # facing -Z now; -Z was to the left
    turn, way = (joints_to_rifke(np.stack([before, after]))[1, LAYOUT[name]] for name in ("turn", "way"))
    np.testing.assert_allclose(turn, np.pi / 2, atol=1e-6)
    np.testing.assert_allclose(way, [0.2, 0], atol=1e-6)


@settings(deadline=None, max_examples=25)
@given(st.floats(-3.1, 3.1), st.floats(-9, 9), st.floats(-9, 9), st.floats(-2, 2))
def test_where_a_motion_is_and_which_way_it_faces_changes_nothing(angle, x, z, y):
    np.testing.assert_allclose(
        joints_to_rifke(turned(walk(), angle) + np.array([x, y, z])), joints_to_rifke(walk()), atol=2e-5
    )


def test_joints_come_back_as_far_as_place_and_heading():
    joints = walk(seconds=12)  # it turns by almost a whole circle
    features = joints_to_rifke(joints)
    back = rifke_to_joints(features)
    np.testing.assert_allclose(joints_to_rifke(back), features, atol=2e-5)
    np.testing.assert_allclose(back[0, 0, [0, 2]], 0, atol=1e-6)
    between = np.linalg.norm(joints[:, :, None] - joints[:, None], axis=-1)
    np.testing.assert_allclose(np.linalg.norm(back[:, :, None] - back[:, None], axis=-1), between, atol=1e-5)
    way = np.linalg.norm(joints[-1, 0] - joints[0, 0])
    assert np.linalg.norm(back[-1, 0] - back[0, 0]) == pytest.approx(way, abs=1e-4)


def test_many_motions_at_once_give_what_each_gives_alone():
    motions = np.stack([walk(), turned(walk(), 1.0)[::-1]])
    np.testing.assert_array_equal(joints_to_rifke(motions)[1], joints_to_rifke(motions[1]))


def test_a_body_on_its_side_keeps_its_heading_and_nothing_is_infinite():
    upright = standing()
    lying = upright @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0.0]])  # the line across the body is vertical
    rows = joints_to_rifke(np.stack([upright, lying, upright]))
    np.testing.assert_allclose(rows[:, LAYOUT["turn"]], 0, atol=1e-6)
    assert np.isfinite(joints_to_rifke(np.stack([lying, lying]))).all()
    assert np.isfinite(joints_to_rifke(np.zeros((1, 22, 3)))).all()


def test_the_kind_is_registered_and_takes_motions_of_any_rate():
    kind = feature_kind("rifke")
    assert (kind.size, kind.fps) == (67, 12.5)
    at_20, at_60 = (kind.compute(Motion(walk(fps=fps), fps)) for fps in (20.0, 60.0))
    assert at_20.shape == at_60.shape == (51, 67)
    assert at_20.dtype == np.float32
    np.testing.assert_allclose(at_20, at_60, atol=0.02)
