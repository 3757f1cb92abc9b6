"""`.npy` and `.npz` files: checked before anything is allocated, never unpickled, refused with a reason."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS
from indexer.formats.numpy_files import npy, npz, npz_archive
from indexer.formats.reading import read_takes
from tests.indexer.bodies import archived, body, parameters, saved


def reason(path: Path, data: bytes) -> str:
    path.write_bytes(data)
    with pytest.raises(UnreadableMotion) as error:
        read_takes(path)
    return error.value.reason


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (saved(np.full((5, 22, 3), np.nan)), "frame 1 holds"),
        (saved(np.zeros((5, 22, 3), complex)), "an array of complex128 is no motion"),
        (saved(np.zeros((5, 22, 3), bool)), "an array of bool is no motion"),
        (saved(np.zeros((5, 22, 3)))[:-8], "cut short"),
        (saved(np.zeros((5, 22, 3))).replace(b"(5, 22, 3)", b"(5000000000, 22, 3)")[:200], "more than|damaged"),
        (saved(np.zeros((5, 22, 3))).replace(b"(5, 22, 3)", b"(-1,22, 3)"), "no shape"),
        (saved(np.zeros((5, 22, 3))).replace(b"(5, 22, 3)", b"(True,2,3)"), "no shape"),
        (saved(np.zeros((5, 22, 3))).replace(b"(5, 22, 3)", b"(5, 22, 3 "), "header is damaged"),
        (b"\x93NUMPY\x01\x00\xff\xffrubbish", "header is damaged"),
        (b"\x93NUMPY\x09\x09", "header is damaged"),
    ],
)
def test_arrays_that_are_no_motion(tmp_path: Path, data: bytes, message: str) -> None:
    assert message.split("|")[0] in (found := reason(tmp_path / "a.npy", data)) or message.split("|")[-1] in found


def test_a_pickled_result_is_never_opened_and_one_line_says_how_to_save_it(tmp_path: Path) -> None:
    path = tmp_path / "results.npy"
    joints = body()
    found = reason(path, saved(np.array({"motion": joints.transpose(1, 2, 0)[None], "text": ["walk"]}, dtype=object)))
    advice = found.split("if you trust it: ")[1]
    assert advice == "np.save('motion.npy', np.load('results.npy', allow_pickle=True).item()['motion'])"
    np.save(tmp_path / "motion.npy", np.load(path, allow_pickle=True).item()["motion"])
    np.testing.assert_array_equal(read_takes(tmp_path / "motion.npy")[0].positions, joints)


@pytest.mark.parametrize("kind", ["<f2", "<f4", ">f4", ">f8", "<i2", "<i4"])
def test_numbers_of_any_kind_and_order_are_read(tmp_path: Path, kind: str) -> None:
    joints = np.round(body() * 1000).astype(kind)
    for array in (joints, np.asfortranarray(joints)):
        (tmp_path / "a.npy").write_bytes(saved(array))
        np.testing.assert_array_equal(read_takes(tmp_path / "a.npy")[0].positions, joints.astype(float))


@pytest.mark.parametrize("packed", [True, False])
@pytest.mark.parametrize(("more", "fps"), [({"fps": 30.0}, 30), ({"fps": np.array([30])}, 30), ({}, 20)])
def test_archives_of_joints_with_their_rate(tmp_path: Path, packed: bool, more: dict[str, object], fps: float) -> None:
    joints = np.random.default_rng(0).normal(size=(5, 22, 3)).astype(np.float32)
    path = tmp_path / "a.npz"
    path.write_bytes(archived(packed, joints=joints, unrelated=np.array(["x"]), **more))
    (take,) = read_takes(path)
    assert (take.names, take.fps) == (JOINTS, fps)
    np.testing.assert_array_equal(take.positions, joints)
    assert read_takes(path, fps=60)[0].fps == 60


@pytest.mark.parametrize("name", ["posed_joints", "joints3d", "keypoints3d", "positions", "xyz", "arr_0", "whatever"])
def test_joints_go_by_many_names(name: str) -> None:
    joints = body()
    more = {"foot_contacts": np.zeros((40, 4)), "local_rot_mats": np.zeros((40, 22, 3, 3)), "root": joints[:, 0]}
    (take,) = npz.read("a.npz", archived(**{name: joints}, **more), fps=30)
    np.testing.assert_array_equal(take.positions, joints)
    np.testing.assert_array_equal(npz.read("a.npz", archived(**{name: joints[None]}))[0].positions, joints)


def test_a_generator_s_joints_have_the_rate_of_its_models_unless_they_state_one() -> None:
    (take,) = npz.read("a.npz", archived(posed_joints=body()))
    assert take.fps == 30
    assert "no frame rate; 30" in take.warnings[0]
    (take,) = npz.read("a.npz", archived(posed_joints=body(), fps=24))
    assert (take.fps, take.warnings) == (24, ())


def test_a_padded_batch_is_cut_to_its_lengths() -> None:
    batch = np.stack([body(seed=0), body(seed=1)])
    takes = npz.read("a.npz", archived(motion=batch.transpose(0, 2, 3, 1), lengths=np.array([40, 15])))
    assert [(take.name, len(take.positions)) for take in takes] == [("1", 40), ("2", 15)]


def test_joints_beside_parameters_are_preferred_as_they_are_of_the_person() -> None:
    angles, way = parameters()
    (take,) = npz.read("a.npz", archived(poses=angles, trans=way, joints=body() * 1.2))
    np.testing.assert_array_equal(take.positions, body() * 1.2)


def test_the_axis_that_an_archive_states_is_up_for_certain() -> None:
    (take,) = npz.read("a.npz", archived(joints=body(), up=np.array("z")))
    assert (take.up, take.up_is_certain) == ("z", True)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (archived(a=body(), b=body()), r"its joints \(a \(40, 22, 3\), b .*name the right one 'joints'"),
        (archived(trans=np.zeros((5, 3)), betas=np.zeros(10)), "it holds no array .*but betas, trans"),
        (archived(), "nor any other"),
        (archived(joints=np.zeros((5, 23, 3))), "23 joints"),
        (archived(joints=np.zeros((5, 22, 4))), "shape"),
        (archived(joints=np.array([{"a": 1}], dtype=object)), "never opened"),
        (archived(joints=np.zeros((5, 22, 3)), fps=np.array([{}], dtype=object)), "never opened"),
        (archived(joints=np.zeros((5, 22, 3)), fps=np.zeros(2)), "no number"),
        (archived(joints=np.zeros((5, 22, 3)), fps=-3.0), "no frame rate"),
        (archived(joints=np.zeros((5, 22, 3)), fps=np.nan), "no frame rate"),
        (archived(joints=np.zeros((5, 22, 3)), up=np.array("w")), "no axis"),
        (archived(joints=np.zeros((5, 22, 3)), up=np.zeros(3)), "float64"),
        (archived(joints=np.zeros((5, 22, 3)))[:-30], "damaged"),
        (archived(False, joints=np.ones((5, 22, 3))).replace(b"\xf0?", b"\xf1?", 1), "damaged"),
        (b"PK\x03\x04rubbish", "damaged"),
        (archived(joints=np.zeros((1000, 22, 3))), "larger than"),
    ],
)
def test_archives_that_are_no_motion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, message: str
) -> None:
    monkeypatch.setattr(npz_archive, "MAX_BYTES", 100_000)
    (tmp_path / "a.npz").write_bytes(data)
    with pytest.raises(UnreadableMotion, match=message):
        read_takes(tmp_path / "a.npz")


@pytest.mark.parametrize("kind", [np.int8, np.float32])
def test_an_archive_that_unpacks_to_very_much_is_refused_at_once(kind: type) -> None:
    data = archived(joints=np.zeros((600_000, 22, 3), kind), fps=10_000)
    assert len(data) < 400_000
    began = time.process_time()
    with pytest.raises(UnreadableMotion, match="cut it into takes"):
        npz.read("a.npz", data)
    assert time.process_time() - began < 2


SOURCES = [
    saved(body(5)),
    archived(joints=body(5), fps=30.0, up=np.array("y")),
    archived(False, poses=parameters(5)[0], trans=parameters(5)[1], mocap_framerate=120.0),
    archived(posed_joints=np.stack([body(4), body(4)]), lengths=np.array([3, 4])),
]


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    source=st.sampled_from(SOURCES),
    places=st.lists(st.tuples(st.integers(0, 1 << 20), st.integers(0, 255)), max_size=4),
    cut=st.integers(0, 40),
)
def test_damaged_files_are_read_or_refused(
    tmp_path: Path, source: bytes, places: list[tuple[int, int]], cut: int
) -> None:
    data = bytearray(source[: len(source) - cut])
    for place, value in places:
        data[place % min(len(data), 400 if value % 2 else len(data))] = value
    path = tmp_path / ("a.npy" if source.startswith(b"\x93") else "a.npz")
    path.write_bytes(data)
    with contextlib.suppress(UnreadableMotion):
        assert all(take.positions.ndim == 3 for take in read_takes(path))


@settings(max_examples=200, deadline=None)
@given(
    shape=st.lists(st.sampled_from([0, 1, 2, 3, 5, 21, 22, 24, 30, 66, 72, 251, 263]), max_size=5).filter(
        lambda shape: np.prod(shape) < 1e5
    ),
    kind=st.sampled_from(["<f4", "<f8", ">f8", "<i4", "u1", "<U3", "?", "<c8", "M8[s]"]),
    names=st.lists(st.sampled_from(["joints", "poses", "trans", "fps", "up", "lengths", "x"]), unique=True),
)
def test_arrays_of_any_shape_are_read_or_refused(shape: list[int], kind: str, names: list[str]) -> None:
    array = np.ones(shape, kind)
    with contextlib.suppress(UnreadableMotion):
        npy.read("a.npy", saved(array))
    with contextlib.suppress(UnreadableMotion):
        npz.read("a.npz", archived(**dict.fromkeys(names, array)))
