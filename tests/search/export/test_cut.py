"""Cuts as files: read again, they are the same movement."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import QueryError
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, JOINTS, PARENTS, RAW_OFFSETS
from indexer.ingest.file_parts import read_take
from indexer.ingest.load import load_motion
from search.export import bvh_writer
from search.export.cut import write_cut
from search.source import MotionSource
from tests.search.conftest import made_motion


def _joints(path: Path) -> np.ndarray:
    """The 22 joints as a BVH of the 22-joint rig holds them, in metres."""
    take = read_take(path)
    return take.positions[:, [take.names.index(name) for name in JOINTS]] / 100


def _tumbling() -> Motion:
    """A figure whose limbs go everywhere while it turns over."""
    rng = np.random.default_rng(0)
    loose = np.cumsum(rng.normal(scale=0.15, size=(60, 22, 3)), axis=0)
    loose[:, [1, 2, 3, 12, 13, 14]] *= 0.1  # what the trunk carries stays nearly in place
    directions = RAW_OFFSETS + loose
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True) + 1e-9
    angle = np.linspace(0, 2 * np.pi, 60)
    over = np.zeros((60, 3, 3))
    over[:, 0, 0], over[:, 1, 1], over[:, 2, 2] = 1, np.cos(angle), np.cos(angle)
    over[:, 1, 2], over[:, 2, 1] = -np.sin(angle), np.sin(angle)
    joints = np.zeros((60, 22, 3))
    for joint in range(1, 22):
        joints[:, joint] = joints[:, PARENTS[joint]] + directions[:, joint] * BONE_LENGTHS[joint]
    return Motion(np.einsum("tab,tjb->tja", over, joints).astype(np.float32))


def test_the_22_joint_rig_gives_back_every_joint(tmp_path: Path) -> None:
    motion = _tumbling()
    write_cut(MotionSource.of_motion(motion), tmp_path / "x.bvh")
    assert np.abs(_joints(tmp_path / "x.bvh") - motion.joints).max() < 1e-4


def test_bones_that_point_straight_against_the_rest_pose(tmp_path: Path) -> None:
    motion = Motion(made_motion(1, 1).joints * np.array([1, -1, 1], np.float32))
    write_cut(MotionSource.of_motion(motion), tmp_path / "x.bvh")
    assert np.abs(_joints(tmp_path / "x.bvh") - motion.joints).max() < 1e-4


def test_a_cut_of_a_bvh_keeps_its_rig_its_rate_and_its_lines(tmp_path: Path) -> None:
    whole, part = tmp_path / "whole.bvh", tmp_path / "part.bvh"
    with whole.open("wb") as file:
        bvh_writer.write(file, made_motion(6, 3))
    frames, fps = write_cut(MotionSource.of_file(whole), part, 1.5, 4.0)
    assert (frames, fps) == (50, 20.0)
    lines = whole.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    assert part.read_text().splitlines()[-50:] == lines[first + 30 : first + 80]
    assert read_take(part).names == read_take(whole).names


def test_a_cut_of_a_real_bvh_reads_as_the_same_movement(mocap: Path, tmp_path: Path) -> None:
    source = MotionSource.of_file(mocap / "cmu/daz/11/11_01.bvh")
    write_cut(source, tmp_path / "cut.bvh", 1.0, 2.5)
    cut, whole = load_motion(tmp_path / "cut.bvh").joints, source.cut(1.0, 2.5).joints
    assert abs(len(cut) - len(whole)) <= 1
    count = min(len(cut), len(whole))
    moved = (cut[:count] - cut[0, 0]) - (whole[:count] - whole[0, 0])
    assert np.abs(moved).max() < 0.05  # the bind pose that calibrates the whole take is not in the cut


@pytest.mark.parametrize("ending", [".npy", ".npz"])
def test_arrays_hold_the_frames_of_the_cut(tmp_path: Path, ending: str) -> None:
    motion = made_motion(5, 2)
    write_cut(MotionSource.of_motion(motion), tmp_path / f"cut{ending}", 1.0, 2.0)
    loaded = np.load(tmp_path / f"cut{ending}")
    joints = loaded if ending == ".npy" else loaded["joints"]
    np.testing.assert_array_equal(joints, motion.joints[20:40])


@pytest.mark.parametrize("ending", [".npy", ".npz"])
def test_what_was_written_is_read_as_the_same_movement(tmp_path: Path, ending: str) -> None:
    motion = made_motion(5, 2)
    write_cut(MotionSource.of_motion(motion), tmp_path / f"cut{ending}")
    take = read_take(tmp_path / f"cut{ending}")
    assert (take.names, take.fps) == (JOINTS, motion.fps)
    np.testing.assert_array_equal(take.positions, motion.joints)
    assert len(load_motion(tmp_path / f"cut{ending}")) == len(motion)


def test_frames_that_share_lines_are_cut_as_well(tmp_path: Path) -> None:
    path = tmp_path / "one line.bvh"
    with path.open("wb") as file:
        bvh_writer.write(file, made_motion(2, 3))
    head, _, numbers = path.read_text().rpartition("Frame Time: 0.05\n")
    path.write_text(head + "Frame Time: 0.05\n" + " ".join(numbers.split()))
    assert write_cut(MotionSource.of_file(path), tmp_path / "cut.bvh", 0.5, 1.0) == (10, 20.0)
    whole, cut = read_take(path), read_take(tmp_path / "cut.bvh")
    assert cut.names == whole.names
    np.testing.assert_allclose(cut.positions, whole.positions[10:20], atol=0.01)  # centimetres


def test_a_cut_outside_the_motion_is_refused(tmp_path: Path) -> None:
    with pytest.raises(QueryError, match="outside"):
        write_cut(MotionSource.of_motion(made_motion(2, 0), "x"), tmp_path / "x.npy", 5, 6)
    assert list(tmp_path.iterdir()) == []
