"""Exports keep the rig of their source, or take that of another file; they can be resampled and stay in place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from encoders.errors import MotionSeekWarning, QueryError, UnreadableMotion
from encoders.motion import Motion
from indexer.ingest.file_parts import read_take
from indexer.ingest.load import load_motion
from indexer.take import Take
from search.export.cut import write_cut
from search.library import Library
from search.source import MotionSource
from tests.conftest import ROOT
from tests.indexer.formats import fbx_writer as fbx
from tests.indexer.formats.gltf_files import asset_of
from tests.indexer.formats.usd_files import usda
from tests.indexer.performances import Z_UP, Performance, bvh, performance, together
from tests.search.export.test_generations import MOTIONS

AMC = ROOT / "search" / "demo_data" / "session_01.amc"


def _shared(a: Take, b: Take) -> tuple[np.ndarray, np.ndarray]:
    """The tracks of the joints that two takes have in common, in one order."""
    names = [name for name in a.names if name in b.names]
    assert len(names) > 20
    first, second = (take.positions[:, [take.names.index(name) for name in names]] for take in (a, b))
    return first, second


def _off(a: Motion, b: Motion) -> float:
    """Mean distance of joints in centimetres, as seen from the pelvis."""
    count = min(len(a), len(b))
    seen = [motion.joints[:count] - motion.joints[:count, :1] for motion in (a, b)]
    return float(np.linalg.norm(seen[0] - seen[1], axis=-1).mean() * 100)


def test_the_skeleton_may_be_one_of_several_in_a_file(tmp_path: Path) -> None:
    pair = together(bvh(performance()), bvh(performance("mixamo")))
    (tmp_path / "pair.bvh").write_text(pair, encoding="utf-8")
    motion = MotionSource.of_motion(MOTIONS["a walk"]())
    for part, hips in (("", "Hips"), ("#2", "mixamorig:Hips")):
        write_cut(motion, tmp_path / "out.bvh", rig=tmp_path / f"pair.bvh{part}")
        assert read_take(tmp_path / "out.bvh").names[0] == hips
    with pytest.raises(UnreadableMotion, match="name one of them"):
        write_cut(motion, tmp_path / "out.bvh", rig=tmp_path / "pair.bvh#3")


def test_an_amc_becomes_a_bvh_of_its_own_skeleton_and_rate(tmp_path: Path) -> None:
    source = MotionSource.of_file(AMC)
    _, fps = write_cut(source, tmp_path / "out.bvh")
    whole, written = read_take(AMC), read_take(tmp_path / "out.bvh")
    assert (fps, written.fps) == (whole.fps, whole.fps)
    ours, theirs = _shared(written, whole)
    np.testing.assert_allclose(ours, theirs, atol=0.01)
    assert _off(load_motion(tmp_path / "out.bvh"), source.motion) < 0.1
    moved = [line for line in (tmp_path / "out.bvh").read_text().splitlines() if "CHANNELS 6" in line]
    assert len(moved) == 1


def test_joints_that_slide_keep_their_way(tmp_path: Path) -> None:
    """A root that moves below an origin, as game rigs have it."""
    text = bvh(performance("mixamo"))
    head, body = text.split("ROOT", 1)
    joints, motion = body.split("MOTION", 1)
    origin = "ROOT origin\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT" + joints + "}\n"
    lines = motion.splitlines()
    rows = [f"0 0 0 {row}" for row in lines[3:]]
    (tmp_path / "in.bvh").write_text("\n".join([head + origin + "MOTION", *lines[1:3], *rows]))
    write_cut(MotionSource.of_file(tmp_path / "in.bvh"), tmp_path / "out.bvh", fps=40)
    before, after = read_take(tmp_path / "in.bvh"), read_take(tmp_path / "out.bvh")
    np.testing.assert_allclose(after.positions[::2], before.positions, atol=1e-3)


@pytest.mark.parametrize("like", ["mixamo", "unreal", "biped", "Z up", "along x"])
@pytest.mark.parametrize("name", ["a walk", "a crawl", "a gesture with both arms"])
def test_a_motion_on_the_rig_of_another_file(name: str, like: str, tmp_path: Path) -> None:
    acted = performance("mixamo" if " " in like else like)
    if like == "Z up":
        acted = acted.transformed(Z_UP)
    (tmp_path / "like.bvh").write_text(_along_x(acted) if like == "along x" else bvh(acted, unit=100))
    motion = _as_read_from_a_rig(MOTIONS[name](), tmp_path)
    frames, fps = write_cut(MotionSource.of_motion(motion), tmp_path / "out.bvh", rig=tmp_path / "like.bvh")
    assert (frames, fps) == (len(motion), 20.0)
    written, given = read_take(tmp_path / "out.bvh"), read_take(tmp_path / "like.bvh")
    assert written.names == given.names
    np.testing.assert_allclose(written.rest, given.rest, atol=1e-4)
    assert _off(load_motion(tmp_path / "out.bvh"), motion) < 3.5  # about 3 cm, as docs/formats.md says


def _as_read_from_a_rig(motion: Motion, folder: Path) -> Motion:
    """The motion with the trunk that every rig is given; that of synthetic clips is a little different."""
    (folder / "first.bvh").write_text(bvh(performance("poser"), unit=10))
    write_cut(MotionSource.of_motion(motion), folder / "read.bvh", rig=folder / "first.bvh")
    return load_motion(folder / "read.bvh")


def _along_x(acted: Performance) -> str:
    """The performance on a rig whose bones all lie along +X at rest, as solvers write them."""
    from encoders.geometry import rotation_between

    turned = np.broadcast_to(np.eye(3), (len(acted.names), 3, 3)).copy()
    parents, offsets = np.array(acted.parents), acted.offsets.copy()
    children = [np.flatnonzero(parents == joint) for joint in range(len(parents))]
    for joint, below in enumerate(children):
        if len(below):
            turned[joint] = rotation_between(np.array([1.0, 0, 0]), acted.offsets[below[0]])
    local = acted.rotations.copy()
    for joint, parent in enumerate(parents):
        above = turned[parent] if parent >= 0 else np.eye(3)
        local[:, joint] = above.T @ acted.rotations[:, joint] @ turned[joint]
        if parent >= 0:
            offsets[joint] = above.T @ acted.offsets[joint]
    return bvh(Performance(acted.names, acted.parents, offsets, local, acted.root, acted.fps), unit=100)


@pytest.mark.parametrize("ending", [".bvh", ".glb", ".npz"])
@pytest.mark.parametrize("fps", [24, 30, 60])
def test_another_frame_rate_is_the_same_movement(ending: str, fps: int, tmp_path: Path) -> None:
    motion = MOTIONS["a walk"]()
    frames, rate = write_cut(MotionSource.of_motion(motion), tmp_path / f"x{ending}", fps=fps)
    assert rate == fps
    assert frames == (len(motion) - 1) * fps // 20 + 1
    again = load_motion(tmp_path / f"x{ending}")
    assert _off(again, motion) < 0.5


def test_an_npy_has_the_rate_at_which_it_is_read(tmp_path: Path) -> None:
    motion = MOTIONS["a walk"]()
    with pytest.raises(QueryError, match=r"write a \.npz"):
        write_cut(MotionSource.of_motion(motion), tmp_path / "x.npy", fps=60)
    assert not (tmp_path / "x.npy").exists()
    for given, fps in ((motion, 20), (motion, None), (motion.resample(60), None)):
        write_cut(MotionSource.of_motion(given), tmp_path / "x.npy", fps=fps)
        assert len(load_motion(tmp_path / "x.npy")) == len(motion)


@pytest.mark.parametrize("ending", [".bvh", ".glb", ".npz", ".npy"])
def test_in_place_the_hips_stay_over_one_spot(ending: str, tmp_path: Path) -> None:
    motion = MOTIONS["a walk"]()
    write_cut(MotionSource.of_motion(motion), tmp_path / f"x{ending}", in_place=True)
    again = load_motion(tmp_path / f"x{ending}")
    assert np.ptp(again.joints[:, 0, [0, 2]], axis=0).max() < 0.01
    assert _off(again, motion) < 0.5


def test_a_rig_of_a_file_stays_in_place(tmp_path: Path) -> None:
    (tmp_path / "in.bvh").write_text(bvh(performance("mixamo").transformed(Z_UP)))
    source = MotionSource.of_file(tmp_path / "in.bvh")
    write_cut(source, tmp_path / "out.bvh", in_place=True)
    again = load_motion(tmp_path / "out.bvh")
    assert np.ptp(source.motion.joints[:, 0, 2]) > 0.5
    assert np.ptp(again.joints[:, [1, 2], ::2].mean(axis=1), axis=0).max() < 0.02
    assert _off(again, source.motion) < 0.5


def test_a_rig_is_for_bvh_and_needs_rotations(tmp_path: Path) -> None:
    source = MotionSource.of_motion(MOTIONS["a walk"]())
    write_cut(source, tmp_path / "joints.npz")
    with pytest.raises(QueryError, match="only a"):
        write_cut(source, tmp_path / "x.glb", rig=tmp_path / "joints.npz")
    with pytest.raises(QueryError, match="positions only"):
        write_cut(source, tmp_path / "x.bvh", rig=tmp_path / "joints.npz")
    assert not list(tmp_path.glob("x.*"))


def test_a_source_that_is_gone_or_has_changed_is_said(tmp_path: Path, tiny_bundle: Path) -> None:
    from encoders.bundle.bundle import Bundle
    from indexer.ingest.indexing import index

    bundle = Bundle.load(tiny_bundle)
    (tmp_path / "takes").mkdir()
    for name in ("changed", "gone", "same"):
        (tmp_path / "takes" / f"{name}.bvh").write_text(bvh(performance("mixamo", seed=len(name))))
    index(tmp_path / "takes", bundle=bundle, jobs=1)
    (tmp_path / "takes" / "gone.bvh").unlink()
    with (tmp_path / "takes" / "changed.bvh").open("a") as file:
        file.write("\n")
    with Library.open(tmp_path / "takes", bundle=bundle) as library:
        for name in ("changed", "gone"):
            with pytest.warns(MotionSeekWarning, match=f"{name}.*since it was indexed"):
                written = library.export(f"{name}.bvh", tmp_path / f"{name}.bvh")
            assert "pelvis" in read_take(written).names
        assert "mixamorig:Hips" in read_take(library.export("same.bvh", tmp_path / "same.bvh")).names


def _fbx(acted: Performance) -> bytes:
    """A performance as FBX, Z up, whose joints have rotations before their own."""
    before = np.tile([20.0, -10.0, 30.0], (len(acted.names), 1))
    times = np.arange(len(acted.root)) / acted.fps
    frames = Rotation.from_euler("xyz", before, degrees=True).as_matrix()
    nodes, moves = [], {}
    for joint, (name, parent) in enumerate(zip(acted.names, acted.parents, strict=True)):
        above = frames[parent].T if parent >= 0 else np.eye(3)
        offset = above @ acted.offsets[joint]
        # The rotation before takes what the parent's leaves, so that a joint's axes are its own frame at rest.
        at_rest = Rotation.from_matrix(above @ frames[joint]).as_euler("xyz", degrees=True)
        properties = {"Lcl Translation": offset.tolist(), "PreRotation": at_rest.tolist(), "RotationActive": 1}
        nodes.append(fbx.Node(name, parent=acted.names[parent] if parent >= 0 else "", properties=properties))
        turns = frames[joint].T @ acted.rotations[:, joint] @ frames[joint]
        angles = np.degrees(np.unwrap(Rotation.from_matrix(turns).as_euler("xyz"), axis=0))
        moves[name, "Lcl Rotation"] = {axis: fbx.Keys(times, angles[:, k]) for k, axis in enumerate("XYZ")}
    moves[acted.names[0], "Lcl Translation"] = {axis: fbx.Keys(times, acted.root[:, k]) for k, axis in enumerate("XYZ")}
    settings = {"UpAxis": 2, "UpAxisSign": 1, "UnitScaleFactor": 100.0, "TimeMode": 6}
    return fbx.binary(fbx.scene(nodes, [fbx.Stack("Walk", [fbx.Layer(moves)])], settings=settings))


@pytest.mark.parametrize("ending", [".fbx", ".glb", ".usda"])
def test_a_scene_becomes_a_bvh_of_its_own_skeleton_and_rate_with_y_up(ending: str, tmp_path: Path) -> None:
    acted = performance("mixamo", frames=60, fps=30.0)
    is_fbx = ending == ".fbx"
    if ending == ".usda":
        pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
        (tmp_path / "in.usda").write_text(usda(acted))
    else:
        data = _fbx(acted.transformed(Z_UP)) if is_fbx else asset_of(acted).glb()
        (tmp_path / f"in{ending}").write_bytes(data)
    source = MotionSource.of_file(tmp_path / f"in{ending}")
    _, fps = write_cut(source, tmp_path / "out.bvh")
    whole, written = read_take(tmp_path / f"in{ending}"), read_take(tmp_path / "out.bvh")
    assert (fps, written.fps) == (30.0, 30.0)
    ours, theirs = _shared(written, whole)
    np.testing.assert_allclose(ours, theirs @ (Z_UP if is_fbx else np.eye(3)), atol=2e-4)
    assert _off(load_motion(tmp_path / "out.bvh"), source.motion) < 0.1
    assert (tmp_path / "out.bvh").read_text().count("CHANNELS 6") == 1
