"""Parameters of SMPL, SMPL-H and SMPL-X in all spellings, against a plain loop over frames and joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS
from indexer.formats.numpy_files import npy, npz, smpl
from indexer.ingest.load import load_motion
from indexer.take import Take
from tests.indexer.bodies import archived, joints_of, parameters, saved

ANGLES, WAY = parameters(up="z")
JOINTS_OF = joints_of(ANGLES, WAY)
ROOT, BODY = ANGLES[:, :3], ANGLES[:, 3:]


def padded(width: int) -> np.ndarray:
    """The body's rotations with random ones of hands and face after them."""
    more = np.random.default_rng(0).normal(size=(len(ANGLES), width - 66))
    return np.concatenate([ANGLES, more], axis=1)


def read(**arrays: object) -> Take:
    (take,) = npz.read("a.npz", archived(**arrays))
    return take


def test_many_frames_at_once_are_turned_as_one_after_another() -> None:
    angles, way = parameters(seed=3)
    rest = smpl.rest_joints()
    found = smpl.forward_kinematics(angles.reshape(-1, 22, 3) * 7, way, rest)  # turns beyond a half, too
    np.testing.assert_allclose(found, joints_of(angles * 7, way, rest), atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_axis_angles_of_matrices_are_those_they_came_from(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = rng.normal(size=(400, 3))
    angles *= (rng.uniform(0, np.pi, 400) / np.linalg.norm(angles, axis=-1))[:, None]
    angles[:3] = np.diag([np.pi, 1e-9, 0])  # a half turn, nearly none, none
    found = smpl.axis_angles(smpl.rotation_matrices(angles))
    np.testing.assert_allclose(found, angles, atol=1e-7)


@pytest.mark.parametrize("is_flat", [False, True])
def test_rotations_may_be_matrices(is_flat: bool) -> None:
    matrices = smpl.rotation_matrices(ANGLES.reshape(len(ANGLES), 22, 3))
    root, body = matrices[:, :1], matrices[:, 1:]
    if is_flat:
        root, body = matrices[:, 0], body.reshape(len(body), -1)
    take = read(root_orient=root, pose_body=body, trans=WAY, mocap_frame_rate=60.0)
    np.testing.assert_allclose(take.positions, JOINTS_OF, atol=1e-6)


def test_no_rotation_is_the_rest_pose() -> None:
    np.testing.assert_array_equal(smpl.rotation_matrices(np.zeros((2, 3))), np.broadcast_to(np.eye(3), (2, 3, 3)))
    joints = smpl.forward_kinematics(np.zeros((1, 22, 3)), np.zeros((1, 3)), smpl.rest_joints())
    np.testing.assert_allclose(joints[0], smpl.rest_joints())


def test_the_template_stands_with_arms_outstretched_and_is_symmetric() -> None:
    rest = dict(zip(JOINTS, smpl.rest_joints(), strict=True))
    height = rest["head"][1] - rest["left_foot"][1]
    assert 1.3 < height < 1.6
    assert abs(rest["left_wrist"][1] - rest["left_shoulder"][1]) < 0.05
    assert rest["left_foot"][2] > rest["left_ankle"][2]
    for name in JOINTS:
        if name.startswith("left"):
            np.testing.assert_allclose(rest[name] * (-1, 1, 1), rest[name.replace("left", "right")])


@pytest.mark.parametrize("width", [66, 72, 156, 165])
def test_amass_of_every_model_is_z_up_at_the_rate_it_states(width: int) -> None:
    take = read(
        poses=padded(width).astype(np.float32),
        trans=WAY,
        betas=np.zeros(16),
        gender=np.array("neutral"),
        mocap_framerate=np.float64(120),
    )
    assert (take.names, take.fps, take.up, take.up_is_certain, take.warnings) == (JOINTS, 120, "z", False, ())
    np.testing.assert_allclose(take.positions, JOINTS_OF, atol=1e-5)


@pytest.mark.parametrize(
    ("arrays", "up", "fps"),
    [
        ({"root_orient": ROOT, "pose_body": BODY, "pose_hand": padded(156)[:, 66:], "trans": WAY,
          "mocap_frame_rate": np.array([60.0]), "surface_model_type": np.array("smplx")}, "z", 60),
        ({"poses": padded(165), "root_orient": ROOT, "pose_body": BODY, "trans": WAY, "fps": 30}, "z", 30),
        ({"global_orient": ROOT, "body_pose": padded(72)[:, 3:], "transl": WAY, "fps": 25}, "y", 25),
        ({"global_orient": ROOT[:, None], "body_pose": BODY.reshape(-1, 21, 3), "transl": WAY, "fps": 25}, "y", 25),
        ({"smpl_poses": padded(72), "smpl_trans": WAY * 93.0, "smpl_scaling": np.array([93.0]), "fps": 60}, "y", 60),
        ({"fullpose": padded(165), "transl": WAY, "framerate": 120}, "z", 120),
    ],
)  # fmt: skip
def test_every_spelling_gives_the_same_joints(arrays: dict[str, object], up: str, fps: float) -> None:
    take = read(**arrays)
    np.testing.assert_allclose(take.positions, JOINTS_OF, atol=1e-9)
    assert (take.up, take.fps, take.warnings) == (up, fps, ())


def test_what_is_not_stated_is_taken_for_granted_aloud() -> None:
    take = read(poses=padded(72))
    assert take.fps == 30
    assert ["no translation" in take.warnings[0], "no frame rate; 30" in take.warnings[1]] == [True, True]
    assert read(smpl_poses=padded(72), smpl_trans=WAY).fps == 60
    (given,) = npz.read("a.npz", archived(poses=padded(72), trans=WAY), fps=50)
    assert (given.fps, given.warnings) == (50, ())


def test_an_archive_of_parameters_is_the_motion_that_its_joints_are(tmp_path: Path) -> None:
    """AMASS's is Z-up, joints saved as an array are Y-up: both stand the same way, and the body is the same."""
    (tmp_path / "a.npz").write_bytes(archived(poses=padded(156), trans=WAY, mocap_framerate=20.0))
    np.save(tmp_path / "b.npy", JOINTS_OF[:, :, [0, 2, 1]] * (1, 1, -1))
    amass, joints = load_motion(tmp_path / "a.npz"), load_motion(tmp_path / "b.npy")
    np.testing.assert_allclose(amass.joints, joints.joints, atol=1e-4)


def test_motion_x_is_one_array_of_322_numbers() -> None:
    array = np.random.default_rng(0).normal(size=(len(ANGLES), 322))
    array[:, :66], array[:, 309:312] = ANGLES, WAY
    (take,) = npy.read("a.npy", saved(array))
    np.testing.assert_allclose(take.positions, JOINTS_OF, atol=1e-9)
    assert (take.fps, take.up) == (30, "y")


@pytest.mark.parametrize("name", ["SMPLH_MALE.npz", "smplh/male/model.npz", "SMPLH_NEUTRAL.npz"])
def test_a_licensed_body_model_gives_the_person_s_own_joints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    rng = np.random.default_rng(0)
    template, directions, regressor = rng.normal(size=(60, 3)), rng.normal(size=(60, 3, 10)), rng.random((52, 60))
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    np.savez(tmp_path / name, v_template=template, shapedirs=directions, J_regressor=regressor, f=np.zeros(3))
    betas = rng.normal(size=16)  # AMASS states more than the model has
    shaped = template + sum(directions[:, :, n] * betas[n] for n in range(10))
    parameters = {"poses": padded(156), "trans": WAY, "fps": 30, "betas": betas, "gender": np.array("male")}
    monkeypatch.setenv("MOTIONSEEK_BODY_MODELS", str(tmp_path))
    own = joints_of(ANGLES, WAY, regressor[:22] @ shaped)
    np.testing.assert_allclose(read(**parameters).positions, own, atol=1e-9)
    np.testing.assert_allclose(read(**parameters | {"poses": padded(165)}).positions, JOINTS_OF, atol=1e-9)
    monkeypatch.delenv("MOTIONSEEK_BODY_MODELS")
    np.testing.assert_allclose(read(**parameters).positions, JOINTS_OF, atol=1e-9)


@pytest.mark.parametrize(
    "arrays",
    [
        {"x": np.zeros(3)},
        {"v_template": np.zeros((9, 3)), "shapedirs": np.zeros((9, 3, 10)), "J_regressor": np.zeros((24, 8))},
        {"v_template": np.zeros((9, 3)), "shapedirs": np.zeros((9, 4, 10)), "J_regressor": np.zeros((24, 9))},
    ],
)
def test_what_is_no_body_model_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arrays: dict[str, np.ndarray]
) -> None:
    np.savez(tmp_path / "SMPL_NEUTRAL.npz", **arrays)  # type: ignore[arg-type]
    monkeypatch.setenv("MOTIONSEEK_BODY_MODELS", str(tmp_path))
    with pytest.raises(UnreadableMotion, match=r"SMPL_NEUTRAL.npz: this is no body model"):
        read(poses=padded(72), trans=WAY, betas=np.zeros(10))


@pytest.mark.parametrize("betas", [np.zeros(()), np.zeros(0), np.zeros((5, 10)), np.zeros((0, 10)), np.zeros((2, 0))])
def test_a_shape_of_any_shape_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, betas: np.ndarray) -> None:
    model = {"v_template": np.ones((9, 3)), "shapedirs": np.ones((9, 3, 10)), "J_regressor": np.ones((24, 9))}
    np.savez(tmp_path / "SMPL_NEUTRAL.npz", **model)  # type: ignore[arg-type]
    monkeypatch.setenv("MOTIONSEEK_BODY_MODELS", str(tmp_path))
    assert read(poses=padded(72), trans=WAY, betas=betas).positions.shape == JOINTS_OF.shape


@pytest.mark.parametrize(
    ("arrays", "reason"),
    [
        ({"poses": np.zeros((5, 63)), "trans": np.zeros((5, 3))}, "turn 21 joints"),
        ({"poses": np.zeros((5, 71)), "trans": np.zeros((5, 3))}, "no rotation of joints"),
        ({"poses": np.zeros((5, 72)), "trans": np.zeros((6, 3))}, "do not match"),
        ({"poses": np.zeros((5, 72)), "trans": np.zeros((5, 2))}, "do not match"),
        ({"poses": np.zeros((0, 72)), "trans": np.zeros((0, 3))}, "no rotation of joints"),
        ({"poses": np.full((5, 72), np.nan), "trans": np.zeros((5, 3))}, "frame 1 holds values"),
        ({"poses": np.zeros((5, 72)), "trans": np.zeros((5, 3)), "mocap_framerate": 0.0}, "no frame rate"),
        ({"global_orient": np.zeros((4, 3)), "body_pose": np.zeros((5, 69))}, "do not match"),
        ({"smpl_poses": np.zeros((5, 72)), "smpl_trans": np.zeros((5, 3)), "smpl_scaling": 0.0}, "positive"),
        ({"poses": np.array([{}], dtype=object)}, "never opened"),
    ],
)  # fmt: skip
def test_parameters_that_make_no_sense_are_refused(arrays: dict[str, object], reason: str) -> None:
    with pytest.raises(UnreadableMotion, match=reason):
        read(**arrays)
