"""Turned features are those of the same movement seen from a slightly other frame."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.body import LAYOUT, SIZE
from encoders.tmr.augment import turned


@pytest.fixture
def features() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(50, SIZE)).astype(np.float32)


def vectors(features: np.ndarray, name: str) -> np.ndarray:
    return features[:, LAYOUT[name]].reshape(len(features), -1, 3)


def test_lengths_and_angles_stay(features: np.ndarray) -> None:
    moved = turned(features, np.random.default_rng(1), yaw=10.0, tilt=5.0)
    for name in ("positions", "velocities"):
        before, after = vectors(features, name), vectors(moved, name)
        np.testing.assert_allclose(
            np.einsum("tiv,tjv->tij", after, after), np.einsum("tiv,tjv->tij", before, before), atol=1e-4
        )
    assert np.abs(moved - features).max() > 0.05


def test_one_rotation_turns_all_groups_all_along(features: np.ndarray) -> None:
    moved = turned(features, np.random.default_rng(1), yaw=10.0, tilt=5.0)
    before, after = vectors(features, "positions").reshape(-1, 3), vectors(moved, "positions").reshape(-1, 3)
    rotation = np.linalg.lstsq(before, after, rcond=None)[0]
    assert np.linalg.det(rotation) == pytest.approx(1, abs=1e-4)
    for name in ("velocities", "root_velocity", "trunk_up"):
        np.testing.assert_allclose(vectors(moved, name), vectors(features, name) @ rotation, atol=1e-4)


def test_yaw_leaves_the_vertical_and_tilt_does_not(features: np.ndarray) -> None:
    yawed = turned(features, np.random.default_rng(1), yaw=10.0, tilt=0.0)
    np.testing.assert_allclose(vectors(yawed, "positions")[..., 1], vectors(features, "positions")[..., 1], atol=1e-5)
    tilted = turned(features, np.random.default_rng(1), yaw=0.0, tilt=5.0)
    assert np.abs(vectors(tilted, "positions")[..., 1] - vectors(features, "positions")[..., 1]).max() > 0.01


def test_no_angle_changes_nothing(features: np.ndarray) -> None:
    np.testing.assert_allclose(turned(features, np.random.default_rng(1), 0.0, 0.0), features, atol=1e-6)
