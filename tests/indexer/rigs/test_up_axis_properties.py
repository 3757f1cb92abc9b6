"""Whatever a person does and whatever file it comes in, up is found, and the movement is the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from encoders.features.humanml3d import joints_to_features
from encoders.motion import Motion
from indexer.formats.numpy_files.array_layouts import takes_of
from indexer.formats.reading import read_takes
from indexer.ingest.load import load_motion
from indexer.rigs.retarget import retarget, retarget_with_reading
from indexer.take import Take
from search.export import bvh_writer
from tests.indexer.carriers import POSTURES, along_x, apart, bvh_text, performed, t_pose
from tests.indexer.performances import Z_UP

#: Seeds of the performances; the first is quick, the others are slow.
SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 6))]
NEAR, ALIKE = 0.03, 0.99


def array(joints: np.ndarray) -> Take:
    (take,) = takes_of("a.npy", joints, 20.0)
    return take


def pinned(joints: np.ndarray) -> np.ndarray:
    return joints - joints[:, :1]


#: What is written, as BVH text or as an array, and the axis that is up in it.
CARRIERS: dict[str, tuple[Callable[[np.ndarray], bytes | np.ndarray], str]] = {
    "standing rest pose": (lambda joints: bvh_text(joints, t_pose()), "y"),
    "rest pose along x": (lambda joints: bvh_text(joints, along_x()), "y"),
    "z up": (lambda joints: bvh_text(joints @ Z_UP.T, t_pose() @ Z_UP.T), "z"),
    "floor at 1 m": (lambda joints: bvh_text(joints + np.array([0, 1, 0]), t_pose()), "y"),
    "root pinned": (lambda joints: bvh_text(pinned(joints), t_pose()), "y"),
    "array": (lambda joints: joints, "y"),
    "array, z up": (lambda joints: joints @ Z_UP.T, "z"),
}
#: Where too little tells two axes apart without a rest pose. `--up z` sets it right.
UNDECIDABLE = {
    ("array, z up", "lie on the belly", 5),
    ("array, z up", "lie on the back", 3),
    ("array, z up", "lie on the back", 4),
    ("array, z up", "lie on the left side", 3),
    ("array, z up", "lie on the left side", 5),
    ("array, z up", "lie on the right side", 4),
    ("array", "lie on the belly", 4),
    ("floor at 1 m", "lie on the belly", 4),
    ("rest pose along x", "lie on the belly", 4),
}

#: Files that may look as well like another movement with another axis up.
AMBIGUOUS: dict[str, tuple[Callable[[np.ndarray], bytes | np.ndarray], str]] = {
    "z up, rest pose along y": (lambda joints: bvh_text(joints @ Z_UP.T, t_pose()), "z"),
    "z up, rest pose along x": (lambda joints: bvh_text(joints @ Z_UP.T, along_x()), "z"),
    "array, floor at 1 m": (lambda joints: joints + np.array([0, 1, 0]), "y"),
    "array, root pinned": (pinned, "y"),
    "array, z up": (lambda joints: joints @ Z_UP.T, "z"),
}


@pytest.fixture(scope="module")
def bundle() -> Bundle:
    return Bundle.load()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("posture", POSTURES)
def test_every_carrier_gives_the_plain_motion(posture: str, seed: int, bundle: Bundle, tmp_path: Path) -> None:
    joints = performed(posture, seed)
    plain, in_place = (retarget(array(j).with_up("y"), path="a.npy") for j in (joints, pinned(joints)))
    found, expected = [], []
    for carrier, (write, axis) in CARRIERS.items():
        take = read(write(joints), tmp_path)
        if (carrier, posture, seed) in UNDECIDABLE:
            _, reading = retarget_with_reading(take, path="a.bvh")
            says = any(f"and {axis} may be" in warning for warning in reading.warnings)
            assert reading.up == axis or says, (carrier, reading.up_reason)
            take = take.with_up(axis)
        motion, reading = retarget_with_reading(take, path="a.bvh")
        assert reading.up == axis, (carrier, reading.up_reason)
        found.append(motion)
        expected.append(in_place if carrier == "root pinned" else plain)
        np.testing.assert_allclose(motion.joints, expected[-1].joints, atol=NEAR, err_msg=carrier)
    assert (bundle.encode_motions(found) * bundle.encode_motions(expected)).sum(axis=1).min() > ALIKE


@pytest.mark.parametrize("seed", SEEDS[:3])
@pytest.mark.parametrize("posture", POSTURES)
def test_a_wrong_axis_is_never_taken_without_a_word(posture: str, seed: int, tmp_path: Path) -> None:
    joints = performed(posture, seed)
    for carrier, (write, axis) in AMBIGUOUS.items():
        _, reading = retarget_with_reading(read(write(joints), tmp_path), path="a.bvh")
        says = [warning for warning in reading.warnings if f"and {axis} may be" in warning]
        assert reading.up == axis or says, (carrier, reading.up_reason)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("posture", POSTURES)
def test_features_and_exports_are_the_same_motion(posture: str, seed: int, tmp_path: Path, bundle: Bundle) -> None:
    plain = retarget(array(performed(posture, seed)).with_up("y"), path="a.npy")
    np.save(tmp_path / "features.npy", joints_to_features(plain.joints, retarget=False))
    np.savez(tmp_path / "own.npz", joints=plain.joints, fps=20.0, up="y")
    with (tmp_path / "own.bvh").open("wb") as file:
        bvh_writer.write(file, plain)
    motions = [load_motion(tmp_path / name) for name in ("features.npy", "own.npz", "own.bvh")]
    for motion in motions:
        assert apart(motion.joints, plain.joints[: len(motion)]) < NEAR
    vectors = bundle.encode_motions([plain, *motions])
    assert (vectors[1:] @ vectors[0]).min() > ALIKE


def test_the_motion_of_an_array_does_not_depend_on_its_axes() -> None:
    joints = performed("walk")
    first, second = (retarget(array(j), path="a.npy").joints for j in (joints, joints @ Z_UP.T))
    np.testing.assert_allclose(first, second, atol=1e-3)
    assert isinstance(retarget(array(joints), path="a.npy"), Motion)


def read(written: bytes | np.ndarray, folder: Path) -> Take:
    if not isinstance(written, bytes):
        return array(written)
    path = folder / "a.bvh"
    path.write_bytes(written)
    (take,) = read_takes(path)
    return take
