"""BVH: the dialects that are read, and what is reported of those that are not."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.ingest.file_parts import read_take
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


def long(frames: int = 20, **changed: str) -> str:
    """The arm with many frames, some of whose lines are others."""
    head, _ = ARM.split("0 0 0 0 0 0 0 0 0\n")
    rows = [changed.get(f"row{k}", f"{k}.5 2.25 3 0 0 0 0 0 {k}.5") for k in range(1, frames + 1)]
    return head.replace("Frames: 2", f"Frames: {frames}") + "\n".join(rows) + "\n"


def test_fewer_frames_than_announced_are_read_with_a_warning(tmp_path: Path) -> None:
    take = read(tmp_path, ARM.replace("Frames: 2", "Frames: 300"))
    assert len(take.positions) == 2
    assert take.warnings == ("it announces 300 frames but holds 2 whole ones",)


def test_a_last_frame_that_is_cut_short_is_left_out(tmp_path: Path) -> None:
    take = read(tmp_path, long()[:-12])
    assert len(take.positions) == 19
    assert "cut short" in take.warnings[0]
    np.testing.assert_array_equal(take.positions, read(tmp_path, long()).positions[:19])


@pytest.mark.parametrize(
    "line", ["7.5 nan 3 0 0 0 0 0 7.5", "7.5 2.25 3 0", "7.5 # 3 0 0 0 0 0 1", "7 2 3 0 0 0 0 1e8 7"]
)
def test_a_damaged_frame_is_filled_in(tmp_path: Path, line: str) -> None:
    take = read(tmp_path, long(row7=line))
    np.testing.assert_allclose(take.positions, read(tmp_path, long()).positions, atol=0.01)
    assert "1 frame was damaged and filled in" in take.warnings[0]
    assert "frame 7" in take.warnings[0]
    assert take.rotations is not None
    assert np.isfinite(take.rotations()).all()


@pytest.mark.parametrize("separator", [" ", "  ", "\t"])
def test_decimal_commas_are_points(tmp_path: Path, separator: str) -> None:
    expected = read(tmp_path, long())
    head, frames = long().split("MOTION")
    frames = frames.replace(" ", separator).replace(".", ",").replace("Frame" + separator + "Time", "Frame Time")
    for text in (head + "MOTION" + frames, head.replace(" 0 0\n", " 0,0 0\n") + "MOTION" + frames):
        take = read(tmp_path, text)
        assert take.fps == expected.fps
        np.testing.assert_array_equal(take.positions, expected.positions)


def test_positions_are_additions_or_not_for_the_file_as_a_whole(tmp_path: Path) -> None:
    six = "CHANNELS 6 Xposition Yposition Zposition Zrotation"
    text = ARM.replace("CHANNELS 3 Zrotation", six)
    text = text.replace("End Site", f"JOINT Hand {{\nOFFSET 0 3 0\n{six} Xrotation Yrotation\nEnd Site").replace(
        "  }\n}", "  }\n}\n}"
    )
    head, _ = text.split("0 0 0 0 0 0 0 0 0\n")
    row = "0 0 0 0 0 0 0.4 0 0 0 0 0 0 3 0 0 0 0\n"  # the arm's position is nearer to zero than to its offset
    np.testing.assert_allclose(read(tmp_path, head + row + row).positions[1, 1], [0.4, 0, 0], atol=1e-9)


def test_a_number_of_countless_digits_takes_no_time(tmp_path: Path) -> None:
    assert "line 8" in reason(tmp_path, ARM.replace("OFFSET 1 0 0", "OFFSET " + "1" * 100_000))


def test_a_few_lines_do_not_become_gigabytes(tmp_path: Path) -> None:
    joints = "JOINT a\n{\nOFFSET 0 1 0\n" * 2000
    text = f"HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n{joints}{'}' * 2001}\nMOTION\nFrames: 9000\n"
    assert "no skeleton of a person" in reason(tmp_path, text + "Frame Time: 0.01\n" + "0\n" * 9000)
