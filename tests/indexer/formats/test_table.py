"""The table of formats: what it decides about files by their content and their ending."""

import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.refused import REFUSED
from indexer.formats.table import FORMATS, READABLE, detect, is_motion


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
        ("a.bvh", b"; FBX 7.4.0 project file", ".fbx"),
        ("a.bin", b"Kaydara FBX Binary  \x00\x1a\x00", ".fbx"),
        ("a.vrm", b"glTF\x02\0\0\0", ".glb"),
        ("a.gltf", b'\n{"asset": {}}', ".gltf"),
        ("a.usdz", b"PK\x03\x04", ".usdz"),
        ("a.usdc", b"#usda 1.0", ".usd"),
    ],
)
def test_the_content_decides_then_the_ending(name, data, ending):
    assert detect(name, data).ending == ending


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.zip", b"PK\x03\x04", "ZIP cannot be read; unpack it"),
        (
            "a.xml",
            b'<?xml version="1.0"?>\n<!-- a -->\n<COLLADA xmlns="">',
            "Collada cannot be read; convert it to glTF",
        ),
        ("a.xml", b'<?xml version="1.0"?><mvnx version="4">', "MVNX cannot be read; export BVH or FBX from Xsens MVN"),
        ("a.blend", b"(\xb5/\xfd", "Blender cannot be read; export glTF or BVH"),
        ("a.bin", b"BLENDER-v306", "Blender cannot be read"),
        ("a.ma", b"//Maya ASCII 2024 scene", "Maya cannot be read; export its skeleton as FBX"),
        ("a.bin", b"FOR8\0\0\0\0\0\0\x01\x12Maya", "Maya cannot be read"),
        ("a.c3d", b"\x02P\x00\x00", "C3D cannot be read; it holds markers and no skeleton: solve them"),
        ("a.txt", b"PathFileType\t4\t(X/Y/Z)\ta.trc", "TRC cannot be read; it holds markers"),
        ("a.txt", b"# made by x\n# y\n[Header]\nFileType htr", "HTR cannot be read; import it in MotionBuilder"),
        (
            "a.anim",
            b"%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n",
            "ANIM cannot be read; export the animated",
        ),
        ("a.bin", b"Vocaloid Motion Data 0002\0", "VMD cannot be read; import it in Blender"),
        ("a.max", b"\xd0\xcf\x11\xe0", "3ds Max cannot be read; export its skeleton as FBX"),
        ("a.tak", b"\0\1", "Motive TAK cannot be read; export its skeletons as BVH or FBX from Motive"),
        ("a.abc", b"Ogawa\xff\x00", "Alembic cannot be read; it holds surfaces and no skeleton"),
        ("a.pkl", b"\x80\x04", r"pickle cannot be read; to open one is to run .* numpy.savez\('a.npz', \*\*numpy.load"),
        ("a.asf", b":version 1.10\n:units\n:bonedata\n", "a skeleton without motion; read the .amc files"),
        ("a.xyz", b"\x00\x01", "this kind of file cannot be read; what can be: .bvh, .amc"),
        ("a.json", b"{}", "this kind of file cannot be read"),
        ("a.bvh", b"\x00\x01", "cannot be read as BVH; it may be damaged"),
        ("a.fbx", b"hello", "cannot be read as FBX; it may be damaged"),
    ],
)
def test_what_cannot_be_read_is_named(name, data, reason):
    with pytest.raises(UnreadableMotion, match=reason):
        detect(name, data)


def test_each_ending_has_one_row():
    endings = [row.ending for row in FORMATS] + [ending for row in REFUSED for ending in row.endings]
    assert len(endings) == len(set(endings))
    assert all(ending == ending.lower() and ending.startswith(".") for ending in endings)


def test_signatures_take_no_time_on_any_text():
    for part in (b"#", b"# ", b"#\n", b"<!-- --> ", b"<?", b"< ", b"for8", b" "):
        with pytest.raises(UnreadableMotion):
            detect("a", part * 5000)


def test_frame_rates_of_formats_that_state_none():
    assert {row.ending: row.default_fps for row in FORMATS if not row.states_fps} == {".amc": 120.0, ".npy": 20.0}


def test_motions_that_cannot_be_read_are_motions_and_skeletons_are_none():
    assert all(is_motion(ending) for ending in (*READABLE, ".fbx", ".c3d", ".usdz"))
    assert not any(is_motion(ending) for ending in (".asf", ".csv", ".txt", ".zip", ""))
