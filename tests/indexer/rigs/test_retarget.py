"""Any rig, any dialect: the same movement is the same Motion."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from encoders.errors import UnreadableMotion
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS, PARENTS
from indexer.formats.numpy_files.array_layouts import SMPL
from indexer.ingest.load import load_motion
from indexer.rigs.retarget import retarget
from indexer.take import Take
from tests.indexer.example_rigs import RIGS, standing, tree
from tests.indexer.performances import MIRRORED, Z_UP, Performance, bvh, performance

ORDERS = ["".join(order) for order in permutations("XYZ")]
LIKE_BANDAI = ["bandai", "collar and joint names", "maya advanced skeleton", "source engine", "spanish"]


def load(folder: Path, text: str, **options: float) -> Motion:
    path = folder / "take.bvh"
    path.write_text(text, newline="", encoding="utf-8")
    return load_motion(path, **options)


def difference(a: Motion, b: Motion) -> float:
    assert len(a) == len(b)
    return float(np.abs(a.joints - b.joints).max())


@settings(max_examples=12, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    rig=st.sampled_from(LIKE_BANDAI),
    order=st.sampled_from(ORDERS),
    root_order=st.sampled_from(ORDERS),
    unit=st.sampled_from([1.0, 100.0, 39.37, 1000.0, 17.7]),
    z_up=st.booleans(),
    separator=st.sampled_from([" ", "\t", ", "]),
    newline=st.sampled_from(["\n", "\r\n"]),
    positions_last=st.booleans(),
)
def test_names_orders_units_and_axes_do_not_matter(
    tmp_path: Path, rig: str, z_up: bool, **dialect: str | float | bool
) -> None:
    acted = performance(frames=12)
    plain = load(tmp_path, bvh(acted))
    named = replace(acted, names=tree(RIGS[rig])[0])
    other = load(tmp_path, bvh(named.transformed(Z_UP) if z_up else named, **dialect))  # type: ignore[arg-type]
    assert difference(plain, other) < 2e-3


def test_a_file_of_the_other_hand_is_put_right(tmp_path: Path) -> None:
    acted = performance()
    assert difference(load(tmp_path, bvh(acted)), load(tmp_path, bvh(acted.transformed(MIRRORED)))) < 2e-3


def test_left_stays_left(tmp_path: Path) -> None:
    first = load(tmp_path, bvh(performance())).joints[0]
    assert first[INDEX["left_hip"], 0] > first[INDEX["right_hip"], 0]
    assert first[INDEX["left_foot"], 2] > first[INDEX["left_ankle"], 2]


def test_bones_have_the_target_lengths(tmp_path: Path) -> None:
    joints = load(tmp_path, bvh(performance("mixamo"))).joints
    lengths = np.linalg.norm(joints[:, 1:] - joints[:, PARENTS[1:]], axis=-1)
    np.testing.assert_allclose(lengths, np.broadcast_to(BONE_LENGTHS[1:], lengths.shape), atol=1e-5)


def test_the_lowest_joint_is_on_the_floor(tmp_path: Path) -> None:
    acted = performance()
    high = replace(acted, root=acted.root + np.array([0, 3.0, 0]))
    assert load(tmp_path, bvh(high)).joints[..., 1].min() == pytest.approx(0, abs=1e-6)


def test_a_rest_pose_before_the_movement_is_dropped(tmp_path: Path) -> None:
    acted = performance()
    assert difference(load(tmp_path, bvh(acted)), load(tmp_path, bvh(acted.after_rest_pose()))) < 2e-3


def test_every_rate_becomes_20_on_the_true_time_grid(tmp_path: Path) -> None:
    acted = performance(frames=121, fps=120.0)
    fast = load(tmp_path, bvh(acted))
    assert len(fast) == 21
    assert fast.fps == 20
    assert difference(fast, load(tmp_path, bvh(acted.every(2)))) < 2e-3
    assert difference(fast, load(tmp_path, bvh(acted.every(4)))) < 2e-2  # 30 fps: between frames


def test_the_given_rate_wins_over_the_file(tmp_path: Path) -> None:
    text = bvh(performance(frames=60, fps=60.0))
    assert len(load(tmp_path, text)) == 20
    assert len(load(tmp_path, text, fps=20)) == 60


def test_who_lies_all_the_time_still_lies(tmp_path: Path) -> None:
    acted = performance()
    turned = acted.rotations.copy()
    turned[:, 0] = Rotation.from_euler("x", -85, degrees=True).as_matrix()
    joints = load(tmp_path, bvh(replace(acted, rotations=turned, root=acted.root * 0 + [1, 0.4, 5]))).joints
    trunk = joints[:, INDEX["head"]] - joints[:, INDEX["pelvis"]]
    assert np.abs(trunk[:, 1]).max() < 0.5 * np.linalg.norm(trunk, axis=-1).min()


@pytest.mark.parametrize("rig", RIGS)
def test_a_standing_figure_of_any_rig_stands(rig: str) -> None:
    names, parents, _ = tree(RIGS[rig])
    figure = standing(RIGS[rig])
    take = Take(tuple(names), np.array(parents), figure, np.stack([figure, figure]), 30.0)
    pose = retarget(take, path="x.bvh").joints[0]
    where = {joint: pose[i] for joint, i in INDEX.items()}
    assert where["head"][1] > where["neck"][1] > where["pelvis"][1] > where["left_knee"][1] > where["left_foot"][1]
    assert where["left_wrist"][0] > where["left_elbow"][0] > 0.3
    assert where["right_wrist"][0] < where["right_elbow"][0] < -0.3
    assert where["left_foot"][2] > where["left_ankle"][2] + 0.08
    assert where["head"][1] == pytest.approx(1.5, abs=0.1)


def test_joints_that_already_are_the_22_keep_their_directions() -> None:
    rng = np.random.default_rng(0)
    source = Motion(_random_body(rng) * 1.3)
    motion = retarget(SMPL.take(source.joints.astype(np.float64), 20), path="x.npy")
    for child, parent in enumerate(PARENTS[1:], start=1):
        before = source.joints[:, child] - source.joints[:, parent]
        after = motion.joints[:, child] - motion.joints[:, parent]
        np.testing.assert_allclose(_unit(after), _unit(before), atol=1e-4)


def test_a_take_of_one_frame_is_a_motion(tmp_path: Path) -> None:
    assert len(load(tmp_path, bvh(performance(frames=1)))) == 1


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda acted: replace(acted, offsets=acted.offsets * 0), "same place"),
        (lambda acted: replace(acted, offsets=acted.offsets * 1e300), "same place|too large"),
    ],
)
def test_a_skeleton_without_a_shape_is_refused(tmp_path: Path, change: object, reason: str) -> None:
    with pytest.raises(UnreadableMotion, match=reason):
        load(tmp_path, bvh(change(performance())))  # type: ignore[operator]


def test_a_take_that_would_last_for_days_asks_for_its_rate() -> None:
    take = SMPL.take(np.broadcast_to(_random_body(np.random.default_rng(0))[:1], (100_000, 22, 3)), 0.1)
    with pytest.raises(UnreadableMotion, match="hours"):
        retarget(take, path="x.npy")


def _random_body(rng: np.random.Generator) -> np.ndarray:
    """An upright body (T, 22, 3) with disturbed bone directions."""
    take = Performance(*tree(RIGS["smpl"])[:2], np.zeros(1), np.zeros(1), np.zeros(1))
    figure = standing(RIGS["smpl"])[: len(take.names)]
    marks = tree(RIGS["smpl"])[2]
    places = {name.replace("toe", "foot"): figure[joint] for name, joint in marks.items()}
    places |= {"pelvis": figure[0], "spine1": figure[1], "spine2": figure[2], "spine3": figure[3]}
    body = np.stack([places[name] for name in JOINTS])
    return body + rng.normal(0, 0.01, (10, 22, 3))


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def test_a_t_pose_before_the_movement_is_dropped_where_no_rest_pose_is_known() -> None:
    """A file of joints: four frames of T-pose, then all limbs at once are elsewhere."""
    rng = np.random.default_rng(1)
    limbs = 0.25 * rng.normal(size=(1, 22, 3))
    limbs[:, [0, 1, 2]] = 0
    moving = np.concatenate([np.zeros(4), np.ones(8)])[:, None, None] * limbs
    assert len(retarget(SMPL.take(_random_body(rng)[:1] + moving, 20), path="x.npy")) == 8
