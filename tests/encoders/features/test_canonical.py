"""Body features: the same for the same movement, whatever the rig, the body, the heading, the place and the rate."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from encoders.features.canonical import LAYOUT, MIRROR_INDEX, MIRROR_SIGN, POINTS, SIZE, body_features
from encoders.features.registry import FEATURE_KINDS
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, PARENTS, RAW_OFFSETS

KIND = FEATURE_KINDS["body"]


def swing(name: str, t: np.ndarray) -> np.ndarray:
    """Angle of a joint's bone about the body's left axis, for a walk with swinging arms and a nodding head."""
    phase = np.sin(4.5 * t)
    angles = {
        "left_knee": -0.4 * phase,
        "right_knee": 0.4 * phase,
        "left_ankle": 0.3 - 0.2 * phase,
        "right_ankle": 0.3 + 0.2 * phase,
        "left_elbow": 0.5 * phase,
        "right_elbow": -0.3 * phase,
        "left_wrist": -0.4 + 0.3 * phase,
        "right_wrist": -0.9,
        "head": 0.3 * np.sin(3 * t),
    }
    return angles.get(name, np.zeros_like(t))


def walk(fps: float = 20.0, seconds: float = 4.0, lengths: np.ndarray = BONE_LENGTHS) -> np.ndarray:
    """A curved walk, made at any rate and with any bone lengths: joints (T, 22, 3)."""
    t = np.arange(round(seconds * fps) + 1) / fps
    heading = 0.5 * t
    joints = np.zeros((len(t), 22, 3))
    joints[:, 0] = np.stack([2 - 2 * np.cos(heading), 0.95 + 0.02 * np.sin(9 * t), 2 * np.sin(heading)], -1)
    for name, i in list(INDEX.items())[1:]:
        angle = swing(name, t)
        x, y, z = (
            RAW_OFFSETS[i]
            if name not in ("left_shoulder", "right_shoulder")
            else (np.sign(RAW_OFFSETS[i - 3][0]), 0, 0)
        )
        y, z = y * np.cos(angle) - z * np.sin(angle), y * np.sin(angle) + z * np.cos(angle)
        bone = np.stack(
            [x * np.cos(heading) + z * np.sin(heading), y + 0 * t, z * np.cos(heading) - x * np.sin(heading)], -1
        )
        joints[:, i] = joints[:, PARENTS[i]] + bone * lengths[i]
    return joints


def turned(joints, angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return joints @ np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])


def group(features, name):
    return features[..., LAYOUT[name]]


def test_the_groups_fill_the_features():
    assert [s.start for s in LAYOUT.values()] == [0, *[s.stop for s in LAYOUT.values()][:-1]]
    assert KIND.size == SIZE == list(LAYOUT.values())[-1].stop
    assert body_features(walk()).shape == (41, SIZE)
    assert body_features(walk()).dtype == np.float32


# What must not matter


@given(
    angle=st.floats(-np.pi, np.pi),
    x=st.floats(-20, 20),
    y=st.floats(-5, 5),
    z=st.floats(-20, 20),
    scale=st.floats(0.05, 200),
)
@settings(max_examples=50, deadline=None)
def test_heading_place_and_size_do_not_matter(angle, x, y, z, scale):
    moved = (turned(walk(), angle) + np.array([x, y, z])) * scale
    np.testing.assert_allclose(body_features(moved), body_features(walk()), atol=2e-3)


@given(factors=st.lists(st.floats(0.6, 1.6), min_size=5, max_size=5))
@settings(max_examples=30, deadline=None)
def test_the_length_of_limbs_does_not_matter(factors):
    lengths = BONE_LENGTHS.copy()
    for factor, bone in zip(factors, ("elbow", "wrist", "ankle", "knee", "foot"), strict=True):
        for side in ("left", "right"):
            lengths[INDEX[f"{side}_{bone}"]] *= factor
    features, wanted = body_features(walk(lengths=lengths)), body_features(walk())
    # Scaling by the legs scales the root's way and height with them; what the limbs do stays.
    for name in ("positions", "velocities", "trunk_up", "pelvis_forward", "chest_forward", "yaw_rate"):
        np.testing.assert_allclose(group(features, name), group(wanted, name), atol=1e-4)


@given(
    hips=st.floats(-0.04, 0.08), shoulders=st.floats(-0.05, 0.05), slope=st.floats(-0.06, 0.06), neck=st.floats(0, 0.1)
)
@settings(max_examples=30, deadline=None)
def test_hip_width_shoulder_width_slope_and_neck_do_not_matter(hips, shoulders, slope, neck):
    joints = walk()
    across = joints[:, INDEX["left_hip"]] - joints[:, INDEX["right_hip"]]
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    changed = joints.copy()
    for side, sign in (("left", 1), ("right", -1)):
        leg = [INDEX[f"{side}_{name}"] for name in ("hip", "knee", "ankle", "foot")]
        arm = [INDEX[f"{side}_{name}"] for name in ("shoulder", "elbow", "wrist")]
        changed[:, leg] += sign * hips * across[:, None]
        changed[:, arm] += sign * shoulders * across[:, None] + np.array([0, slope, 0])
    changed[:, INDEX["neck"]] += neck
    features, wanted = body_features(changed), body_features(joints)
    np.testing.assert_allclose(group(features, "positions"), group(wanted, "positions"), atol=0.02)
    np.testing.assert_allclose(features, wanted, atol=0.1)


@given(pitch=st.floats(-0.5, 0.5))
@settings(max_examples=20, deadline=None)
def test_where_a_rig_puts_the_head_does_not_matter(pitch):
    lengths = np.where(np.arange(22) == INDEX["head"], 0.0, BONE_LENGTHS)
    forward = np.stack([np.sin(0.1 * np.arange(81) / 4), np.zeros(81), np.cos(0.1 * np.arange(81) / 4)], -1)
    heads = []
    for tilt in (0.0, pitch):
        joints = walk(lengths=lengths)
        joints[:, INDEX["head"]] += 0.1 * (np.cos(tilt) * np.array([0, 1, 0]) + np.sin(tilt) * forward)
        heads.append(group(body_features(joints), "positions")[:, :3])
    np.testing.assert_allclose(heads[0], heads[1], atol=0.01)


@pytest.mark.parametrize("fps", [20, 24, 25, 29.97, 30, 50, 59.94, 60, 100, 120, 240])
def test_the_rate_of_the_file_does_not_matter(fps):
    features = KIND.compute(Motion(walk(fps), fps))
    wanted = KIND.compute(Motion(walk()))
    frames = min(len(features), len(wanted)) - 1  # the last frame's velocity may be one-sided
    assert frames >= 39
    difference = np.abs(features[:frames] - wanted[:frames])
    assert difference[:, LAYOUT["positions"]].max() < 0.01
    assert difference.max() < 0.12


# What must matter, with its sign


def test_the_body_faces_ahead_and_sides_are_kept():
    places = dict(zip(POINTS, group(body_features(walk()), "positions").reshape(-1, 13, 3).swapaxes(0, 1), strict=True))
    assert (places["left_shoulder"][:, 0] > 0.1).all()
    assert (places["right_knee"][:, 0] < -0.05).all()
    assert (places["left_foot"][:, 2] > places["left_ankle"][:, 2]).all()
    assert (places["head"][:, 1] > 0.6).all()
    np.testing.assert_allclose(group(body_features(walk()), "chest_forward")[3:-3], [[0, 0, 1]] * 35, atol=0.02)


def test_speed_and_turning_are_metres_and_radians_a_second():
    features = body_features(walk())
    np.testing.assert_allclose(group(features, "root_velocity")[1:-1, 2], 1.0, atol=0.05)
    np.testing.assert_allclose(group(features, "yaw_rate")[2:-2], 0.5, atol=0.02)
    np.testing.assert_allclose(group(body_features(walk()[::-1]), "root_velocity")[1:-1, 2], -1.0, atol=0.05)


def test_height_is_above_the_lowest_point():
    standing = np.repeat(walk()[:1], 40, axis=0)
    jumping = standing.copy()
    jumping[20:30, :, 1] += 0.5
    height = group(body_features(jumping), "height")[:, 0]
    np.testing.assert_allclose(height[12] - height[0], 0.5, atol=0.02)
    assert 0.7 < height[0] < 1.0


def test_standing_feet_touch_the_ground_and_moving_or_lifted_feet_do_not():
    standing = np.repeat(walk()[:1], 40, axis=0)
    lifted = standing.copy()
    lifted[20:30, :, 1] += 0.5
    contacts = group(body_features(lifted), "contacts")
    assert (contacts[:8] > 0.5).all()
    assert (contacts[11:14] < 0.1).all()
    sliding = standing + np.arange(40)[:, None, None] * [0, 0, 0.1]
    assert (group(body_features(sliding), "contacts") < 0.1).all()


def test_mirroring_a_motion_permutes_its_features():
    motion = Motion(walk() + np.random.default_rng(0).normal(0, 0.02, (81, 22, 3)))
    mirrored = KIND.compute(motion)[:, MIRROR_INDEX] * MIRROR_SIGN
    np.testing.assert_allclose(KIND.compute(motion.mirror()), mirrored, atol=1e-4)
    np.testing.assert_array_equal(MIRROR_INDEX[MIRROR_INDEX], np.arange(SIZE))
    assert (MIRROR_SIGN < 0).sum() == 2 * 13 + 5


# Whatever comes in


def test_many_motions_at_once_are_each_alone():
    batch = np.stack([walk(), turned(walk(), 1.0)[::-1], walk() * [1, 1, 1.2]])[:, None]
    features = body_features(batch)
    assert features.shape == (3, 1, 41, SIZE)
    for motion, together in zip(batch, features, strict=True):
        np.testing.assert_allclose(body_features(motion[0]), together[0], atol=1e-5)


@pytest.mark.parametrize(("frames", "rows"), [(1, 1), (2, 1), (3, 2), (4, 2), (100, 50)])
def test_every_second_frame_counts(frames, rows):
    features = body_features(np.repeat(walk()[:1], frames, axis=0))
    assert features.shape == (rows, SIZE)
    assert np.isfinite(features).all()


@given(
    frames=st.integers(1, 5),
    data=st.data(),
    scale=st.sampled_from([0.0, 1e-30, 1e-6, 1.0, 1e6, 1e30]),
)
@settings(max_examples=80, deadline=None)
def test_finite_joints_never_give_a_nan(frames, data, scale):
    elements = st.sampled_from(np.array([0, 1, -1, 0.37, 1e-4], np.float32).tolist())
    joints = data.draw(arrays(np.float32, (frames, 22, 3), elements=elements)) * np.float32(scale)
    with np.errstate(all="raise", under="ignore"):
        assert np.isfinite(body_features(joints)).all()


def test_lying_on_a_side_and_standing_on_hands_have_a_heading():
    for roll in (np.pi / 2, np.pi, -np.pi / 2):
        cosine, sine = np.cos(roll), np.sin(roll)
        joints = (walk() - walk()[:, :1]) @ np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
        features, again = body_features(joints), body_features(turned(joints, 2.0))
        np.testing.assert_allclose(features, again, atol=1e-3)
        assert np.abs(group(features, "yaw_rate")).max() < 2


def test_the_input_is_left_alone():
    joints = walk().astype(np.float32)
    before = joints.copy()
    body_features(joints)
    np.testing.assert_array_equal(joints, before)


def test_many_motions_have_the_features_of_each():
    motions = [Motion(walk(fps, seconds), fps) for fps, seconds in ((20, 2), (30, 4), (20, 4), (120, 1.5), (20, 2))]
    assert KIND.compute_many is not None
    for many, one in zip(KIND.compute_many(motions), map(KIND.compute, motions), strict=True):
        np.testing.assert_array_equal(many, one)
    assert KIND.compute_many([]) == []
