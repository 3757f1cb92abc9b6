"""The registry of readers: content decides, then the ending; every failure has its reason."""

from __future__ import annotations

import io
import os
import re
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS
from indexer import load_motion
from indexer.readers import READABLE, read_take
from tests.indexer.acting import bvh, performance


def saved(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def reason(path: Path) -> str:
    with pytest.raises(UnreadableMotion) as error:
        read_take(path)
    assert str(path) in str(error.value)
    return error.value.reason


def test_content_decides_before_the_ending(tmp_path: Path) -> None:
    path = tmp_path / "take.npy"
    path.write_text(bvh(performance(frames=2)))
    assert len(read_take(path).positions) == 2


@pytest.mark.parametrize("count", [22, 24, 52])
def test_arrays_of_joints(tmp_path: Path, count: int) -> None:
    joints = np.random.default_rng(0).normal(size=(5, count, 3)).astype(np.float32)
    path = tmp_path / "a.npy"
    path.write_bytes(saved(joints))
    take = read_take(path)
    assert take.names == JOINTS
    assert take.fps == 20
    np.testing.assert_array_equal(take.positions, joints[:, :22])


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (saved(np.zeros((5, 21, 3))), "shape"),
        (saved(np.zeros((0, 22, 3))), "shape"),
        (saved(np.zeros(7)), "shape"),
        (saved(np.full((5, 22, 3), np.nan)), "frame 1"),
        (saved(np.zeros((5, 22, 3), complex)), "complex"),
        (saved(np.array([{"a": 1}], dtype=object)), "object"),
        (saved(np.zeros((5, 22, 3)))[:-8], "cut short"),
        (saved(np.zeros((5, 22, 3))).replace(b"(5, 22, 3)", b"(5000000000, 22, 3)")[:200], "cut short|damaged"),
        (b"\x93NUMPY\x01\x00\xff\xffrubbish", "damaged"),
        (b"\x93NUMPY\x09\x09", "damaged"),
    ],
)
def test_arrays_that_are_no_motion(tmp_path: Path, data: bytes, said: str) -> None:
    path = tmp_path / "a.npy"
    path.write_bytes(data)
    assert re.search(said, reason(path))


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.bvh", b"", "empty"),
        ("a.bvh", b" \n\n", "empty"),
        ("a.fbx", b"Kaydara FBX Binary  \x00\x1a\x00", "FBX cannot be read"),
        ("a.glb", b"glTF\x02\x00\x00\x00", "glTF cannot be read"),
        ("a.c3d", b"\x02P\x00\x00", "C3D cannot be read"),
        ("a.bvh", bytes(range(256)), "cannot be read"),
        ("a.txt", b"hello", "cannot be read"),
        ("a.bvh", b"hello", "MOTION|HIERARCHY"),
        ("a.amc", b"hello", "frames|frame number"),
        ("a.npy", b"hello", "cannot be read|NumPy"),
    ],
)
def test_what_cannot_be_read_says_what_can(tmp_path: Path, name: str, data: bytes, said: str) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    found = reason(path)
    assert re.search(said, found)
    if "cannot be read" in found:
        assert all(ending in found for ending in READABLE)


def test_no_such_file(tmp_path: Path) -> None:
    assert "No such file" in reason(tmp_path / "nothing.bvh")


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    assert "folder" in reason(tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.bvh")
    assert "regular" in reason(tmp_path / "a.bvh")


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="may read everything")
def test_no_permission(tmp_path: Path) -> None:
    path = tmp_path / "a.bvh"
    path.write_text("x")
    path.chmod(0)
    assert "ermission" in reason(path)


@pytest.mark.parametrize("fps", [0, -1, float("nan"), float("inf")])
def test_a_rate_that_is_none_is_refused(tmp_path: Path, fps: float) -> None:
    path = tmp_path / "take.bvh"
    path.write_text(bvh(performance(frames=2)))
    with pytest.raises(UnreadableMotion, match="frame rate"):
        read_take(path, fps=fps)


def test_features_become_the_joints_they_describe(tmp_path: Path, golden: Path) -> None:
    cases = np.load(golden / "humanml3d_features.npz")
    np.save(tmp_path / "a.npy", cases["walk_forward/features"])
    joints = read_take(tmp_path / "a.npy").positions
    np.testing.assert_allclose(joints, cases["walk_forward/recovered"], atol=1e-5)
    assert len(load_motion(tmp_path / "a.npy")) == len(joints)


@pytest.mark.slow
def test_all_real_files_are_read_or_rightly_refused(mocap: Path) -> None:
    refused = []
    for path in sorted(mocap.glob("rigs/**/*")):
        if path.suffix in READABLE:
            try:
                load_motion(path)
            except UnreadableMotion:
                refused.append(path.name)
    assert sorted(refused) == ["arm.bvh", "arm.bvh", "leg.bvh", "sinusoidal.bvh", "sinusoidal_2.bvh"]
