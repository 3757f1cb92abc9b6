"""ASF/AMC: the Acclaim convention, and which skeleton belongs to a motion."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.ingest.file_parts import read_take
from indexer.take import Take

ASF = """# made by a test
:version 1.10
:name test
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  nothing
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name upper
    direction 1 0 0
    length 2
    axis 0 0 90 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
    id 2
    name lower
    direction 0 3 0
    length 1
    axis 0 0 0 XYZ
    dof rz
  end
:hierarchy
  begin
    root upper
    upper lower
  end
"""
AMC = """#!OML:ASF test
:FULLY-SPECIFIED
:DEGREES
1
root 0 0 0 0 0 0
upper 0 0 0
lower 0
2
root 1 2 3 0 90 0
upper 90 0 0
lower 90
"""


def read(
    folder: Path, amc: str = AMC, asf: str | None = ASF, name: str = "01_02.amc", skeleton: str = "01.asf"
) -> Take:
    if asf is not None:
        (folder / skeleton).write_text(asf)
    (folder / name).write_text(amc)
    return read_take(folder / name)


def reason(folder: Path, **texts: str | None) -> str:
    with pytest.raises(UnreadableMotion) as error:
        read(folder, **texts)  # type: ignore[arg-type]
    return error.value.reason


def test_bones_turn_about_their_own_axes(tmp_path: Path) -> None:
    take = read(tmp_path)
    assert take.names == ("root", "upper", "lower", "lower_end")
    assert take.parents.tolist() == [-1, 0, 1, 2]
    np.testing.assert_allclose(take.rest, [[0, 0, 0], [0, 0, 0], [2, 0, 0], [2, 1, 0]])
    np.testing.assert_allclose(take.positions[0], take.rest, atol=1e-12)
    # Root: x to -z about y. Upper: its own x is the world's y, so x to -z again. Lower: y to -x about z.
    np.testing.assert_allclose(take.positions[1], [[1, 2, 3], [1, 2, 3], [-1, 2, 3], [-1 + 1, 2, 3]], atol=1e-9)


def test_the_rate_is_120_unless_given(tmp_path: Path) -> None:
    assert read(tmp_path).fps == 120
    assert read_take(tmp_path / "01_02.amc", fps=60).fps == 60


def test_radians(tmp_path: Path) -> None:
    degrees = read(tmp_path).positions
    half = f"{np.pi / 2:.15f}"
    asf = ASF.replace("angle deg", "angle rad").replace("axis 0 0 90", f"axis 0 0 {half}")
    in_radians = read(tmp_path, AMC.replace("DEGREES", "RADIANS").replace("90", half), asf).positions
    np.testing.assert_allclose(in_radians, degrees, atol=1e-9)


@pytest.mark.parametrize("name", ["01_02.amc", "01.amc", "01-walk.amc", "other.amc"])
def test_the_skeleton_is_found_by_subject_or_because_it_is_the_only_one(tmp_path: Path, name: str) -> None:
    assert len(read(tmp_path, name=name).names) == 4


def test_among_several_skeletons_the_one_of_the_subject_is_taken(tmp_path: Path) -> None:
    (tmp_path / "0.asf").write_text(ASF.replace("length 2", "length 5"))
    (tmp_path / "01_.asf").write_text("no skeleton")
    assert read(tmp_path).rest[2, 0] == 2


def test_a_skeleton_named_in_the_header_is_taken(tmp_path: Path) -> None:
    (tmp_path / "aaa.asf").write_text(ASF.replace("length 2", "length 5"))
    take = read(tmp_path, AMC.replace("ASF test", "ASF F:\\USER DATA\\liu.ASF"), name="walk.amc", skeleton="liu.asf")
    assert take.rest[2, 0] == 2


def test_a_bone_the_motion_leaves_out_keeps_its_rest(tmp_path: Path) -> None:
    take = read(tmp_path, "\n".join(line for line in AMC.splitlines() if "lower" not in line))
    assert take.positions.shape == (2, 4, 3)


@pytest.mark.parametrize(
    ("amc", "message"),
    [
        (AMC.replace("upper", "tail"), "no bone 'tail'"),
        (AMC.replace("upper 90 0 0", "upper 90 0 nan"), "1 of 2 frames are damaged, the first of them frame 2"),
        (
            AMC.replace("lower 90", "lower 9 9").replace("lower 0", "lower 0 0"),
            "lower has 2 values a frame, its skeleton 1",
        ),
        (AMC.split("1\nroot")[0], "no frames"),
        (AMC.replace("1\nroot", "root").replace("2\nroot", "root"), "frame, its number"),
    ],
)
def test_what_is_broken_in_the_motion_is_named(tmp_path: Path, amc: str, message: str) -> None:
    assert re.search(message, reason(tmp_path, amc=amc))


@pytest.mark.parametrize(
    ("asf", "message"),
    [
        (None, "skeleton is missing"),
        (ASF.split(":hierarchy")[0], "no :hierarchy"),
        (ASF.replace("    upper lower\n", "    upper lower missing\n"), "missing"),
        (ASF.replace("    upper lower\n", "    upper root\n"), "twice"),
        (ASF.replace("direction 1 0 0", "direction 1 0"), "three numbers"),
        (ASF.replace("dof rz", "dof rw"), "rw"),
        (ASF.replace("length 2", "length nan"), "length"),
    ],
)
def test_what_is_broken_in_the_skeleton_is_named(tmp_path: Path, asf: str | None, message: str) -> None:
    assert message in reason(tmp_path, asf=asf)


def test_a_skeleton_alone_is_no_motion(tmp_path: Path) -> None:
    (tmp_path / "01.asf").write_text(ASF)
    with pytest.raises(UnreadableMotion, match=r"\.amc"):
        read_take(tmp_path / "01.asf")


@pytest.mark.parametrize("stated", [":SAMPLES-PER-SECOND 30", ":samples-per-second\n30", ":Samples-Per-Second: 30.0"])
def test_the_rate_that_a_header_states_is_taken(tmp_path: Path, stated: str) -> None:
    assert read(tmp_path).fps == 120
    take = read(tmp_path, AMC.replace(":DEGREES", f":UNKNOWN word 5\n{stated}\n:DEGREES"))
    assert take.fps == 30
    np.testing.assert_array_equal(take.positions, read(tmp_path).positions)


def test_a_stated_rate_that_cannot_be_is_named(tmp_path: Path) -> None:
    assert "SAMPLES-PER-SECOND 0 is no frame rate" in reason(tmp_path, amc=":SAMPLES-PER-SECOND 0\n" + AMC)


def many(frames: int) -> list[str]:
    return [f"{k}\nroot {k} 2 3 0 90 0\nupper 90 0 0\nlower 90\n" for k in range(1, frames + 1)]


def test_a_last_frame_that_is_cut_short_is_left_out(tmp_path: Path) -> None:
    for cut in (1, 3, 12, 25):
        take = read(tmp_path, ":DEGREES\n" + "".join(many(20))[:-cut])
        assert len(take.positions) == 20 - (cut > 1)
        assert cut == 1 or "cut short" in take.warnings[0]


@pytest.mark.parametrize("damage", ["root 7 nan 3", "root 7", "root 7 2e99 3", "toor 7 2 3"])
def test_a_damaged_frame_is_filled_in(tmp_path: Path, damage: str) -> None:
    text = ":DEGREES\n" + "".join(many(20))
    take = read(tmp_path, text.replace("root 7 2 3", damage))
    np.testing.assert_allclose(take.positions, read(tmp_path, text).positions, atol=1e-9)
    assert "1 frame was damaged and filled in" in take.warnings[0]
    assert "frame 7" in take.warnings[0]


def test_decimal_commas_are_points(tmp_path: Path) -> None:
    text = AMC.replace("root 1 2 3", "root 1.5 2.25 3.0")
    expected = read(tmp_path, text, ASF.replace("length 2", "length 2.5")).positions
    comma = text.replace(".", ",").replace("1,0", "1.0")
    np.testing.assert_array_equal(read(tmp_path, comma, ASF.replace("length 2", "length 2,5")).positions, expected)


def test_a_damaged_skeleton_beside_the_right_one_does_no_harm(tmp_path: Path) -> None:
    (tmp_path / "aa.asf").write_text("# damaged")
    (tmp_path / "01.asf").write_text(ASF.split(":hierarchy")[0])
    assert len(read(tmp_path, skeleton="zz.asf").positions) == 2
    (tmp_path / "zz.asf").unlink()
    with pytest.raises(UnreadableMotion, match=r"01\.asf.*no :hierarchy"):
        read_take(tmp_path / "01_02.amc")
