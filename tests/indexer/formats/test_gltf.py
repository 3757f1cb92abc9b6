"""glTF: what exporters write comes out as the joints that were animated; what is damaged is refused by its reason."""

from __future__ import annotations

import contextlib
import json
import struct
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from encoders.errors import UnreadableMotion
from indexer.formats.gltf import gltf_container, gltf_reader
from indexer.formats.gltf.gltf_animation import Channel
from indexer.formats.reading import read_takes
from indexer.ingest.file_parts import read_take
from indexer.ingest.load import load_motion
from indexer.rigs.retarget import retarget
from indexer.take import Take
from tests.indexer.formats.gltf_files import Asset, asset_of, positions_of
from tests.indexer.performances import Performance, bvh, performance

DATA = Path(__file__).resolve().parents[2] / "data"
TOLERANCE = 1e-5  # metres, of a file that holds single precision

ACTED = performance("mixamo", frames=20, fps=30)


def read(data: bytes, folder: Path, name: str = "a.glb") -> list[Take]:
    path = folder / name
    path.write_bytes(data)
    return read_takes(path)


def joints_of(take: Take, acted: Performance) -> np.ndarray:
    """The positions of the performance's joints, in its order."""
    return take.positions[:, [take.names.index(name) for name in acted.names]]


def check(take: Take, acted: Performance, tolerance: float = TOLERANCE) -> None:
    np.testing.assert_allclose(joints_of(take, acted), positions_of(acted), atol=tolerance)


@pytest.mark.parametrize("with_skin", [True, False])
def test_joints_are_where_the_animation_puts_them(tmp_path: Path, with_skin: bool) -> None:
    (take,) = read(asset_of(ACTED, with_skin=with_skin).glb(), tmp_path)
    check(take, ACTED)
    assert (take.fps, take.up, take.name) == (30, "y", "")
    named = {name: take.names[parent] for name, parent in zip(take.names, take.parents, strict=True) if parent >= 0}
    for name, parent in zip(ACTED.names, ACTED.parents, strict=True):
        assert parent < 0 or named[name] == ACTED.names[parent]


def test_the_motion_is_that_of_the_same_movement_as_bvh(tmp_path: Path) -> None:
    (tmp_path / "a.bvh").write_text(bvh(ACTED))
    (take,) = read(asset_of(ACTED).glb(), tmp_path)
    motion = retarget(take, path="a.glb")
    np.testing.assert_allclose(motion.joints, load_motion(tmp_path / "a.bvh").joints[: len(motion)], atol=1e-4)


@pytest.mark.parametrize("uri", [None, "a b.bin", "a%20b.bin", "./a b.bin", "buffers/a.bin"])
def test_a_buffer_may_be_inline_or_beside(tmp_path: Path, uri: str | None) -> None:
    asset = asset_of(ACTED)
    (tmp_path / "buffers").mkdir()
    for name in ("a b.bin", "buffers/a.bin"):
        (tmp_path / name).write_bytes(asset.data)
    check(read(asset.gltf(uri), tmp_path, "a.gltf")[0], ACTED)


@pytest.mark.parametrize("start", [b"\xff\xfe", b"\x1f\x8b", b"a\0b\0c\0d\0e\0f\0g\0h\0"])
def test_a_buffer_that_begins_like_something_else_is_taken_as_it_is(tmp_path: Path, start: bytes) -> None:
    asset = Asset()
    asset.view(start)
    one_joint(asset, "translation", np.arange(3) / 30, np.arange(9).reshape(3, 3))
    (tmp_path / "a.bin").write_bytes(asset.data)
    np.testing.assert_allclose(read(asset.gltf("a.bin"), tmp_path, "a.gltf")[0].positions[-1, 0], [6, 7, 8], atol=1e-4)


@pytest.mark.parametrize(
    "uri", ["../a.bin", "/etc/passwd", "C:/a.bin", "file:///a.bin", "%2e%2e/a.bin", "..\\a.bin", ""]
)
def test_a_buffer_elsewhere_is_not_read(tmp_path: Path, uri: str) -> None:
    (tmp_path / "a.bin").write_bytes(b"x" * 100_000)
    (tmp_path / "inner").mkdir()
    asset = asset_of(ACTED)
    asset.json["buffers"] = [{"byteLength": len(asset.data), "uri": uri}]
    with pytest.raises(UnreadableMotion, match="no file in the same folder"):
        read(json.dumps(asset.json).encode(), tmp_path / "inner", "a.gltf")


def test_a_missing_buffer_is_named(tmp_path: Path) -> None:
    with pytest.raises(UnreadableMotion, match=r"a\.gltf: its buffer 'a\.bin' cannot be read: No such file"):
        read(asset_of(ACTED).gltf("a.bin"), tmp_path, "a.gltf")


@pytest.mark.parametrize(("kind", "tolerance"), [("i2", 1e-4), ("i1", 0.02)])
def test_quaternions_of_small_integers(tmp_path: Path, kind: str, tolerance: float) -> None:
    check(read(asset_of(ACTED, rotations=kind).glb(), tmp_path)[0], ACTED, tolerance)


def one_joint(asset: Asset, path: str, times: Any, values: Any, interpolation: str = "LINEAR", **more: Any) -> bytes:
    """A joint with one child a metre above it, one property of it animated."""
    asset.json["nodes"] = [{"name": "joint", "children": [1]}, {"name": "child", "translation": [0, 1, 0]}]
    channel = (0, path, asset.accessor(times), asset.accessor(values, **more))
    asset.animate(None, [channel], interpolation)
    return asset.glb()


def test_strided_offset_and_sparse_accessors(tmp_path: Path) -> None:
    values = np.arange(12.0).reshape(4, 3)
    times = np.arange(4) / 30
    asset = Asset()
    strided = one_joint(asset, "translation", times, values, stride=20)
    np.testing.assert_allclose(read(strided, tmp_path)[0].positions[:, 0], values, atol=TOLERANCE)
    asset.json["accessors"][1].update(byteOffset=20, count=3)
    asset.json["accessors"][0].update(byteOffset=4, count=3)
    np.testing.assert_allclose(read(asset.glb(), tmp_path)[0].positions[-3:, 0], values[1:], atol=TOLERANCE)
    asset = Asset()
    one_joint(asset, "translation", times, np.zeros((4, 3)))
    sparse = {
        "count": 2,
        "indices": {"bufferView": asset.view(np.array([1, 3], "<u2").tobytes()), "componentType": 5123},
        "values": {"bufferView": asset.view(values[[1, 3]].astype("<f4").tobytes())},
    }
    asset.json["accessors"][1]["sparse"] = sparse
    expected = np.where(np.arange(4)[:, None] % 2, values, 0)
    np.testing.assert_allclose(read(asset.glb(), tmp_path)[0].positions[:, 0], expected, atol=TOLERANCE)
    del asset.json["accessors"][1]["bufferView"]  # all zeros, but for the sparse ones
    np.testing.assert_allclose(read(asset.glb(), tmp_path)[0].positions[:, 0], expected, atol=TOLERANCE)


def test_linear_turns_keep_their_speed() -> None:
    quaternions = Rotation.from_euler("z", [[0], [120]], degrees=True).as_quat()
    for sign in (1, -1):  # both quaternions are the same turn, and the way there is the shorter one
        channel = Channel(0, "rotation", np.array([0.0, 1]), quaternions * [[1], [sign]], "LINEAR")
        angles = Rotation.from_quat(channel.at(np.array([-1, 0, 0.25, 0.5, 1, 2]))).as_euler("zyx", degrees=True)[:, 0]
        np.testing.assert_allclose(angles, [0, 0, 30, 60, 120, 120], atol=1e-9)


def test_steps_wait_for_the_next_key() -> None:
    channel = Channel(0, "translation", np.array([0.0, 1, 2]), np.array([[0.0], [1], [2]]), "STEP")
    np.testing.assert_allclose(channel.at(np.array([0, 0.99, 1, 1.5, 2, 3]))[:, 0], [0, 0, 1, 1, 2, 2])


def test_splines_follow_their_tangents() -> None:
    """A cubic is its own Hermite spline, whatever its keys."""
    times = np.array([0.0, 0.5, 2.0])

    def curve(t: np.ndarray) -> np.ndarray:
        return (t**3 - 2 * t**2 + 3)[:, None]

    slopes = (3 * times**2 - 4 * times)[:, None]
    channel = Channel(0, "scale", times, np.stack([slopes, curve(times), slopes], axis=1), "CUBICSPLINE")
    at = np.linspace(0, 2, 30)
    np.testing.assert_allclose(channel.at(at), curve(at), atol=1e-12)


def test_turns_by_splines_are_turns() -> None:
    quaternions = Rotation.from_euler("z", [[0], [90]], degrees=True).as_quat()
    values = np.stack([np.zeros((2, 4)), quaternions, np.zeros((2, 4))], axis=1)
    channel = Channel(0, "rotation", np.array([0.0, 1]), values, "CUBICSPLINE")
    np.testing.assert_allclose(np.linalg.norm(channel.at(np.linspace(0, 1, 9)), axis=1), 1)


@pytest.mark.parametrize("fps", [24, 30, 60, 120])
@pytest.mark.parametrize("start", [0, 1])
def test_the_rate_is_that_of_the_keys(tmp_path: Path, fps: float, start: int) -> None:
    times = np.arange(start, 50 + start) / fps
    values = np.stack([times, 0 * times, 0 * times], axis=1)
    (take,) = read(one_joint(Asset(), "translation", times, values), tmp_path)
    assert (take.fps, len(take.positions)) == (fps, 50 + start)
    np.testing.assert_allclose(take.positions[start:, 0, 0], times, atol=1e-6)


def test_sparse_keys_are_sampled_at_30(tmp_path: Path) -> None:
    (take,) = read(one_joint(Asset(), "translation", [0, 2], [[0, 0, 0], [4, 0, 0]]), tmp_path)
    assert (take.fps, len(take.positions)) == (30, 61)
    np.testing.assert_allclose(take.positions[:, 0, 0], np.arange(61) / 15, atol=1e-6)


def test_a_late_first_key_is_where_the_movement_begins(tmp_path: Path) -> None:
    times = 100 + np.arange(31) / 30
    (take,) = read(one_joint(Asset(), "translation", times, np.zeros((31, 3))), tmp_path)
    assert len(take.positions) == 31


def test_a_rate_that_is_given_holds(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(asset_of(ACTED).glb())
    assert [(take.fps, len(take.positions)) for take in read_takes(path, fps=24)] == [(24, 20)]


def test_each_animation_is_a_take(tmp_path: Path) -> None:
    asset = asset_of(ACTED, name=None)
    first = asset.json["animations"][0]
    asset.json["animations"] += [{**first, "name": name} for name in ("Run/fast#1", "Run/fast#1", " \n ")]
    asset.json["animations"].append({"samplers": [], "channels": []})  # moves nothing, and is none
    takes = read(asset.glb(), tmp_path)
    assert [take.name for take in takes] == ["animation 1", "Run_fast_1", "Run_fast_1 (2)", "animation 4"]
    for take in takes:
        check(take, ACTED)
        np.testing.assert_array_equal(read_take(f"{tmp_path / 'a.glb'}#{take.name}").positions, take.positions)


def test_nodes_in_any_order(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    count = len(asset.json["nodes"])
    place = np.random.default_rng(0).permutation(count).tolist()
    asset.json["nodes"] = [asset.json["nodes"][place.index(i)] for i in range(count)]
    for node in asset.json["nodes"]:
        node["children"] = [place[child] for child in node.get("children", [])]
    for channel in asset.json["animations"][0]["channels"]:
        channel["target"]["node"] = place[channel["target"]["node"]]
    asset.json["skins"][0]["joints"] = [place[joint] for joint in asset.json["skins"][0]["joints"]]
    (take,) = read(asset.glb(), tmp_path)
    check(take, ACTED)
    assert all(parent < joint for joint, parent in enumerate(take.parents))


def under_armature(asset: Asset, **armature: Any) -> int:
    """Put everything that has no parent below a node of its own."""
    nodes = asset.json["nodes"]
    below = {child for node in nodes for child in node.get("children", [])}
    roots = [i for i in range(len(nodes)) if i not in below]
    nodes.append({"name": "Armature", "children": roots, **armature})
    return len(nodes) - 1


def test_an_armature_that_scales_and_turns(tmp_path: Path) -> None:
    """Centimetres with Z up below an armature, as Mixamo's files come out of Blender."""
    to_z = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    inner = ACTED.transformed(to_z)
    inner = replace(inner, offsets=inner.offsets * 100, root=inner.root * 100)
    back = Rotation.from_matrix(to_z.T).as_quat().tolist()
    asset = asset_of(inner)
    under_armature(asset, scale=[0.01] * 3, rotation=back)
    (take,) = read(asset.glb(), tmp_path)
    check(take, ACTED)
    assert "Armature" not in take.names
    (plain,) = read(asset_of(ACTED).glb(), tmp_path)
    np.testing.assert_allclose(take.rest, plain.rest, atol=TOLERANCE)
    asset.json["nodes"][-1] = {
        "children": asset.json["nodes"][-1]["children"],
        "matrix": np.vstack([np.c_[to_z.T * 0.01, [0, 0, 0]], [0, 0, 0, 1]]).T.ravel().tolist(),
    }
    check(read(asset.glb(), tmp_path)[0], ACTED)


def test_an_armature_that_carries_the_root_motion(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    channel = next(c for c in asset.json["animations"][0]["channels"] if c["target"]["path"] == "translation")
    channel["target"]["node"] = under_armature(asset)
    asset.json["nodes"][0].pop("translation")
    (take,) = read(asset.glb(), tmp_path)
    check(take, ACTED)
    assert take.names[0] == "Armature"
    retarget(take, path="a.glb")


def test_the_rest_pose_is_the_bind_pose(tmp_path: Path) -> None:
    """Blender writes the current pose to the nodes and the rest pose to the skin."""
    asset = asset_of(ACTED)
    (expected,) = read(asset.glb(), tmp_path)
    for joint, matrix in enumerate(ACTED.rotations[7]):
        asset.json["nodes"][joint]["rotation"] = Rotation.from_matrix(matrix).as_quat().tolist()
    (take,) = read(asset.glb(), tmp_path)
    check(take, ACTED)
    np.testing.assert_allclose(take.rest, expected.rest, atol=1e-3)


def test_bind_matrices_that_fit_no_skeleton_are_not_believed(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    (expected,) = read(asset.glb(), tmp_path)
    for wrong in (np.eye(4), np.zeros((4, 4))):
        values = np.repeat(wrong[None], len(ACTED.names), axis=0).reshape(-1, 16)
        asset.json["skins"][0]["inverseBindMatrices"] = asset.accessor(values)
        np.testing.assert_allclose(read(asset.glb(), tmp_path)[0].rest, expected.rest, atol=TOLERANCE)


def test_skins_that_share_joints_are_one_skeleton(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    joints = asset.json["skins"][0]["joints"]
    asset.json["skins"] = [{"joints": joints[:12]}, {"joints": joints[5:][::-1]}, {"joints": joints[3:4]}]
    (take,) = read(asset.glb(), tmp_path)
    check(take, ACTED)
    assert len(set(take.names)) == len(take.names)


def test_what_is_carried_is_no_joint_and_what_hangs_on_is(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    asset.json["nodes"][0]["children"] += [len(asset.json["nodes"]), len(asset.json["nodes"]) + 1]
    asset.json["nodes"] += [{"name": "sword", "mesh": 0}, {"name": "tail", "translation": [0, 0, -1]}]
    (take,) = read(asset.glb(), tmp_path)
    assert "tail" in take.names
    assert "sword" not in take.names


def test_only_the_figures_that_an_animation_moves_are_in_its_take(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    count, joints = len(asset.json["nodes"]), len(ACTED.names)
    for node in list(asset.json["nodes"]):
        asset.json["nodes"].append({**node, "children": [child + count for child in node.get("children", [])]})
    asset.json["skins"].append({"joints": list(range(count, count + joints))})
    (alone,) = read(asset.glb(), tmp_path)
    assert np.count_nonzero(alone.parents < 0) == 1
    channels = asset.json["animations"][0]["channels"]
    channels += [{**c, "target": {**c["target"], "node": c["target"]["node"] + count}} for c in channels]
    (pair,) = read(asset.glb(), tmp_path)
    assert np.count_nonzero(pair.parents < 0) == 2
    assert len(pair.names) == 2 * len(alone.names)


HUMANOID = {
    "mixamorig:Hips": "hips", "mixamorig:Spine": "spine", "mixamorig:Neck": "neck", "mixamorig:Head": "head",
    **{
        f"mixamorig:{side}{joint}": f"{side.lower()}{bone}"
        for side in ("Left", "Right")
        for joint, bone in {
            "UpLeg": "UpperLeg", "Leg": "LowerLeg", "Foot": "Foot", "ToeBase": "Toes", "Shoulder": "Shoulder",
            "Arm": "UpperArm", "ForeArm": "LowerArm", "Hand": "Hand",
        }.items()
    },
}  # fmt: skip


def bones(kind: str) -> dict[str, Any]:
    nodes = {bone: {"node": ACTED.names.index(name)} for name, bone in HUMANOID.items()}
    if kind == "VRM":
        return {"VRM": {"humanoid": {"humanBones": [{"bone": bone, **node} for bone, node in nodes.items()]}}}
    return {kind: {"humanoid": {"humanBones": nodes}}}


@pytest.mark.parametrize("kind", ["VRM", "VRMC_vrm", "VRMC_vrm_animation"])
def test_bones_of_a_humanoid_have_its_names(tmp_path: Path, kind: str) -> None:
    asset = asset_of(ACTED, with_skin=kind != "VRMC_vrm_animation")
    for i, node in enumerate(asset.json["nodes"]):
        node["name"] = f"ボーン{i}"
    asset.json["extensions"] = bones(kind)
    (take,) = read(asset.glb(), tmp_path, "a.vrma" if kind == "VRMC_vrm_animation" else "a.vrm")
    named = replace(ACTED, names=[HUMANOID.get(name, f"ボーン{i}") for i, name in enumerate(ACTED.names)])
    check(take, named)
    retarget(take, path="a.vrm")


def test_a_last_joint_that_turns_shows_where_it_points(tmp_path: Path) -> None:
    times = np.array([0, 1.0])
    asset = Asset()
    turn = Rotation.from_euler("z", [[0], [90]], degrees=True).as_quat()
    one_joint(asset, "translation", times, np.zeros((2, 3)))
    asset.animate("turn", [(1, "rotation", asset.accessor(times), asset.accessor(turn))])
    take = read(asset.glb(), tmp_path)[1]
    assert take.names == ("joint", "child", "child_end")
    np.testing.assert_allclose(take.positions[-1], [[0, 0, 0], [0, 1, 0], [-1, 1, 0]], atol=1e-6)
    np.testing.assert_allclose(take.rest, [[0, 0, 0], [0, 1, 0], [0, 2, 0]], atol=1e-6)


def test_the_small_file_beside_the_tests_is_someone_who_walks() -> None:
    motion = load_motion(DATA / "walk.glb")
    way = motion.joints[-1, 0] - motion.joints[0, 0]
    assert motion.duration == pytest.approx(1.0, abs=0.06)
    assert 0.5 < np.linalg.norm(way[[0, 2]]) < 1.2


def without(*keys: str) -> Callable[[dict[str, Any]], None]:
    def change(document: dict[str, Any]) -> None:
        for key in keys:
            document.pop(key)

    return change


def put(*way: Any) -> Callable[[dict[str, Any]], None]:
    """Set the value at the end of a way of keys."""

    def change(document: Any) -> None:
        for key in way[:-2]:
            document = document[key]
        document[way[-2]] = way[-1]

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (without("animations"), "it holds no animation, only a model"),
        (put("animations", []), "it holds no animation"),
        (put("animations", 0, "channels", []), "move no skeleton"),
        (put("animations", 0, "channels", 0, "target", "node", 999), "'node' is 999, of 32"),
        (put("animations", 0, "channels", 0, "sampler", 999), "'sampler' is 999"),
        (put("animations", 0, "samplers", 0, "interpolation", "QUADRATIC"), "interpolation"),
        (put("animations", 0, "samplers", 0, "interpolation", "CUBICSPLINE"), "20 keys of a spline have 20 values"),
        (put("animations", 0, "samplers", 0, "output", 0), "accessor 0 is SCALAR, not VEC3"),
        (put("animations", 5), "'animations' is no list"),
        (put("accessors", 0, "count", 19), "19 keys have 20 values"),
        (put("accessors", 0, "count", 10**12), "1000000000000 elements"),
        (put("accessors", 0, "count", 10_000_000), "longer than its buffer view"),
        (put("accessors", 0, "count", -1), "'count'"),
        (put("accessors", 0, "componentType", 5124), "component type 5124"),
        (put("accessors", 0, "bufferView", 999), "'bufferView'"),
        (put("bufferViews", 0, "byteLength", 10**9), "longer than its buffer"),
        (put("bufferViews", 0, "byteOffset", 10**30), "digits|longer"),
        (put("bufferViews", 0, "buffer", 1), "'buffer' is 1, of 1"),
        (put("bufferViews", 0, "extensions", {"EXT_meshopt_compression": {}}), "compressed .EXT_meshopt_compression"),
        (put("nodes", 0, "children", [0]), "below itself|two parents"),
        (put("nodes", 5, "children", [5]), "below itself|two parents"),
        (put("nodes", 0, "children", ["x"]), "'child'"),
        (put("nodes", 3, "rotation", [1, 2]), "rotation of a node is no 4 numbers"),
        (put("nodes", 3, "matrix", [1e999] * 16), "matrix of a node"),
        (put("skins", 0, "joints", [999]), "'joint' is 999"),
        (put("skins", 0, "joints", 3), "joints of a skin"),
        (put("asset", "version", "1.0"), "glTF 1.0 is not read"),
        (without("asset"), "no version"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(tmp_path: Path, change: Callable[[dict[str, Any]], None], reason: str) -> None:
    asset = asset_of(ACTED)
    change(asset.json)
    with pytest.raises(UnreadableMotion, match=reason):
        read(asset.glb(), tmp_path)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"glTF\x02\x00\x00\x00", "cut short"),
        (b"glTF" + struct.pack("<II", 1, 20) + bytes(8), "glTF 1 is not read"),
        (b"glTF" + struct.pack("<II", 2, 99) + bytes(8), "cut short: 20 of 99 bytes"),
        (b"glTF" + struct.pack("<II", 2, 20) + struct.pack("<II", 99, 0x4E4F534A), "longer than the file"),
        (b"glTF" + struct.pack("<II", 2, 20) + struct.pack("<II", 0, 1), "no JSON"),
        (b"{", "damaged"),
        (b'{"a": ' + b"[" * 100_000, "nested too deeply|damaged"),
        (b'{"a": ' + b"9" * 100_000 + b"}", "digits"),
        (b'{"asset": {"version": "2.0"}, "a": [' + b"[]," * 2_100_000 + b"[]]}", "more than 4000000 values"),
        (b'{"asset": "\xff"}', "damaged"),
    ],
)
def test_files_that_are_no_gltf(tmp_path: Path, data: bytes, reason: str) -> None:
    with pytest.raises(UnreadableMotion, match=reason):
        read(data, tmp_path, "a.gltf")


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_values_that_are_no_numbers(tmp_path: Path, bad: float) -> None:
    with pytest.raises(UnreadableMotion, match="no numbers"):
        read(one_joint(Asset(), "translation", [0, 1], [[0, 0, 0], [bad, 0, 0]]), tmp_path)


def test_keys_out_of_order(tmp_path: Path) -> None:
    with pytest.raises(UnreadableMotion, match="out of order"):
        read(one_joint(Asset(), "translation", [0, 2, 1], np.zeros((3, 3))), tmp_path)


@pytest.mark.parametrize(("seconds", "reason"), [(1e6, "lasts 278 hours"), (40, "too long")])
def test_two_keys_cannot_ask_for_any_length(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seconds: float, reason: str
) -> None:
    monkeypatch.setattr(gltf_reader, "MAX_PLACES", 30_000)
    asset = asset_of(ACTED)
    asset.json["animations"] = []
    asset.animate("x", [(0, "translation", asset.accessor([0, seconds]), asset.accessor(np.zeros((2, 3))))])
    with pytest.raises(UnreadableMotion, match=reason):
        read(asset.glb(), tmp_path)


def test_accessors_that_share_bytes_cannot_ask_for_any_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gltf_container, "MAX_NUMBERS", 1000)
    with pytest.raises(UnreadableMotion, match="too many keys"):
        read(asset_of(ACTED).glb(), tmp_path)


def test_joints_and_animations_are_bounded(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    asset.json["animations"] *= gltf_reader.MAX_ANIMATIONS + 1
    with pytest.raises(UnreadableMotion, match="more than 1000 animations"):
        read(asset.glb(), tmp_path)
    asset = asset_of(ACTED)
    asset.json["nodes"][-1] = {"children": list(range(40, 5040))}
    asset.json["nodes"] += [{}] * 5040
    asset.json["skins"][0]["joints"] += [len(ACTED.names)]
    with pytest.raises(UnreadableMotion, match="more than 4096 joints"):
        read(asset.glb(), tmp_path)


def test_many_accessors_take_no_time_for_each_other(tmp_path: Path) -> None:
    asset = asset_of(ACTED)
    asset.json["accessors"] += [{}] * 500_000
    asset.json["animations"] *= 20
    began = time.perf_counter()
    assert len(read(asset.glb(), tmp_path)) == 20
    assert time.perf_counter() - began < 5  # some 1,300 accessors are read


@pytest.mark.parametrize("seed", range(150))
def test_a_damaged_file_is_refused_or_read(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    asset = asset_of(performance("smpl", frames=3), rotations="i2")
    data = bytearray(asset.glb() if seed % 3 else asset.gltf())
    end = len(data) if seed % 2 else data.index(b"BIN\0") if seed % 3 else len(data)
    for place in rng.integers(end, size=rng.integers(1, 6)):
        data[place] = rng.integers(256) if seed % 5 else rng.choice(list(b'0123456789-{}[]",:'))
    with contextlib.suppress(UnreadableMotion):
        for take in read(bytes(data), tmp_path, "a.glb" if seed % 3 else "a.gltf"):
            retarget(take, path="a.glb")


KINDS: tuple[Any, ...] = (None, True, -1, 10**9, 1.5, "x", [], {}, [0], {"node": 0}, [[]], [{}])


@pytest.mark.parametrize("seed", range(150))
def test_a_document_with_anything_in_any_place_is_refused_or_read(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    asset = asset_of(performance("smpl", frames=3))
    asset.json["extensions"] = {"VRM": {"humanoid": {"humanBones": [{"bone": "hips", "node": 0}]}}}
    for _ in range(1 + seed % 3):
        spot: Any = asset.json
        while True:
            keys = list(spot) if isinstance(spot, dict) else list(range(len(spot)))
            key = keys[rng.integers(len(keys))]
            if not isinstance(spot[key], (dict, list)) or not spot[key] or rng.random() < 0.15:
                break
            spot = spot[key]
        spot[key] = KINDS[rng.integers(len(KINDS))]
    with contextlib.suppress(UnreadableMotion):
        for take in read(asset.glb(), tmp_path):
            retarget(take, path="a.glb")
