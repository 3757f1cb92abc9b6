"""Motion: cropping, resampling, mirroring; it never changes what it was given."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.motion import Motion
from encoders.skeleton import INDEX, MIRROR, PARENTS


def walk(seconds: float = 2.0, fps: float = 20.0) -> Motion:
    """A smooth movement sampled at `fps`: every joint on its own curve."""
    t = np.arange(round(seconds * fps) + 1)[:, None, None] / fps
    phase = np.arange(66).reshape(22, 3)
    return Motion(np.sin(2 * t + phase), fps)


def test_the_input_is_copied_and_the_joints_are_read_only():
    joints = np.zeros((4, 22, 3), np.float32)
    motion = Motion(joints)
    joints[:] = 1
    assert (motion.joints == 0).all()
    with pytest.raises(ValueError, match="read-only"):
        motion.joints[0] = 1
    with pytest.raises(dataclasses.FrozenInstanceError):
        motion.fps = 30.0  # type: ignore[misc]


@pytest.mark.parametrize("shape", [(0, 22, 3), (5, 21, 3), (22, 3), (2, 5, 22, 3)])
def test_wrong_shapes_are_refused(shape):
    with pytest.raises(ValueError, match="must be"):
        Motion(np.zeros(shape))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_joints_must_be_finite(value):
    joints = np.zeros((2, 22, 3))
    joints[1, 3, 2] = value
    with pytest.raises(ValueError, match="finite"):
        Motion(joints)


@pytest.mark.parametrize("fps", [0, -20, np.nan, np.inf])
def test_the_rate_must_be_positive(fps):
    with pytest.raises(ValueError, match="fps"):
        Motion(np.zeros((2, 22, 3)), fps)


@pytest.mark.parametrize("fps", ["20", None, True, 20j])
def test_the_rate_must_be_a_number(fps):
    with pytest.raises(TypeError, match="fps"):
        Motion(np.zeros((2, 22, 3)), fps)
    with pytest.raises(TypeError, match="fps"):
        Motion(np.zeros((2, 22, 3))).resample(fps)


@pytest.mark.parametrize(
    "joints",
    [
        np.zeros((2, 22, 3), complex),
        np.zeros((2, 22, 3), bool),
        np.zeros((2, 22, 3), str),
        np.zeros((2, 22, 3), object),
        np.ma.masked_equal(np.zeros((2, 22, 3)), 0),
        None,
        "walk",
    ],
)
def test_joints_must_be_real_numbers(joints):
    with pytest.raises(TypeError, match="real numbers"):
        Motion(joints)


def test_joints_may_be_integers_lists_and_halves():
    for joints in (np.ones((2, 22, 3), int), np.ones((2, 22, 3)).tolist(), np.ones((2, 22, 3), np.float16)):
        assert Motion(joints) == Motion(np.ones((2, 22, 3), np.float32))


def test_joints_too_large_for_single_precision_are_not_finite():
    with pytest.raises(ValueError, match="finite"):
        Motion(np.full((2, 22, 3), 1e300))


def test_duration_counts_each_frame_for_one_frame_of_time():
    assert Motion(np.zeros((40, 22, 3)), 20).duration == 2.0


def test_crop_takes_seconds():
    motion = walk(2.0)
    crop = motion.crop(0.5, 1.0)
    np.testing.assert_array_equal(crop.joints, motion.joints[10:20])
    assert crop.fps == motion.fps


def test_crop_holds_to_the_motion_and_keeps_at_least_one_frame():
    motion = walk(2.0)
    np.testing.assert_array_equal(motion.crop(-1, 99).joints, motion.joints)
    np.testing.assert_array_equal(motion.crop().joints, motion.joints)
    np.testing.assert_array_equal(motion.crop(1.0, 1.001).joints, motion.joints[20:21])


@pytest.mark.parametrize(("start", "end"), [(1.0, 1.0), (1.5, 1.0), (99, 100), (-2, -1)])
def test_crop_refuses_a_span_outside(start, end):
    with pytest.raises(ValueError, match="lies outside"):
        walk(2.0).crop(start, end)


def test_crops_put_together_are_the_motion():
    motion = walk(2.0)
    parts = [motion.crop(0.35 * i, 0.35 * (i + 1)).joints for i in range(6)]
    np.testing.assert_array_equal(np.concatenate(parts), motion.joints)


@pytest.mark.parametrize("fps", [24, 25, 29.97, 30, 59.94, 60, 100, 120, 240])
def test_resampling_follows_the_true_time_grid(fps):
    np.testing.assert_allclose(walk(2.0, fps).resample(20).joints[:39], walk(2.0).joints[:39], atol=2e-3)


def test_resampling_up_and_back_is_exact_on_the_old_frames():
    motion = walk(2.0)
    np.testing.assert_allclose(motion.resample(60).resample(20).joints, motion.joints, atol=1e-6)


def test_resampling_to_the_same_rate_changes_nothing():
    motion = walk(2.0)
    assert motion.resample(20) is motion


@given(frames=st.integers(1, 300), source=st.floats(1, 500), target=st.floats(1, 500))
@settings(max_examples=50, deadline=None)
def test_resampling_keeps_the_first_frame_and_stays_within_the_take(frames, source, target):
    motion = Motion(np.arange(frames)[:, None, None] * np.ones((1, 22, 3)), source)
    resampled = motion.resample(target)
    assert resampled.joints[0, 0, 0] == 0
    assert (len(resampled) - 1) / target <= (frames - 1) / source + 1e-3
    assert resampled.joints.max() <= frames - 1


@pytest.mark.parametrize("fps", [0, -1, np.nan, np.inf])
def test_resampling_needs_a_positive_rate(fps):
    with pytest.raises(ValueError, match="fps"):
        walk().resample(fps)


def test_mirror_swaps_sides_and_flips_x():
    motion = walk()
    mirrored = motion.mirror()
    left = motion.joints[:, INDEX["left_wrist"]]
    np.testing.assert_array_equal(mirrored.joints[:, INDEX["right_wrist"]], left * [-1, 1, 1])
    np.testing.assert_array_equal(mirrored.mirror().joints, motion.joints)


def test_mirrored_joints_keep_their_bones():
    parents = PARENTS[1:]
    np.testing.assert_array_equal(MIRROR[parents], PARENTS[MIRROR[1:]])


def test_operations_leave_the_motion_alone():
    motion = walk(2.0, 30)
    before = motion.joints.copy()
    motion.crop(0, 1), motion.resample(20), motion.mirror()
    np.testing.assert_array_equal(motion.joints, before)
