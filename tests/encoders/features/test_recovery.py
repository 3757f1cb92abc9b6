"""Features become joints that have the same features again."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.errors import ArgumentError
from encoders.features import canonical
from encoders.features.recovery import body_joints, recovered_motion, upsampled
from encoders.features.registry import FEATURE_KINDS
from encoders.geometry import length
from encoders.skeleton import BONE_LENGTHS, INDEX, PARENTS
from tests.search.conftest import made_motion


def turning_walk() -> np.ndarray:
    """Features of a figure that swings its arms, walks and turns left by a radian a second."""
    features = FEATURE_KINDS["body"].compute(made_motion(4.0, 3))
    features[:, canonical.LAYOUT["yaw_rate"]] = 1.0
    return features


def test_body_features_come_back() -> None:
    features = turning_walk()
    again = FEATURE_KINDS["body"].compute(recovered_motion("body", features))
    layout = canonical.LAYOUT
    assert again.shape == features.shape
    assert np.abs(again - features)[:, layout["positions"]].max() < 0.03, "metres"
    assert np.abs(again - features)[2:-2, layout["yaw_rate"]].max() < 0.05, "radians a second"
    assert np.abs(again - features)[:, layout["height"]].max() < 0.03
    forward = slice(layout["root_velocity"].start, layout["root_velocity"].stop)
    assert np.abs(again - features)[2:-2, forward].mean() < 0.05


def test_bones_have_the_target_lengths() -> None:
    joints = body_joints(turning_walk().astype(np.float64))
    assert np.allclose(length(joints - joints[:, np.maximum(PARENTS, 0)]), BONE_LENGTHS, atol=1e-6)


def test_a_sole_that_stands_stays_where_it_is() -> None:
    features = turning_walk().astype(np.float64)
    features[:, canonical.LAYOUT["yaw_rate"]] = 0
    features[:, canonical.LAYOUT["contacts"]] = [1, 0, 0, 0]  # the left ankle, whatever the root's velocity says
    ankle = body_joints(features)[:, INDEX["left_ankle"], ::2]
    assert np.abs(ankle - ankle[0]).max() < 0.01


def test_rows_between_lie_on_a_parabola() -> None:
    places = np.arange(8.0)
    assert np.allclose(upsampled(places[:, None] ** 2)[2:-3, 0], (np.arange(2, 12) / 2) ** 2)


def test_features_of_other_kinds_are_refused() -> None:
    with pytest.raises(ArgumentError, match="'rotations' cannot be turned into joints; body, humanml3d can"):
        recovered_motion("rotations", np.zeros((4, 7)))
