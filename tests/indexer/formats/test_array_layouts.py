"""Arrays of joints: axes and orders are told by shape and by bones that keep their length, or named as unknown."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from encoders.features.humanml3d import joints_to_features
from encoders.motion import Motion
from encoders.skeleton import JOINTS
from indexer.formats.numpy_files.array_layouts import KIT, takes_of
from indexer.rigs.retarget import retarget
from indexer.take import Take
from tests.indexer.bodies import KIT as KIT_ORDER
from tests.indexer.bodies import SOMA_30, SOMA_77, body, in_order


def one(array: np.ndarray, fps: float | None = None) -> Take:
    (take,) = takes_of("a.npy", array, fps)
    return take


def motion(take: Take) -> Motion:
    return retarget(take, path="a.npy")


@pytest.mark.parametrize("count", [22, 24, 45, 52, 55, 73, 127, 144])
def test_the_models_of_smpl_begin_with_the_joints_of_the_body(count: int) -> None:
    more = np.random.default_rng(0).normal(size=(40, count - 22, 3))
    take = one(np.concatenate([body(), more], axis=1))
    assert (take.names, take.fps, take.up, take.warnings) == (JOINTS, None, None, ())
    np.testing.assert_array_equal(take.positions, body())


@pytest.mark.parametrize("frames", [1, 3, 22, 24, 40])
def test_axes_stand_in_any_published_order(frames: int) -> None:
    joints = body(frames)
    np.testing.assert_array_equal(one(joints[None]).positions, joints)
    np.testing.assert_array_equal(one(joints.reshape(frames, 66)).positions, joints)
    if frames != 3:  # (22, 3, 3) may be rotations
        np.testing.assert_array_equal(one(joints.transpose(1, 2, 0)).positions, joints)
        np.testing.assert_array_equal(one(joints.transpose(1, 2, 0)[None]).positions, joints)


@pytest.mark.parametrize("axes", [(0, 1, 2, 3), (0, 2, 3, 1)])
def test_a_batch_is_several_takes_that_are_numbered(axes: tuple[int, ...]) -> None:
    batch = np.stack([body(seed=seed) for seed in range(3)])
    takes = takes_of("a.npy", batch.transpose(axes), 30)
    assert [(take.name, take.fps) for take in takes] == [("1", 30), ("2", 30), ("3", 30)]
    for take, joints in zip(takes, batch, strict=True):
        np.testing.assert_array_equal(take.positions, joints)


@pytest.mark.parametrize("mirror", [1, -1])
def test_kit_s_joints_have_their_own_order_and_rate_and_are_published_in_a_mirror(mirror: int) -> None:
    take = one(in_order(body(), KIT_ORDER) * (1000 * mirror, 1000, 1000))
    assert (take.names, take.fps) == (KIT.names, 12.5)
    assert off(motion(one(in_order(body(), KIT_ORDER), 20)), motion(one(body(), 20))) < 0.08
    assert off(motion(one(in_order(body(), KIT_ORDER) * (mirror, 1, 1), 20)), motion(one(body(), 20))) < 0.08


def off(motion: Motion, other: Motion) -> float:
    """The mean way between joints, metres, from the pelvis."""
    return float(
        np.linalg.norm((motion.joints - motion.joints[:, :1]) - (other.joints - other.joints[:, :1]), axis=-1).mean()
    )


@pytest.mark.parametrize("order", [SOMA_30, SOMA_77])
def test_the_joints_of_soma_are_found_among_fingers_and_face(order: list[str]) -> None:
    take = one(in_order(body(), order))
    assert take.fps == 30
    assert off(motion(one(in_order(body(), order), 20)), motion(one(body(), 20))) < 0.08


def test_of_several_orders_the_one_is_taken_whose_bones_keep_their_length() -> None:
    joints = body()
    padded = np.concatenate([joints, joints[:, :8]], axis=1)  # 30 joints that are not those of SOMA
    np.testing.assert_array_equal(one(padded).positions, joints)
    cut = one(joints[:, :21])  # 21 joints that are not those of KIT-ML
    np.testing.assert_array_equal(cut.positions[:, :21], joints[:, :21])
    assert "right wrist is missing" in cut.warnings[0]
    assert len(motion(cut)) == len(joints)


def test_joints_in_a_strange_order_are_read_as_their_number_says_with_a_warning() -> None:
    shuffled = body()[:, np.random.default_rng(0).permutation(22)]
    assert "22 joints in another order than SMPL's?" in one(shuffled).warnings[0]


@pytest.mark.parametrize(("count", "size"), [(22, 263), (21, 251)])
def test_features_become_joints_that_are_y_up_by_definition(count: int, size: int) -> None:
    features = joints_to_features(body(), retarget=False)
    if count == 21:  # as long as of the 22 joints without the last
        keep = [*range(4 + 60), *range(67, 67 + 120), *range(193, 193 + 63), *range(259, 263)]
        features = features[:, keep]
    take = one(features)
    assert (features.shape[1], take.positions.shape[1]) == (size, count)
    assert (take.up, take.up_is_certain) == ("y", True)
    expected = body()[:-1, :count]
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(take.positions[:, :21], axis=1), axis=-1),
        np.linalg.norm(np.diff(expected[:, :21], axis=1), axis=-1),
        atol=1e-4,
    )


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        ((7,), "is no motion"),
        ((263,), "means or deviations"),
        ((0, 22, 3), "empty"),
        ((9, 23, 3), "23 joints are of no known order"),
        ((9, 17, 3), "17 joints are of no known order"),
        ((9, 22, 4), "is no motion"),
        ((9, 22, 3, 3), "read from .npz"),
        ((22, 3, 3), "read from .npz"),
        ((9, 72), "72 numbers a frame are no joints.*poses and trans"),
        ((9, 135), "poses and trans"),
        ((9, 100), r"is no motion; it must be joints \(T, J, 3\)"),
        ((2, 2, 9, 22, 3), "is no motion"),
        ((20_000, 1, 22, 3), "more than 10000"),
    ],
)
def test_other_shapes_are_refused_by_what_they_are(shape: tuple[int, ...], reason: str) -> None:
    with pytest.raises(UnreadableMotion, match=reason):
        takes_of("a.npy", np.random.default_rng(0).normal(size=shape), None)
