"""The 263 published features: golden numbers of the published code, and what must hold for any motion."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from encoders.features.humanml3d import (
    LAYOUT,
    SIZE,
    canonical,
    features_to_joints,
    joints_to_features,
    uniform_skeleton,
)
from encoders.features.registry import FEATURE_KINDS
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, PARENTS
from tests.conftest import ROOT

EXCERPT = ROOT / "tests" / "data" / "humanml3d_features.npz"
TOLERANCE = {name: 1e-4 if name == "rotations" else 1e-5 for name in LAYOUT}
VARIANTS = {"": True, "_noretarget": False}


def assert_features_close(actual, published):
    assert actual.shape == published.shape
    for name, columns in LAYOUT.items():
        difference = np.abs(actual[..., columns] - published[..., columns]).max(initial=0)
        assert difference <= TOLERANCE[name], f"{name} differ by {difference:.2e}"
    np.testing.assert_array_equal(actual[..., LAYOUT["contacts"]], published[..., LAYOUT["contacts"]])


@pytest.fixture(scope="module")
def published(golden):
    with np.load(golden / "humanml3d_features.npz", allow_pickle=False) as arrays:
        return dict(arrays)


def regular_cases(published):
    names = {key.split("/")[0] for key in published if key.endswith("/recovered_noretarget")}
    cases = sorted(name for name in names if not name.startswith(("DEGENERATE", "BUGGY")))
    assert len(cases) >= 34
    return cases


@pytest.fixture(scope="module")
def excerpt():
    """Some cases and rows of the published numbers; `published` has all of them."""
    with np.load(EXCERPT, allow_pickle=False) as arrays:
        return dict(arrays)


@pytest.fixture(scope="module")
def walk(excerpt):
    """A walk with other than the target's proportions."""
    return excerpt["hips_wider_than_shoulders/joints"].astype(np.float64)


def turned(joints, angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return joints @ np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])


# Golden numbers


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("case", ["five_frames", "hips_wider_than_shoulders"])
def test_the_excerpt_of_the_published_numbers_is_matched(excerpt, case, variant):
    rows = excerpt[f"{case}/rows"]
    features = joints_to_features(excerpt[f"{case}/joints"], retarget=VARIANTS[variant])
    assert_features_close(features[rows], excerpt[f"{case}/features{variant}"])
    np.testing.assert_allclose(features_to_joints(features)[rows], excerpt[f"{case}/recovered{variant}"], atol=1e-4)


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_regular_case_is_matched(published, variant):
    for case in regular_cases(published):
        joints = published[f"{case}/joints"]
        features = joints_to_features(joints, retarget=VARIANTS[variant])
        assert_features_close(features, published[f"{case}/features{variant}"])


@pytest.mark.parametrize("variant", VARIANTS)
def test_joints_are_recovered_from_every_regular_case(published, variant):
    for case in regular_cases(published):
        recovered = features_to_joints(published[f"{case}/features{variant}"])
        np.testing.assert_allclose(recovered, published[f"{case}/recovered{variant}"], atol=1e-5)


def test_retargeting_and_placing_are_matched(published):
    for case in regular_cases(published):
        retargeted = uniform_skeleton(published[f"{case}/joints"])
        np.testing.assert_allclose(retargeted, published[f"{case}/retargeted"], atol=1e-5)
        # The published heading is a float32 quaternion, near 180 degrees a poor one.
        np.testing.assert_allclose(canonical(retargeted), published[f"{case}/canonical"], atol=5e-5)


def test_the_published_sample_clip_is_recovered(published):
    recovered = features_to_joints(published["h3d_012314/published_features"])
    np.testing.assert_allclose(recovered, published["h3d_012314/published_joints"], atol=1e-6)


def test_a_batch_is_recovered(published):
    recovered = features_to_joints(published["batch3/features"])
    np.testing.assert_allclose(recovered, published["batch3/recovered"], atol=1e-5)


def test_a_mirrored_motion_is_matched(excerpt):
    case = "mirror_walk_turn_left_090"
    mirrored = Motion(excerpt[f"{case}/joints"]).mirror().joints
    assert_features_close(joints_to_features(mirrored)[excerpt[f"{case}/rows"]], excerpt[f"{case}/features"])


@pytest.mark.parametrize("variant", VARIANTS)
def test_three_frames_are_computed_right_where_published_code_crosses_the_wrong_axis(excerpt, variant):
    features = joints_to_features(excerpt["BUGGY_three_frames/joints"], retarget=VARIANTS[variant])
    assert_features_close(features, excerpt[f"BUGGY_three_frames/features{variant}_fixed"])


def test_exactly_opposite_bones_are_finite_and_all_else_matches(excerpt):
    case = "DEGENERATE_cartwheel_antiparallel"
    wanted = excerpt[f"{case}/features_noretarget"]
    features = joints_to_features(excerpt[f"{case}/joints"], retarget=False)
    assert np.isfinite(features).all()
    features = features[excerpt[f"{case}/rows"]]
    known = np.isfinite(wanted)
    assert 0 < (~known).sum() < 20
    assert_features_close(np.where(known, features, 0), np.where(known, wanted, 0))


@pytest.mark.parametrize("variant", VARIANTS)
def test_facing_exactly_backwards_is_facing_any_other_way(excerpt, variant):
    joints = excerpt["DEGENERATE_facing_180_exact/joints"].astype(np.float64)
    features = joints_to_features(joints, retarget=VARIANTS[variant])
    ahead = joints_to_features(joints * [-1, 1, -1], retarget=VARIANTS[variant])
    assert_features_close(features, ahead)


# Properties


@given(angle=st.floats(-np.pi, np.pi), x=st.floats(-50, 50), y=st.floats(-5, 5), z=st.floats(-50, 50))
@settings(max_examples=40, deadline=None)
def test_features_do_not_change_when_the_input_is_turned_or_moved(walk, angle, x, y, z):
    assert_features_close(joints_to_features(turned(walk, angle) + np.array([x, y, z])), joints_to_features(walk))


@given(scale=st.floats(0.1, 10))
@settings(max_examples=20, deadline=None)
def test_retargeted_features_do_not_change_with_body_size(walk, scale):
    assert_features_close(joints_to_features(walk * scale), joints_to_features(walk))


def test_many_motions_at_once_are_each_alone(walk):
    batch = np.stack([walk, turned(walk, 1.0) * 1.3, walk[::-1]]).reshape(3, 1, *walk.shape)
    features = joints_to_features(batch)
    assert features.shape == (3, 1, len(walk) - 1, SIZE)
    for motion, alone in zip(batch, features, strict=True):
        np.testing.assert_array_equal(joints_to_features(motion[0]), alone[0])
    np.testing.assert_allclose(features_to_joints(features)[2, 0], features_to_joints(features[2, 0]), atol=1e-6)


def test_the_way_to_features_and_back_is_the_motion_in_its_place(walk):
    recovered = features_to_joints(joints_to_features(walk))
    np.testing.assert_allclose(recovered, canonical(uniform_skeleton(walk))[:-1], atol=0.02)


def test_retargeting_gives_the_target_bones(walk):
    joints = uniform_skeleton(walk)
    lengths = np.linalg.norm(joints[:, 1:] - joints[:, PARENTS[1:]], axis=-1)
    np.testing.assert_allclose(lengths, np.broadcast_to(BONE_LENGTHS[1:], lengths.shape), atol=1e-6)


@given(joints=arrays(np.float32, (4, 22, 3), elements=st.sampled_from([0.0, 1.0, -1.0, 2.0**-100, 1e6, 0.375])))
@settings(max_examples=60, deadline=None)
def test_finite_joints_never_give_a_nan(joints):
    for retarget in (True, False):
        features = joints_to_features(joints, retarget=retarget)
        assert np.isfinite(features).all()
        assert np.isfinite(features_to_joints(features)).all()


def test_the_input_is_left_alone(walk):
    before = walk.copy()
    features = joints_to_features(walk, retarget=False)
    kept = features.copy()
    features_to_joints(features)
    np.testing.assert_array_equal(walk, before)
    np.testing.assert_array_equal(features, kept)


@pytest.mark.parametrize("shape", [(1, 22, 3), (5, 21, 3), (22, 3), (5, 22, 2)])
def test_wrong_joints_are_refused(shape):
    with pytest.raises(ValueError, match="must be"):
        joints_to_features(np.zeros(shape))


@pytest.mark.parametrize("shape", [(5, 262), (263,)])
def test_wrong_features_are_refused(shape):
    with pytest.raises(ValueError, match="must be"):
        features_to_joints(np.zeros(shape))


def test_the_kind_takes_any_rate_and_a_single_frame(walk):
    kind = FEATURE_KINDS["humanml3d"]
    assert kind.compute(Motion(walk, 40)).shape == ((len(walk) - 1) // 2, kind.size)
    assert kind.compute(Motion(walk[:1])).shape == (1, kind.size)
