"""Varied features are those of the same movement: seen from a slightly other frame, by somebody of another posture."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.features.canonical import LAYOUT, POINTS, SIZE
from encoders.tmr.training.augment import pose_jitter, random_rotation


@pytest.fixture
def features() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(50, SIZE)).astype(np.float32)


def vectors(features: np.ndarray, name: str) -> np.ndarray:
    return features[:, LAYOUT[name]].reshape(len(features), -1, 3)


def test_lengths_and_angles_stay(features: np.ndarray) -> None:
    moved = random_rotation(features, np.random.default_rng(1), yaw=10.0, tilt=5.0)
    for name in ("positions", "velocities"):
        before, after = vectors(features, name), vectors(moved, name)
        np.testing.assert_allclose(
            np.einsum("tiv,tjv->tij", after, after), np.einsum("tiv,tjv->tij", before, before), atol=1e-4
        )
    assert np.abs(moved - features).max() > 0.05


def test_one_rotation_turns_all_groups_all_along(features: np.ndarray) -> None:
    moved = random_rotation(features, np.random.default_rng(1), yaw=10.0, tilt=5.0)
    before, after = vectors(features, "positions").reshape(-1, 3), vectors(moved, "positions").reshape(-1, 3)
    rotation = np.linalg.lstsq(before, after, rcond=None)[0]
    assert np.linalg.det(rotation) == pytest.approx(1, abs=1e-4)
    for name in ("velocities", "root_velocity", "trunk_up"):
        np.testing.assert_allclose(vectors(moved, name), vectors(features, name) @ rotation, atol=1e-4)


def test_yaw_leaves_the_vertical_and_tilt_does_not(features: np.ndarray) -> None:
    yawed = random_rotation(features, np.random.default_rng(1), yaw=10.0, tilt=0.0)
    np.testing.assert_allclose(vectors(yawed, "positions")[..., 1], vectors(features, "positions")[..., 1], atol=1e-5)
    tilted = random_rotation(features, np.random.default_rng(1), yaw=0.0, tilt=5.0)
    assert np.abs(vectors(tilted, "positions")[..., 1] - vectors(features, "positions")[..., 1]).max() > 0.01


def test_no_angle_changes_nothing(features: np.ndarray) -> None:
    np.testing.assert_allclose(random_rotation(features, np.random.default_rng(1), 0.0, 0.0), features, atol=1e-6)


def lengths(features: np.ndarray, start: str, end: str) -> np.ndarray:
    points = vectors(features, "positions")
    return np.linalg.norm(points[:, POINTS.index(end)] - points[:, POINTS.index(start)], axis=-1)


def test_another_posture_keeps_legs_place_and_the_lengths_of_arms(features: np.ndarray) -> None:
    moved = pose_jitter(features, np.random.default_rng(1), 10.0)
    legs = [i for i, name in enumerate(POINTS) if name.endswith(("knee", "ankle", "foot"))]
    for name in ("positions", "velocities"):
        np.testing.assert_array_equal(vectors(moved, name)[:, legs], vectors(features, name)[:, legs])
    for name in ("root_velocity", "height", "contacts", "yaw_rate"):
        np.testing.assert_array_equal(moved[:, LAYOUT[name]], features[:, LAYOUT[name]])
    for limb in (("left_shoulder", "left_elbow"), ("right_elbow", "right_wrist")):
        np.testing.assert_allclose(lengths(moved, *limb), lengths(features, *limb), rtol=1e-4)
    assert np.abs(vectors(moved, "positions") - vectors(features, "positions")).max() > 0.05


def test_velocities_go_with_the_limb_that_is_carried_otherwise() -> None:
    """An arm swung about its shoulder, from which the elbow's velocity follows."""
    angle = np.linspace(-0.5, 0.5, 41)
    features = np.zeros((41, SIZE), np.float32)
    elbow = np.stack([0 * angle, -np.cos(angle), np.sin(angle)], axis=-1)
    columns = [
        np.arange(SIZE)[LAYOUT[name]].reshape(-1, 3)[POINTS.index("left_elbow")] for name in ("positions", "velocities")
    ]
    features[:, columns[0]], features[:, columns[1]] = elbow, np.gradient(elbow, axis=0)
    for seed in range(4):
        moved = pose_jitter(features, np.random.default_rng(seed), 5.0)
        np.testing.assert_allclose(moved[1:-1, columns[1]], np.gradient(moved[:, columns[0]], axis=0)[1:-1], atol=3e-3)


def test_no_other_posture_changes_nothing(features: np.ndarray) -> None:
    np.testing.assert_allclose(pose_jitter(features, np.random.default_rng(1), 0.0), features, atol=1e-5)
