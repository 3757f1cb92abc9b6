"""Directions, the smallest rotation between two, and tracks at other times."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from encoders.geometry import angle_between, frames, interpolate, resample, rotation_between, unit

VECTORS = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)


def angle_of(rotation: np.ndarray) -> float:
    """By how many degrees a rotation (3, 3) turns."""
    return float(np.degrees(np.arccos(np.clip((np.trace(rotation) - 1) / 2, -1, 1))))


@given(VECTORS, VECTORS)
def test_a_rotation_brings_one_direction_to_the_other_and_turns_no_further(a: np.ndarray, b: np.ndarray) -> None:
    assume(np.linalg.norm(unit(a) + unit(b)) > 1e-5)  # opposite ones are below
    rotation = rotation_between(a, b)
    assert np.allclose(rotation @ unit(a), unit(b), atol=1e-9)
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1)
    assert angle_of(rotation) == pytest.approx(float(angle_between(a, b)), abs=1e-4)


@given(VECTORS, st.floats(0, 1e-3))
@example(np.array([0.75, 5.96e-8, 0.0]), 0.0)
@example(np.array([1.0, 0.0, 0.0]), 5e-8)
def test_opposite_directions_are_half_a_turn_apart(a: np.ndarray, off: float) -> None:
    b = -a + off * np.array([1.0, -2.0, 0.5])
    rotation = rotation_between(a, b)
    assert np.allclose(rotation @ unit(a), unit(b), atol=1e-6)
    assert np.linalg.det(rotation) == pytest.approx(1)


def test_a_direction_of_no_length_turns_nothing() -> None:
    some = np.array([[0.0, 0, 0], [0, 2, 0], [0, 0, 0]])
    other = np.array([[1.0, 0, 0], [0, 0, 0], [0, 0, 0]])
    assert np.array_equal(rotation_between(some, other), np.tile(np.eye(3), (3, 1, 1)))


def test_unit_vectors_keep_zero_and_their_type() -> None:
    vectors = np.array([[3.0, 0, 4], [0, 0, 0]], np.float32)
    assert unit(vectors).tolist() == pytest.approx(np.array([[0.6, 0, 0.8], [0, 0, 0]]))
    assert unit(vectors).dtype == np.float32


def test_frames_keep_the_direction_across_and_right_up() -> None:
    left, up, forward = frames(np.array([2.0, 0, 0]), np.array([0.5, 1, 0])).T
    assert (left.tolist(), up.tolist(), forward.tolist()) == ([1, 0, 0], [0, 1, 0], [0, 0, 1])


def test_a_straight_track_is_straight_at_any_rate() -> None:
    track = np.arange(31, dtype=np.float64)[:, None] * [1.0, -2.0]
    assert np.allclose(resample(track, 30, 20), np.arange(21)[:, None] * [1.5, -3.0])
    assert np.allclose(resample(track, 30, 60), np.arange(61)[:, None] * [0.5, -1.0])


def test_tracks_are_interpolated_along_any_axis_and_keep_their_type() -> None:
    image = np.arange(12, dtype=np.float32).reshape(3, 4)
    at = np.array([0.0, 0.25, 3.0])
    assert interpolate(image, at, axis=1).tolist() == [[0, 0.25, 3], [4, 4.25, 7], [8, 8.25, 11]]
    assert interpolate(image, np.array([1.5])).tolist() == [[6, 7, 8, 9]]
    assert interpolate(image, at, axis=1).dtype == np.float32


@pytest.mark.parametrize("fps", [0.0, -5.0, float("nan"), float("inf")])
def test_a_rate_must_be_positive(fps: float) -> None:
    with pytest.raises(ValueError, match="positive"):
        resample(np.zeros((3, 2)), 20, fps)
