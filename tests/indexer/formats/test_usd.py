"""USD: skeletal animations come out as the joints that were animated; layers outside the folder are not opened."""

from __future__ import annotations

import contextlib
import gzip
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_takes
from indexer.ingest.file_parts import read_take
from indexer.ingest.load import load_motion
from indexer.take import Take
from tests.conftest import ROOT
from tests.indexer.formats.gltf_files import positions_of
from tests.indexer.formats.usd_files import paths_of, usda
from tests.indexer.performances import performance

Sdf: Any = pytest.importorskip("pxr.Sdf", reason="usd-core is not installed")
UsdUtils: Any = pytest.importorskip("pxr.UsdUtils", reason="usd-core is not installed")

DATA = Path(__file__).resolve().parents[2] / "data"
ACTED = performance("mixamo", frames=20, fps=30)
PLACES = positions_of(ACTED)
NAMES = [path.rpartition("/")[2] for path in paths_of(ACTED)]


def read(text: str, folder: Path, name: str = "a.usda") -> list[Take]:
    path = folder / name
    path.write_text(text)
    return read_takes(path)


def check(take: Take, places: np.ndarray = PLACES) -> None:
    joints = take.positions[:, [take.names.index(name) for name in NAMES]]
    np.testing.assert_allclose(joints, places, atol=1e-4)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"codes": 30, "first": 0},
        {"codes": 60, "first": 100},
        {"joints": "turning"},
        {"bound": False},
        {"rest_frame": 5},
    ],
)
def test_joints_are_where_the_animation_puts_them(tmp_path: Path, options: dict[str, Any]) -> None:
    (take,) = read(usda(ACTED, **options), tmp_path)
    check(take)
    assert (take.fps, take.up, take.name) == (30, "y", "")
    (plain,) = read(usda(ACTED), tmp_path, "plain.usda")
    bones = take.names.index("mixamorig_LeftFoot"), take.names.index("mixamorig_Hips")
    np.testing.assert_allclose(take.rest[bones, :], plain.rest[bones, :], atol=1e-4)


def test_the_up_axis_is_what_the_stage_says(tmp_path: Path) -> None:
    (take,) = read(usda(ACTED, up="Z"), tmp_path)
    assert (take.up, take.up_is_certain) == ("z", False)


def test_what_the_skeleton_stands_on_may_scale_and_move(tmp_path: Path) -> None:
    root = """
        double3 xformOp:translate.timeSamples = {1: (0, 0, 0), 16.2: (0, 0, 19)}
        float3 xformOp:scale = (2, 2, 2)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]"""
    (take,) = read(usda(ACTED, root=root), tmp_path)
    check(take, PLACES * 2 + np.arange(20)[:, None, None] * [0, 0, 1])
    leg = [take.names.index(f"mixamorig_Left{joint}") for joint in ("UpLeg", "Leg")]
    length = np.linalg.norm(take.positions[0, leg[1]] - take.positions[0, leg[0]])
    assert np.linalg.norm(take.rest[leg[1]] - take.rest[leg[0]]) == pytest.approx(length, rel=1e-4)


def test_each_animation_is_a_take(tmp_path: Path) -> None:
    takes = read(usda(ACTED, animations=("Walk", "Run")), tmp_path)
    assert [take.name for take in takes] == ["Walk", "Run"]
    for take in takes:
        check(take)
    check(read_take(f"{tmp_path / 'a.usda'}#Run"))


@pytest.mark.parametrize("ending", [".usdc", ".usd", ".usdz"])
def test_binary_layers_and_packages(tmp_path: Path, ending: str) -> None:
    (tmp_path / "text.usda").write_text(usda(ACTED))
    path = tmp_path / f"a{ending}"
    if ending == ".usdz":
        assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "text.usda"), str(path))
    else:
        Sdf.Layer.FindOrOpen(str(tmp_path / "text.usda")).Export(str(path))
    check(read_takes(path)[0])
    (tmp_path / f"other{'.bin' if ending != '.usdz' else ending}").write_bytes(path.read_bytes())
    check(read_takes(next(tmp_path.glob("other*")))[0])


def test_a_packed_layer_is_unpacked(tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_bytes(gzip.compress(usda(ACTED).encode()))
    check(read_takes(tmp_path / "a.usda")[0])


LAYER = "#usda 1.0\n(\n    subLayers = [@{}@]\n    timeCodesPerSecond = 24\n)\n"
REFERENCE = '#usda 1.0\ndef "Root" (prepend references = @{}@</Root>) {{}}\n'
PAYLOAD = """#usda 1.0
def "Root" (
    variants = {{ string v = "x" }}
    prepend variantSets = "v"
) {{
    variantSet "v" = {{
        "x" (payload = @{}@</Root>) {{}}
    }}
}}
"""
CLIPS = '#usda 1.0\ndef "Root" (clips = {{dictionary default = {{asset[] assetPaths = [@{}@]}}}}) {{}}\n'


@pytest.mark.parametrize("scene", [LAYER, REFERENCE, PAYLOAD])
@pytest.mark.parametrize("name", ["./parts/inner.usda", "parts/inner.usda"])
def test_layers_beside_belong_to_the_scene(tmp_path: Path, scene: str, name: str) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "inner.usda").write_text(usda(ACTED))
    check(read(scene.format(name), tmp_path)[0])


@pytest.mark.parametrize("scene", [LAYER, REFERENCE, PAYLOAD, CLIPS])
@pytest.mark.parametrize("outside", ["../inner.usda", "{folder}/inner.usda", "parts/deep.usda", "//host/share/a.usda"])
def test_layers_elsewhere_are_not_opened(tmp_path: Path, scene: str, outside: str) -> None:
    inner = tmp_path / "scene"
    (inner / "parts").mkdir(parents=True)
    (tmp_path / "inner.usda").write_text(usda(ACTED))
    (inner / "parts" / "deep.usda").write_text(LAYER.format("../../inner.usda"))
    if scene is CLIPS and outside.startswith("parts"):
        pytest.skip("what a clip refers to is not followed by USD either")
    with pytest.raises(UnreadableMotion, match="outside its folder"):
        read(scene.format(outside.format(folder=tmp_path)), inner)


def test_a_missing_layer_is_no_skeleton(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UnreadableMotion, match="no skeletal animation"):
        read(LAYER.format("./gone.usda"), tmp_path)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("def SkelAnimation", "def Xform", "skeletons without animation"),
        ("def Skeleton", "def Xform", "animations without a skeleton"),
        ("timeCodesPerSecond = 24.0", "timeCodesPerSecond = 0", "0 time codes a second"),
        ("timeCodesPerSecond = 24.0", "timeCodesPerSecond = 0.0002", "it lasts"),
        ("half3[] scales = [(1, 1, 1), ", "half3[] scales = [", "not as many values as joints"),
        ("(0, 0.95, 0)", "(0, nan, 0)", "values that are no numbers"),
        (
            'joints = ["mixamorig_Hips", ',
            'joints = ["mixamorig_Hips/mixamorig_Spine", "mixamorig_Hips", ',
            "before their",
        ),
        ("def SkelRoot", "def {", "the USD is damaged: "),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, old: str, new: str, reason: str) -> None:
    text = usda(ACTED)
    assert old in text
    with pytest.raises(UnreadableMotion, match=reason):
        read(text.replace(old, new, 1), tmp_path)


def test_without_usd_core_its_installation_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(UnreadableMotion, match=re.escape("pip install 'motionseek[usd]'")):
        read(usda(ACTED), tmp_path)


def test_the_small_file_beside_the_tests_is_someone_who_walks() -> None:
    motion = load_motion(DATA / "walk.usda")
    way = motion.joints[-1, 0] - motion.joints[0, 0]
    assert motion.duration == pytest.approx(1.0, abs=0.06)
    assert 0.5 < np.linalg.norm(way[[0, 2]]) < 1.2


FUZZ = """
import contextlib, sys
from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_takes
for path in sys.argv[1:]:
    with contextlib.suppress(UnreadableMotion):
        read_takes(path)
"""


@pytest.mark.parametrize("ending", [".usda", ".usdc"])
def test_damaged_files_are_refused_or_read(tmp_path: Path, ending: str) -> None:
    """In a process of their own, as files are read where a folder is indexed."""
    (tmp_path / "a.usda").write_text(usda(performance("smpl", frames=3)))
    Sdf.Layer.FindOrOpen(str(tmp_path / "a.usda")).Export(str(tmp_path / "a.usdc"))
    whole = (tmp_path / f"a{ending}").read_bytes()
    rng = np.random.default_rng(0)
    paths = []
    for number in range(60):
        data = bytearray(whole)
        for place in rng.integers(len(data), size=rng.integers(1, 6)):
            data[place] = rng.integers(256) if number % 2 else rng.choice(list(b"0123456789-[]().,:@"))
        paths.append(tmp_path / f"{number}{ending}")
        paths[-1].write_bytes(data)
    done = subprocess.run(
        [sys.executable, "-c", FUZZ, *paths], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]


def test_a_damaged_package_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.usdz"
    path.write_bytes(b"PK\x03\x04" + bytes(100))
    with pytest.raises(UnreadableMotion, match=r"damaged|no skeletal animation"), contextlib.closing(path.open("rb")):
        read_takes(path)
