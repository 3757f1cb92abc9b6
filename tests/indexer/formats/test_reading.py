"""The registry of readers: content decides, then the ending; every failure has its reason."""

from __future__ import annotations

import os
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.table import READABLE, Format
from indexer.ingest.file_parts import read_take
from indexer.ingest.load import load_motion
from tests.indexer.performances import bvh, performance


def reason(path: Path) -> str:
    with pytest.raises(UnreadableMotion) as error:
        read_take(path)
    assert str(path) in str(error.value)
    return error.value.reason


@pytest.mark.parametrize("row", READABLE.values(), ids=list(READABLE))
def test_every_format_names_a_module_that_reads(row: Format) -> None:
    assert callable(import_module(f"indexer.formats.{row.module}").read)


def test_content_decides_before_the_ending(tmp_path: Path) -> None:
    path = tmp_path / "take.npy"
    path.write_text(bvh(performance(frames=2)))
    assert len(read_take(path).positions) == 2


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.bvh", b"", "empty"),
        ("a.bvh", b" \n\n", "empty"),
        ("a.fbx", b"Kaydara FBX Binary  \x00\x1a\x00", "FBX cannot be read: its header"),
        ("a.glb", b"glTF\x02\x00\x00\x00", "the GLB is cut short"),
        ("a.c3d", b"\x02P\x00\x00", "C3D cannot be read"),
        ("a.zip", b"PK\x03\x04", "damaged or no ZIP"),
        ("a.bvh", bytes(range(256)), "cannot be read"),
        ("a.txt", b"hello", "cannot be read"),
        ("a.bvh", b"hello", "MOTION|HIERARCHY"),
        ("a.amc", b"hello", "frame, its number"),
        ("a.npy", b"hello", "cannot be read|NumPy"),
    ],
)
def test_what_cannot_be_read_says_what_can(tmp_path: Path, name: str, data: bytes, message: str) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    found = reason(path)
    assert re.search(message, found)
    if "this kind of file cannot be read" in found:
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
