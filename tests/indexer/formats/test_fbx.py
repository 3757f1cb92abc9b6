"""FBX: which movement comes out of a scene, in every kind of file; what is refused, and that damage does no harm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_takes
from indexer.ingest.file_parts import read_take
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


def pose(folder: Path, properties: dict[str, object], parent: dict[str, object] | None = None) -> np.ndarray:
    """Where a hand is, 2 along x from an arm with some properties, which hangs on a hip with others."""
    nodes = [
        Node("Hips", properties=parent or {}),
        Node("Arm", parent="Hips", properties=properties),
        Node("Hand", parent="Arm", properties={"Lcl Translation": (2.0, 0.0, 0.0)}),
    ]
    still = Keys([0, 1], [0.0, 0.0])
    stacks = [Stack("A", [Layer({("Hand", "Lcl Rotation"): {"X": still, "Y": 0.0, "Z": 0.0}})], (0, 1))]
    (take,) = read(folder, fbx.binary(fbx.scene(nodes, stacks, settings=TWO)))
    np.testing.assert_allclose(take.rest, take.positions[0], atol=1e-9)
    return take.positions[0, 2]


@pytest.mark.parametrize(
    ("properties", "place"),
    [
        ({"Lcl Rotation": (0.0, 0.0, 90.0)}, [0, 2, 0]),
        ({"PreRotation": (0.0, 0.0, 90.0)}, [0, 2, 0]),
        ({"PostRotation": (0.0, 0.0, 90.0)}, [0, -2, 0]),
        ({"PreRotation": (90.0, 0.0, 0.0), "Lcl Rotation": (0.0, 0.0, 90.0)}, [0, 0, 2]),
        ({"Lcl Rotation": (90.0, 0.0, 90.0), "RotationOrder": 0}, [0, 2, 0]),  # about x, then about z
        ({"Lcl Rotation": (90.0, 0.0, 90.0), "RotationOrder": 5}, [0, 0, 2]),  # about z, then about x
        ({"Lcl Rotation": (0.0, 90.0, 90.0), "RotationOrder": 2}, [0, 0, -2]),  # y turns it onto -z, where z leaves it
        ({"Lcl Rotation": (0.0, 0.0, 90.0), "RotationPivot": (1.0, 0.0, 0.0)}, [1, 1, 0]),
        ({"Lcl Rotation": (0.0, 0.0, 90.0), "RotationOffset": (0.0, 0.0, 3.0)}, [0, 2, 3]),
        ({"Lcl Scaling": (2.0, 1.0, 1.0)}, [4, 0, 0]),
        ({"Lcl Scaling": (2.0, 1.0, 1.0), "ScalingPivot": (1.0, 0.0, 0.0)}, [3, 0, 0]),
        ({"Lcl Scaling": (2.0, 1.0, 1.0), "ScalingOffset": (0.0, 1.0, 0.0)}, [4, 1, 0]),
    ],
)
def test_what_places_a_node(tmp_path: Path, properties: dict[str, object], place: list[float]) -> None:
    np.testing.assert_allclose(pose(tmp_path, properties), place, atol=1e-9)


@pytest.mark.parametrize(
    ("inherit", "place"),
    [(0, [0, 4, 0]), (1, [0, 4, 0]), (2, [0, 2, 0])],
)
def test_a_scale_is_taken_over_as_the_node_says(tmp_path: Path, inherit: int, place: list[float]) -> None:
    scaled = {"Lcl Scaling": (2.0, 2.0, 2.0)}
    turned = {"Lcl Rotation": (0.0, 0.0, 90.0), "InheritType": inherit}
    np.testing.assert_allclose(pose(tmp_path, turned, scaled), place, atol=1e-9)


@pytest.mark.parametrize("leg", [(0.0, -4.0, 0.0), (0.0, 4.0, 0.0)])
def test_without_bind_pose_a_t_pose_of_unturned_joints_is_the_rest_pose(
    tmp_path: Path, leg: tuple[float, float, float]
) -> None:
    """What the nodes state is but the frame at which the scene was saved; all bones along one axis are no pose."""
    places = {"Hips": "", "Head": "Hips", "LeftHand": "Head", "RightHand": "Head", "LeftFoot": "Hips"}
    offsets = [(0.0, 0.0, 0.0), (0.0, 5.0, 0.0), (3.0, 0.0, 0.0), (-3.0, 0.0, 0.0), leg]
    nodes = [
        Node(name, parent=parent, properties={"Lcl Translation": offset, "Lcl Rotation": (0.0, 0.0, 30.0)})
        for (name, parent), offset in zip(places.items(), offsets, strict=True)
    ]
    stacks = [Stack("A", [Layer({("Head", "Lcl Rotation"): {"X": 0.0, "Y": 0.0, "Z": HALF_TURN}})], (0, 1))]
    (take,) = read(tmp_path, fbx.binary(fbx.scene(nodes, stacks, settings=TWO)))
    assert np.allclose(take.rest, [[0, 0, 0], [0, 5, 0], [3, 5, 0], [-3, 5, 0], leg]) == (leg[1] < 0)
    assert take.rotations is not None
    hand = take.rotations()[:, 1] @ (take.rest[2] - take.rest[1])
    np.testing.assert_allclose(hand, take.positions[:, 2] - take.positions[:, 1], atol=1e-9)


def turned(folder: Path, keys: Keys, frames: float = 4.0, layers: tuple[Layer, ...] = ()) -> np.ndarray:
    """X of a hip that moves by a curve, at some frames a second."""
    stacks = [Stack("A", [Layer({("Hips", "Lcl Translation"): {"X": keys, "Y": 0.0, "Z": 0.0}}), *layers], (0, 1))]
    settings = {"TimeMode": 14, "CustomFrameRate": frames}
    (take,) = read(folder, fbx.binary(fbx.scene(ARM, stacks, settings=settings)))
    return take.positions[:, 0, 0]


@pytest.mark.parametrize(
    ("keys", "values"),
    [
        (Keys([0, 1], [0, 4]), [0, 1, 2, 3, 4]),
        (Keys([0, 1], [0, 4], fbx.CONSTANT), [0, 0, 0, 0, 4]),
        (Keys([0, 1], [0, 4], fbx.CONSTANT_NEXT), [0, 4, 4, 4, 4]),
        (Keys([0, 1], [0, 4], fbx.CUBIC_USER), [0, 0.625, 2, 3.375, 4]),  # level tangents: 3 t^2 - 2 t^3
        (Keys([0, 1], [0, 4], fbx.CUBIC_AUTO), [0, 1, 2, 3, 4]),
        (Keys([0, 0.5, 1], [0, 4, 4], fbx.CUBIC_AUTO | fbx.CLAMP_PROGRESSIVE), [0, 2, 4, 4, 4]),
        (Keys([0.25, 0.5], [1, 2]), [1, 1, 2, 2, 2]),
        (Keys([0.25, 0.5], [1, 2], after=("R", -1)), [1, 1, 2, 1, 1]),
        (Keys([0.25, 0.5], [1, 2], before=("K", -1), after=("K", -1)), [0, 1, 2, 3, 4]),
        (Keys([0, 0.25], [0, 1], after=("A", -1)), [0, 1, 2, 3, 4]),
        (Keys([0, 0.5], [0, 2], after=("M", -1)), [0, 1, 2, 1, 0]),
    ],
)
def test_what_curves_do_between_and_beyond_their_keys(tmp_path: Path, keys: Keys, values: list[float]) -> None:
    np.testing.assert_allclose(turned(tmp_path, keys), values, atol=1e-5)


@pytest.mark.parametrize(
    ("properties", "values"),
    [
        ({}, [0, 2, 4, 6, 8]),
        ({"Weight": 50.0}, [0, 1.5, 3, 4.5, 6]),
        ({"BlendMode": 1, "Weight": 50.0}, [0, 1, 2, 3, 4]),
        ({"BlendMode": 2, "Weight": 25.0}, [0, 1, 2, 3, 4]),
    ],
)
def test_layers_are_added_mixed_or_put_over_others(
    tmp_path: Path, properties: dict[str, float], values: list[float]
) -> None:
    keys = Keys([0, 1], [0, 4])
    above = Layer({("Hips", "Lcl Translation"): {"X": keys, "Y": 0.0, "Z": 0.0}}, properties)
    np.testing.assert_allclose(turned(tmp_path, keys, layers=(above,)), values, atol=1e-5)


def test_ours_and_ufbx_agree_on_real_scenes(mocap: Path) -> None:
    """Within a millimetre and a tenth of a degree, at all frames of all stacks."""
    pytest.importorskip("pufbx", reason="pip install pufbx, with a C compiler")
    from tests.indexer.formats.ufbx_poses import apart, metres

    still = []
    for path in sorted((mocap / "scene").rglob("*.fbx")):
        try:
            distance, angle = apart(path)
        except StopIteration:
            still.append(path.name)
            continue
        if distance == 0:
            still.append(path.name)
            continue
        assert (path.name, distance * metres(path) < 1e-3, angle < 0.1) == (path.name, True, True)
    assert still == ["Base.fbx"]


FUZZED = [KINDS[kind](ARM, SWING, settings=TWO) for kind in KINDS]


def test_damage_gives_takes_or_a_reason(tmp_path: Path) -> None:
    """Bytes exchanged, removed and repeated at random: a take, or a refusal that says why."""
    rng = np.random.default_rng(0)
    outcomes = {True: 0, False: 0}
    for data in FUZZED * 60:
        damaged = bytearray(data)
        for _ in range(rng.integers(1, 6)):
            at = int(rng.integers(len(damaged)))
            match rng.integers(4):
                case 0:
                    damaged[at] = int(rng.integers(256))
                case 1:
                    damaged[at : at + 4] = [bytes(4), b"\xff" * 4, b"\1\0\0\0"][rng.integers(3)]
                case 2:
                    del damaged[at : at + int(rng.integers(1, 40))]
                case _:
                    damaged[at:at] = damaged[at : at + int(rng.integers(1, 200))]
        try:
            takes = read(tmp_path, bytes(damaged))
            outcomes[True] += 1
            assert all(np.isfinite(take.positions).all() for take in takes)
        except UnreadableMotion:
            outcomes[False] += 1
    assert min(outcomes.values()) > 20


def test_what_a_few_bytes_ask_for_is_bounded(tmp_path: Path) -> None:
    for_ever = [Stack("A", [Layer({("Arm", "Lcl Rotation"): {"X": Keys([0, 1e7], [0, 1]), "Y": 0.0, "Z": 0.0}})])]
    assert "hours" in reason(tmp_path, fbx.binary(fbx.scene(ARM, for_ever)))
    in_circle = [Node("A", parent="B"), Node("B", parent="A"), *ARM]
    (take,) = read(tmp_path, fbx.binary(fbx.scene(in_circle, SWING)))
    assert take.names == ("Hips", "Arm", "Hand")
    deep: fbx.Tree = [("Takes", [], [])]
    for _ in range(100):
        deep = [("Takes", [], deep)]
    assert "in one another" in reason(tmp_path, fbx.binary(deep))
