"""FBX: which movement comes out of a scene, in every kind of file; what is refused, and that damage does no harm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_take, read_takes
from indexer.take import Take
from tests.indexer.formats import fbx_writer as fbx
from tests.indexer.formats.fbx_writer import Keys, Layer, Node, Stack

HALF_TURN = Keys([0, 1], [0, 180])
ARM = [
    Node("Hips", properties={"Lcl Translation": (0.0, 10.0, 0.0)}),
    Node("Arm", parent="Hips", properties={"Lcl Translation": (1.0, 0.0, 0.0)}),
    Node("Hand", parent="Arm", properties={"Lcl Translation": (2.0, 0.0, 0.0)}),
]
SWING = [Stack("Swing", [Layer({("Arm", "Lcl Rotation"): {"X": 0.0, "Y": 0.0, "Z": HALF_TURN}})], (0, 1))]
TWO = {"TimeMode": 14, "CustomFrameRate": 2.0}

KINDS = {
    "binary 6.1": lambda nodes, stacks, **s: fbx.binary(fbx.scene_of_version_6(nodes, stacks, **s), 6100, pack=False),
    "binary 7.1": lambda nodes, stacks, **s: fbx.binary(fbx.scene(nodes, stacks, **s), 7100, pack=False),
    "binary 7.4": lambda nodes, stacks, **s: fbx.binary(fbx.scene(nodes, stacks, **s), 7400),
    "binary 7.5": lambda nodes, stacks, **s: fbx.binary(fbx.scene(nodes, stacks, **s), 7500),
    "binary 7.7": lambda nodes, stacks, **s: fbx.binary(fbx.scene(nodes, stacks, **s), 7700),
    "ASCII 6.1": lambda nodes, stacks, **s: fbx.text(fbx.scene_of_version_6(nodes, stacks, **s)),
    "ASCII 7.4": lambda nodes, stacks, **s: fbx.text(fbx.scene(nodes, stacks, **s)),
}


def read(folder: Path, data: bytes) -> list[Take]:
    path = folder / "a.fbx"
    path.write_bytes(data)
    return read_takes(path)


def reason(folder: Path, data: bytes) -> str:
    with pytest.raises(UnreadableMotion) as error:
        read(folder, data)
    return error.value.reason


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_file_gives_the_same_movement(tmp_path: Path, kind: str) -> None:
    (take,) = read(tmp_path, KINDS[kind](ARM, SWING, settings=TWO))
    assert (take.names, take.parents.tolist()) == (("Hips", "Arm", "Hand"), [-1, 0, 1])
    assert (take.name, take.fps, take.up) == ("Swing", 2, "y")
    np.testing.assert_allclose(take.rest, [[0, 10, 0], [1, 10, 0], [3, 10, 0]])
    np.testing.assert_allclose(take.positions[:, 0], [[0, 10, 0]] * 3)
    np.testing.assert_allclose(take.positions[:, 1], [[1, 10, 0]] * 3)
    np.testing.assert_allclose(take.positions[:, 2], [[3, 10, 0], [1, 12, 0], [-1, 10, 0]], atol=1e-12)


def test_each_stack_is_a_take(tmp_path: Path) -> None:
    stacks = [Stack("Take 001", SWING[0].layers), Stack("Take 001", SWING[0].layers), Stack("", SWING[0].layers)]
    takes = read(tmp_path, fbx.binary(fbx.scene(ARM, stacks)))
    assert [take.name for take in takes] == ["Take 001", "Take 001 (2)", "take 3"]
    assert read_take(f"{tmp_path / 'a.fbx'}#Take 001 (2)").name == "Take 001 (2)"


def test_a_scene_without_animation_is_refused_as_that(tmp_path: Path) -> None:
    assert "holds no animation" in reason(tmp_path, fbx.binary(fbx.scene(ARM, [])))
    assert "holds no animation" in reason(tmp_path, fbx.text(fbx.scene(ARM, [Stack("Empty", [Layer({})])])))
    assert "holds no skeleton" in reason(tmp_path, fbx.binary(fbx.scene([Node("Box", "Mesh")], [])))
