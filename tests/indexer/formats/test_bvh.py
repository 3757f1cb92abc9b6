"""BVH: the dialects that are read, and what is reported of those that are not."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_take
from indexer.take import Take

ARM = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Arm
  {
    OFFSET 1 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 2 0 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.05
0 0 0 0 0 0 0 0 0
1 2 3 90 0 0 0 0 90
"""
LAST = [[1, 2, 3], [1, 3, 3], [1, 3, 1]]  # the root turned about z, the arm then about its own y


def read(folder: Path, text: str | bytes, name: str = "a.bvh", **options: float) -> Take:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_take(path, **options)


def reason(folder: Path, text: str | bytes) -> str:
    with pytest.raises(UnreadableMotion) as error:
        read(folder, text)
    assert error.value.path.endswith("a.bvh")
    return error.value.reason


def test_forward_kinematics(tmp_path: Path) -> None:
    take = read(tmp_path, ARM)
    assert take.names == ("Hips", "Arm", "Arm_end")
    assert take.parents.tolist() == [-1, 0, 1]
    assert take.fps == 20
    np.testing.assert_allclose(take.rest, [[0, 0, 0], [1, 0, 0], [3, 0, 0]])
    np.testing.assert_allclose(take.positions[0], [[0, 0, 0], [1, 0, 0], [3, 0, 0]])
    np.testing.assert_allclose(take.positions[1], LAST, atol=1e-9)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace(" ", "\t"),
        lambda text: text.replace("1 2 3 90 0 0 0 0 90", "1, 2, 3, 90,0,0, 0,0,90"),
        lambda text: text.replace("90", "9.0e1").replace("0.05", "5e-2"),
        lambda text: text.replace("1 2 3 90", "1 2\n3 90"),
        lambda text: "\ufeff" + text,
        lambda text: text.lower().replace("hips", "Hips").replace("arm", "Arm"),
        lambda text: text.upper().replace("HIPS", "Hips").replace("ARM", "Arm"),
        lambda text: text.replace("ROOT Hips\n{", "ROOT Hips {").replace("JOINT Arm\n  {", "JOINT Arm {"),
        lambda text: text.replace("End Site", "End Site tip of the arm"),
        lambda text: text.replace("MOTION\n", "MOTION   \n\n").replace("Frames: 2", "Frames:\t2  "),
        lambda text: text + "\n\n  \n",
        lambda text: text.replace("Frames: 2\n", ""),
        lambda text: text.replace("Frames: 2", "Frames: 1"),
    ],
)
def test_dialects_are_read_alike(tmp_path: Path, change) -> None:  # type: ignore[no-untyped-def]
    take = read(tmp_path, change(ARM))
    assert take.names == ("Hips", "Arm", "Arm_end")
    np.testing.assert_allclose(take.positions[1], LAST, atol=1e-9)


def test_names_may_hold_spaces_and_any_letters(tmp_path: Path) -> None:
    take = read(tmp_path, ARM.replace("Arm", "左 Arm 1"))
    assert take.names[1] == "左 Arm 1"
    assert read(tmp_path, ARM.replace("Arm", "Bras-é").encode("latin-1")).names[1] == "Bras-é"


def test_several_roots(tmp_path: Path) -> None:
    hierarchy, motion = ARM.split("MOTION\n")
    second = hierarchy.replace("HIERARCHY\n", "").replace("Hips", "Prop").replace("Arm", "Blade")
    rows = motion.splitlines()
    doubled = "\n".join([*rows[:2], rows[2] + " " + rows[3], rows[3] + " " + rows[2]])
    take = read(tmp_path, hierarchy + second + "MOTION\n" + doubled)
    assert take.parents.tolist() == [-1, 0, 1, -1, 3, 4]
    np.testing.assert_allclose(take.positions[0, 3:], LAST, atol=1e-9)


def test_channels_count_and_order_are_free(tmp_path: Path) -> None:
    text = ARM.replace(
        "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
        "CHANNELS 4 Zrotation Zposition Yposition Xposition",
    ).replace("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 1 Yrotation")
    head, _ = text.split("0 0 0 0 0 0 0 0 0\n")
    take = read(tmp_path, head + "0 0 0 0 0\n90 3 2 1 90\n")
    np.testing.assert_allclose(take.positions[1], LAST, atol=1e-9)


@pytest.mark.parametrize(("moves", "place"), [("1 0 0", [1, 0, 0]), ("0 0 0", [1, 0, 0]), ("1.5 0.5 0", [1.5, 0.5, 0])])
def test_a_joints_positions_replace_its_offset_unless_they_are_added_to_it(
    tmp_path: Path, moves: str, place: list[float]
) -> None:
    text = ARM.replace("CHANNELS 3 Zrotation", "CHANNELS 6 Xposition Yposition Zposition Zrotation")
    head, _ = text.split("0 0 0 0 0 0 0 0 0\n")
    row = f"0 0 0 0 0 0 {moves} 0 0 0\n"
    np.testing.assert_allclose(read(tmp_path, head + row + row).positions[1, 1], place, atol=1e-9)


def test_the_given_rate_wins(tmp_path: Path) -> None:
    assert read(tmp_path, ARM, fps=60).fps == 60


@pytest.mark.parametrize(
    ("frame_time", "fps"), [("0.0083333", 120), ("0.03333", 30), ("0.0333667", 29.97), (".04", 25)]
)
def test_frame_times_written_with_few_digits_mean_whole_rates(tmp_path: Path, frame_time: str, fps: float) -> None:
    assert read(tmp_path, ARM.replace("0.05", frame_time)).fps == pytest.approx(fps, rel=1e-5)


@pytest.mark.parametrize("frame_time", ["0", "-0.03", "nan", "inf", "1e-9", "1e9"])
def test_an_absurd_rate_is_named_unless_the_true_one_is_given(tmp_path: Path, frame_time: str) -> None:
    text = ARM.replace("0.05", frame_time)
    assert "Frame Time" in reason(tmp_path, text)
    assert read(tmp_path, text, fps=30).fps == 30


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text.split("MOTION")[0], "no MOTION"),
        (lambda text: text.split("0 0 0 0 0 0 0 0 0")[0], "no frames"),
        (lambda text: text.split("0 0 0 0 0 0 0 0 0")[0] + "0 0 0 0", "no frames"),
        (lambda text: text.replace("90 0 0 0 0 90", "90 0 x 0 0 90"), "frame 2 holds values that are no numbers.*'x'"),
        (lambda text: text.replace("90 0 0 0 0 90", "90 0 nan 0 0 90"), "frame 2 holds values that are no numbers"),
        (lambda text: text.replace("Frame Time: 0.05\n", ""), "Frame Time"),
        (lambda text: text.replace("    End Site\n    {\n", "    End Site\n"), "cannot be read|opening brace|order"),
        (lambda text: text.replace("}\nMOTION", "MOTION"), "not closed|closing brace"),
        (lambda text: text.replace("CHANNELS 3 Z", "CHANNELS 4 Z"), "CHANNELS 4 names 3"),
        (lambda text: text.replace("OFFSET 1 0 0", "OFFSET 1 0"), "line 8"),
        (lambda text: text.replace("CHANNELS 3 Zrotation Xrotation", "CHANNELS 3 Zrotation Wrotation"), "line 9|names"),
        (lambda text: "HIERARCHY\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n", "no joints"),
        (lambda text: text.replace("OFFSET 1 0 0", "OFFSET 1 0 nan"), "line 8"),
    ],
)
def test_what_is_broken_is_named(tmp_path: Path, change, message: str) -> None:  # type: ignore[no-untyped-def]
    assert re.search(message, reason(tmp_path, change(ARM)))


def test_a_header_with_countless_joints_is_refused(tmp_path: Path) -> None:
    joints = "JOINT a\n{\nOFFSET 0 0 0\nCHANNELS 0\n" * 5000
    text = "HIERARCHY\n" + joints.replace("JOINT", "ROOT", 1) + "}" * 5000
    assert "2048 joints" in reason(tmp_path, text + "\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n")
