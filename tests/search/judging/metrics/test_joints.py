"""Figures of joints: pose errors, seams, futures, ground contact, and the stretches that are looked at."""

import numpy as np
import pytest

from encoders.skeleton import INDEX
from search.judging.metrics.futures import best_of_many, future_diversity
from search.judging.metrics.pose_errors import position_and_variance_errors
from search.judging.metrics.scopes import random_crops, sliding_windows, transition_windows
from search.judging.metrics.time_warping import warped_distance
from search.plausibility.body_frame import from_origin, headings, local_pose, turned
from search.plausibility.ground import floor_height, foot_sliding, penetration
from search.plausibility.seams import quarters, transition_distances, world_distances
from tests.search.judging.bodies import standing

WRIST, LEFT, RIGHT = INDEX["left_wrist"], INDEX["left_foot"], INDEX["right_foot"]


def test_a_body_that_is_turned_has_the_same_pose_in_its_own_frame() -> None:
    body = standing(3)
    body[:, WRIST] += [0.1, 0.4, 0.3]
    elsewhere = turned(body, np.array([0.0, 1.0, np.pi / 2])) + np.array([2.0, 0.0, -1.0])
    assert headings(elsewhere) == pytest.approx([0.0, 1.0, np.pi / 2])
    assert np.allclose(local_pose(elsewhere), local_pose(body))
    assert np.allclose(from_origin(elsewhere[1:])[0], body[0])


def test_position_errors_of_a_body_that_should_stand_and_walks() -> None:
    real, walking = standing(3), standing(3)
    walking[..., 2] += np.array([0.0, 0.1, 0.2])[:, None]
    found = position_and_variance_errors([walking], [real])
    # Distances 0, 0.1 and 0.2 m; the variance of z is 0.01 over T - 1.
    for part in ("root", "trajectory", "global"):
        assert found[part] == pytest.approx((0.1, 0.01))
    assert found["local"] == pytest.approx((0, 0), abs=1e-12)


def test_position_errors_keep_heights_and_forget_where_a_motion_begins() -> None:
    raised = turned(standing(4), np.full(4, 0.7)) + np.array([3.0, 0.3, 1.0])
    found = position_and_variance_errors([raised], [standing(4)])
    assert {part: errors[0] for part, errors in found.items()} == pytest.approx(
        {"root": 0.3, "trajectory": 0.0, "local": 0.3, "global": 0.3}
    )


def test_position_errors_pool_frames_and_variance_errors_motions() -> None:
    walking = standing(3)
    walking[..., 2] += np.array([0.0, 0.1, 0.2])[:, None]
    found = position_and_variance_errors([walking, standing(2)], [standing(3), standing(9)])
    assert found["root"] == pytest.approx((0.3 / 5, 0.01 / 2))


def test_transition_distance_is_of_poses_and_forgets_the_root() -> None:
    joints = standing(4)
    joints[2:] += [0.5, 0, 0]
    joints[2:, WRIST] += [0, 0, 0.22]
    assert transition_distances(joints, [1, 2, 3]) == pytest.approx([0, 1.0, 0])  # 22 cm of one joint of 22
    assert world_distances(joints, [2]) == pytest.approx([(21 * 0.5 + np.hypot(0.5, 0.22)) / 22])
    assert quarters(40) == [10, 20, 30]
    assert quarters(2) == [1, 1]
    with pytest.raises(ValueError, match="4 frames"):
        transition_distances(joints, [4])


def test_the_best_future_counts_and_all_of_them_for_diversity() -> None:
    truth, near, far = standing(4), standing(4), standing(2)
    near[:, WRIST] += [0, 0, 0.1]
    far[:, WRIST] += [0, 0, 0.4]
    assert best_of_many([far, near], truth) == pytest.approx((0.1, 0.1))
    assert future_diversity([far, near, near]) == pytest.approx((0.2, 0.2))
    late, early = standing(6), standing(6)
    late[4:, WRIST] += [0, 0.3, 0]
    early[2:, WRIST] += [0, 0.3, 0]
    assert best_of_many([late], early) == pytest.approx((0.1, 0.0), abs=1e-7)


def test_time_warping_by_hand() -> None:
    def column(*values: float) -> np.ndarray:
        return np.array(values)[:, None]

    assert warped_distance(column(0, 1, 2), column(0, 0, 1, 2, 2)) == pytest.approx(0, abs=1e-7)
    assert warped_distance(column(0), column(3, 4)) == pytest.approx(3.5)
    assert warped_distance(column(0, 0, 5), column(1, 5)) == pytest.approx(2 / 3)


def test_a_foot_slides_while_the_other_stands() -> None:
    joints = standing(7)
    joints[:, LEFT, 0] += 0.04 * np.arange(7)  # 0.8 m/s, and none before and after: averages of 3, 4, 5, 5, 4, 3 fifths
    assert foot_sliding(joints, 20.0) == pytest.approx((20.0, 100 * 4 / 6))
    assert foot_sliding(joints, 10.0) == pytest.approx((10.0, 0.0))
    joints[:, LEFT, 1] = 0.06  # off the floor
    assert foot_sliding(joints, 20.0) == pytest.approx((0.0, 0.0))


def test_the_floor_is_where_feet_rest() -> None:
    joints = standing(8) + np.array([0, 0.1, 0])
    joints[3, WRIST, 1] = -0.1
    assert floor_height(joints, 20.0) == pytest.approx(0.1)
    assert penetration(joints, 20.0) == pytest.approx(1000 * 0.2 / 8)
    joints[3, WRIST, 1] = 0.097
    assert penetration(joints, 20.0) == 0


def test_windows_slide_from_the_start_and_lie_around_transitions() -> None:
    assert sliding_windows(199) == [(0, 80), (40, 120), (80, 160)]
    assert sliding_windows(80) == [(0, 80)]
    assert transition_windows(200, [100, 10, 190]) == [(60, 140), (0, 80), (120, 200)]
    with pytest.raises(ValueError, match="79 frames is shorter than a window of 80"):
        sliding_windows(79)
    with pytest.raises(ValueError, match="frame 200 lies outside"):
        transition_windows(200, [200])


def test_crops_are_of_the_length_asked_for_and_inside() -> None:
    spans = random_crops(130, 100, np.random.default_rng(0), count=200)
    assert {end - start for start, end in spans} == {100}
    assert (min(spans)[0], max(spans)[1]) == (0, 130)
    assert random_crops(90, 100, np.random.default_rng(0)) == [(0, 90)] * 5
