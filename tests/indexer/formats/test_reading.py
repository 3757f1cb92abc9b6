"""The registry of readers: content decides, then the ending; every failure has its reason."""

from __future__ import annotations

import contextlib
import io
import os
import re
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS
from indexer.formats import npz
from indexer.formats.reading import read_take
from indexer.formats.table import READABLE
from indexer.ingest.load import load_motion
from tests.indexer.performances import bvh, performance


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
    ("data", "message"),
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
def test_arrays_that_are_no_motion(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "a.npy"
    path.write_bytes(data)
    assert re.search(message, reason(path))


def archived(packed: bool = True, **arrays: np.ndarray | float) -> bytes:
    stream = io.BytesIO()
    (np.savez_compressed if packed else np.savez)(stream, **arrays)
    return stream.getvalue()


@pytest.mark.parametrize("packed", [True, False])
@pytest.mark.parametrize(("more", "fps"), [({"fps": 30.0}, 30), ({"fps": np.array([30])}, 30), ({}, 20)])
def test_archives_of_joints_with_their_rate(tmp_path: Path, packed: bool, more: dict[str, float], fps: float) -> None:
    joints = np.random.default_rng(0).normal(size=(5, 22, 3)).astype(np.float32)
    path = tmp_path / "a.npz"
    path.write_bytes(archived(packed, joints=joints, unrelated=np.array(["x"]), **more))
    take = read_take(path)
    assert (take.names, take.fps) == (JOINTS, fps)
    np.testing.assert_array_equal(take.positions, joints)
    assert read_take(path, fps=60).fps == 60


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (archived(poses=np.zeros((5, 156)), trans=np.zeros((5, 3))), "no array 'joints'.*but poses, trans"),
        (archived(joints=np.zeros((5, 21, 3))), "shape"),
        (archived(joints=np.array([{"a": 1}], dtype=object)), "object"),
        (archived(joints=np.zeros((5, 22, 3)), fps=np.array([{}], dtype=object)), "object"),
        (archived(joints=np.zeros((5, 22, 3)), fps=np.zeros(2)), "no number"),
        (archived(joints=np.zeros((5, 22, 3)), fps=-3.0), "no frame rate"),
        (archived(joints=np.zeros((5, 22, 3)), fps=np.nan), "no frame rate"),
        (archived(joints=np.zeros((5, 22, 3)))[:-30], "damaged"),
        (archived(False, joints=np.ones((5, 22, 3))).replace(b"\xf0?", b"\xf1?", 1), "damaged"),
        (b"PK\x03\x04rubbish", "damaged"),
        (archived(joints=np.zeros((1000, 22, 3))), "larger than"),
    ],
)
def test_archives_that_are_no_motion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, message: str
) -> None:
    monkeypatch.setattr(npz, "MAX_BYTES", 100_000)
    path = tmp_path / "a.npz"
    path.write_bytes(data)
    assert re.search(message, reason(path))


@pytest.mark.parametrize("seed", range(40))
def test_a_damaged_archive_is_refused_or_read(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    data = bytearray(archived(joints=rng.normal(size=(5, 22, 3)), fps=30.0))
    for place in rng.integers(len(data), size=3):
        data[place] = rng.integers(256)
    path = tmp_path / "a.npz"
    path.write_bytes(data)
    with contextlib.suppress(UnreadableMotion):
        read_take(path)


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.bvh", b"", "empty"),
        ("a.bvh", b" \n\n", "empty"),
        ("a.fbx", b"Kaydara FBX Binary  \x00\x1a\x00", "FBX cannot be read; export it as BVH"),
        ("a.glb", b"glTF\x02\x00\x00\x00", "glTF cannot be read"),
        ("a.c3d", b"\x02P\x00\x00", "C3D cannot be read"),
        ("a.zip", b"PK\x03\x04", "ZIP cannot be read"),
        ("a.bvh", bytes(range(256)), "cannot be read"),
        ("a.txt", b"hello", "cannot be read"),
        ("a.bvh", b"hello", "MOTION|HIERARCHY"),
        ("a.amc", b"hello", "frames|frame number"),
        ("a.npy", b"hello", "cannot be read|NumPy"),
    ],
)
def test_what_cannot_be_read_says_what_can(tmp_path: Path, name: str, data: bytes, message: str) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    found = reason(path)
    assert re.search(message, found)
    if "cannot be read" in found and "BVH" not in found:
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
