"""The table of formats: what it decides about files by their content and their ending."""

import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.table import FORMATS, READABLE, UNSUPPORTED, detect, is_motion


@pytest.mark.parametrize(
    ("name", "data", "ending"),
    [
        ("a.bvh", b"HIERARCHY\nROOT hips", ".bvh"),
        ("a.txt", b"\xef\xbb\xbf  Hierarchy\n", ".bvh"),
        ("a.bvh", b"# comment first\n", ".bvh"),
        ("a.bvh", b"#!OML\n:FULLY-SPECIFIED\n:DEGREES\n1\n", ".amc"),
        ("a.amc", b"1\nroot 0 0 0\n", ".amc"),
        ("a.bin", b"\x93NUMPY\x01\x00", ".npy"),
        ("a.NPZ", b"PK\x03\x04", ".npz"),
    ],
)
def test_the_content_decides_then_the_ending(name, data, ending):
    assert detect(name, data).ending == ending


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.zip", b"PK\x03\x04", "ZIP cannot be read"),
        ("a.bvh", b"; FBX 7.4.0 project file", "FBX cannot be read; export it as BVH"),
        ("a.usdz", b"PK\x03\x04", "USD cannot be read; export it as BVH"),
        ("a.abc", b"Ogawa\xff\x00", "Alembic cannot be read; what can be: .bvh, .amc"),
        ("a.asf", b":version 1.10\n:units\n:bonedata\n", "a skeleton without motion; read the .amc files"),
        ("a.xyz", b"\x00\x01", "this kind of file cannot be read"),
    ],
)
def test_what_cannot_be_read_is_named(name, data, reason):
    with pytest.raises(UnreadableMotion, match=reason):
        detect(name, data)


def test_each_ending_has_one_row():
    endings = [row.ending for row in FORMATS] + [ending for row in UNSUPPORTED for ending in row.endings]
    assert len(endings) == len(set(endings))
    assert all(ending == ending.lower() and ending.startswith(".") for ending in endings)


def test_frame_rates_of_formats_that_state_none():
    assert {row.ending: row.default_fps for row in FORMATS if not row.states_fps} == {".amc": 120.0, ".npy": 20.0}


def test_motions_that_cannot_be_read_are_motions_and_skeletons_are_none():
    assert all(is_motion(ending) for ending in (*READABLE, ".fbx", ".c3d", ".usdz"))
    assert not any(is_motion(ending) for ending in (".asf", ".csv", ".txt", ".zip", ""))
