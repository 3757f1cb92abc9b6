"""Whatever a person does and whatever file it comes in, up is found."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.posing import OFFSETS
from encoders.corpus.scene import ActionStep, Scene
from encoders.features.humanml3d import joints_to_features
from encoders.motion import Motion
from encoders.skeleton import INDEX, JOINTS, PARENTS
from indexer.formats.numpy_files.array_layouts import takes_of
from indexer.ingest.load import load_motion
from indexer.rigs.retarget import retarget, retarget_with_reading
from indexer.take import Take
from search.export import bvh_writer
from tests.indexer.performances import Z_UP

#: Posture -> action and direction of its program.
POSTURES = {
    "stand": ("stand", ""),
    "walk": ("walk", "forward"),
    "crawl": ("crawl", "forward"),
    "crawl backwards": ("crawl", "backward"),
    "lie on the back": ("lie", "backward"),
    "lie on the belly": ("lie", "forward"),
    "lie on the left side": ("lie", "left"),
    "lie on the right side": ("lie", "right"),
    "push-up": ("push-up", ""),
    "handstand": ("handstand", ""),
    "cartwheel": ("cartwheel", "left"),
    "climb": ("climb ladder", "up"),
    "sit on the floor": ("sit-up", ""),
}
_OTHER_NAMES = {
    "pelvis": "Hips", "spine1": "Spine", "spine2": "Spine1", "spine3": "Chest", "neck": "Neck", "head": "Head",
    "hip": "UpLeg", "knee": "Leg", "ankle": "Foot", "foot": "ToeBase", "collar": "Shoulder", "shoulder": "Arm",
    "elbow": "ForeArm", "wrist": "Hand",
}  # fmt: skip


def performed(posture: str, seed: int = 0) -> np.ndarray:
    """Joints (T, 22, 3) in metres, Y up, the floor at height 0, heading somewhere, away from the origin."""
    rng = np.random.default_rng([seed, *posture.encode()])
    action, direction = POSTURES[posture]
    joints = make_clip(Scene(((ActionStep(action, direction=direction),),)), rng, variation=0).joints[:80]
    angle = rng.uniform(0, 2 * np.pi)
    cos, sin = np.cos(angle), np.sin(angle)
    turned = joints.astype(np.float64) @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
    return turned + rng.normal(0, 0.5, 3) * np.array([1, 0, 1])


def t_pose() -> np.ndarray:
    """Joints (22, 3) of a person who stands with the arms out."""
    places = np.zeros((len(JOINTS), 3))
    for joint, name in enumerate(JOINTS[1:], start=1):
        step = OFFSETS[joint]
        if name.endswith(("elbow", "wrist")):
            step = np.array([np.linalg.norm(step) * (1 if name.startswith("left") else -1), 0, 0])
        places[joint] = places[PARENTS[joint]] + step
    return places


def along_x() -> np.ndarray:
    """A rest pose as solvers write it: every bone along +X."""
    places = np.zeros((len(JOINTS), 3))
    for joint in range(1, len(JOINTS)):
        places[joint] = places[PARENTS[joint]] + [np.linalg.norm(OFFSETS[joint]), 0, 0]
    return places


def rig(joints: np.ndarray, rest: np.ndarray) -> Take:
    """A take as a BVH file gives it, with the names of another program."""
    names = []
    for name in JOINTS:
        side, _, joint = name.rpartition("_")
        names.append(side.capitalize() + _OTHER_NAMES[joint])
    return Take(tuple(names), PARENTS.astype(np.int64), rest, joints, 20.0)


def array(joints: np.ndarray) -> Take:
    (take,) = takes_of("a.npy", joints, 20.0)
    return take


CARRIERS: dict[str, tuple[Callable[[np.ndarray], Take], str]] = {
    "standing rest pose": (lambda joints: rig(joints, t_pose()), "y"),
    "rest pose along x": (lambda joints: rig(joints, along_x()), "y"),
    "z up": (lambda joints: rig(joints @ Z_UP.T, t_pose() @ Z_UP.T), "z"),
    "floor at 1 m": (lambda joints: rig(joints + np.array([0, 1, 0]), t_pose()), "y"),
    "root pinned": (lambda joints: rig(joints - joints[:, :1], t_pose()), "y"),
    "array": (array, "y"),
    "array, z up": (lambda joints: array(joints @ Z_UP.T), "z"),
}
#: Where too little tells the two apart without a rest pose: one who crawls with Z up moves as one who climbs with Y up
#: in this heading. `--up z` sets it right.
UNDECIDABLE = {("crawl", "array, z up")}


@pytest.fixture(scope="module")
def bundle() -> Bundle:
    return Bundle.load()


@pytest.mark.parametrize("posture", POSTURES)
def test_up_is_found_and_every_carrier_means_the_plain_motion(posture: str, bundle: Bundle) -> None:
    joints = performed(posture)
    plain = retarget(array(joints).with_up("y"), path="a.npy")
    travelling = [plain]
    for carrier, (make, axis) in CARRIERS.items():
        take = make(joints)
        told = retarget(take.with_up(axis), path="a.bvh")
        if (posture, carrier) in UNDECIDABLE:
            take = take.with_up(axis)
        found, reading = retarget_with_reading(take, path="a.bvh")
        assert reading.up == axis, (carrier, reading.up_reason)
        # Not of the plain motion: rigs are posed about their rest pose and differ from it by 5 to 10 cm.
        np.testing.assert_allclose(found.joints, told.joints, atol=0.03, err_msg=carrier)
        if carrier != "root pinned":  # which has lost the way
            travelling.append(found)
    vectors = bundle.encode_motions(travelling)
    assert (vectors[1:] @ vectors[0]).min() > 0.99


@pytest.mark.parametrize("posture", POSTURES)
def test_features_and_exports_are_the_same_motion(posture: str, tmp_path: Path, bundle: Bundle) -> None:
    plain = retarget(array(performed(posture)).with_up("y"), path="a.npy")
    np.save(tmp_path / "features.npy", joints_to_features(plain.joints, retarget=False))
    np.savez(tmp_path / "own.npz", joints=plain.joints, fps=20.0, up="y")
    with (tmp_path / "own.bvh").open("wb") as file:
        bvh_writer.write(file, plain)
    read = [load_motion(tmp_path / name) for name in ("features.npy", "own.npz", "own.bvh")]
    for motion in read:
        count = len(motion)
        assert np.abs(_in_place(motion.joints) - _in_place(plain.joints[:count])).max() < 0.03
    vectors = bundle.encode_motions([plain, *read])
    assert (vectors[1:] @ vectors[0]).min() > 0.99


def _in_place(joints: np.ndarray) -> np.ndarray:
    """Joints about the pelvis, all frames turned so that the hips of the first face +Z: what features keep."""
    across = joints[0, INDEX["left_hip"]] - joints[0, INDEX["right_hip"]]
    angle = np.arctan2(across[2], across[0])
    cos, sin = np.cos(angle), np.sin(angle)
    turned: np.ndarray = (joints - joints[:, :1]) @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
    return turned


def test_the_motion_of_an_array_does_not_depend_on_its_axes() -> None:
    joints = performed("walk")
    first, second = (retarget(array(j), path="a.npy").joints for j in (joints, joints @ Z_UP.T))
    np.testing.assert_allclose(first, second, atol=1e-3)
    assert isinstance(retarget(array(joints), path="a.npy"), Motion)
