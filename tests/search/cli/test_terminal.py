"""What is printed: whole lines for programs, tables for people, whatever the names and however narrow the terminal."""

from __future__ import annotations

import pytest

from search.cli import terminal
from search.hits import Hit, Hits
from search.query.question import Question

NAME = "sehr langer Ordner/モーション_歩く_とても長い名前_final_v2.bvh"


@pytest.fixture
def found() -> Hits:
    return Hits(
        [
            Hit(1, NAME, 0.5, "plausible", 0.0, 3.0, 9.0, "walks\tfar\nand wide", 1),
            Hit(2, "a  b.bvh", 0.25, "weak", 1.0, 2.0, 9.0, "", 2),
        ]
    )


@pytest.fixture
def width(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> int:
    monkeypatch.setattr(terminal, "is_terminal", lambda: True)
    monkeypatch.setenv("COLUMNS", str(request.param))
    return int(request.param)


def test_a_pipe_gets_a_line_a_hit_with_its_name_as_it_is(found: Hits, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.hits(found, "walks", as_json=False)
    first, second = capsys.readouterr().out.splitlines()
    assert first.split("\t") == ["1", "0.500", "plausible", "0.0", "3.0", NAME, "walks far and wide", ""]
    assert second.split("\t") == ["2", "0.250", "weak", "1.0", "2.0", "a  b.bvh", "", ""]


def test_no_moment_is_said_so(capsys: pytest.CaptureFixture[str]) -> None:
    terminal.moments(Question.of("walks, then sits"), Hits(), as_json=False)
    said = capsys.readouterr()
    assert said.out == ""
    assert "nothing found" in said.err


@pytest.mark.parametrize("width", [30, 40, 60, 80, 200], indirect=True)
def test_nothing_is_lost_or_too_wide(found: Hits, width: int, capsys: pytest.CaptureFixture[str]) -> None:
    from rich.cells import cell_len

    terminal.hits(found, "walks", as_json=False)
    out = capsys.readouterr().out
    assert max(map(cell_len, out.splitlines())) <= width
    assert "".join(NAME.split()) in "".join(out.split()) or width == 80, "a table breaks a name between other cells"
    for cell in ("0.500", "plausible", "3.0", "far"):
        assert cell in out


@pytest.mark.parametrize("width", [40], indirect=True)
def test_a_narrow_terminal_gets_the_name_below_the_numbers(
    found: Hits, width: int, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal.hits(found[1:], "walks", as_json=False)
    assert [line.rstrip() for line in capsys.readouterr().out.splitlines()] == [
        "2  0.250  weak  1.0  2.0",
        "   a  b.bvh",
    ]


@pytest.mark.parametrize("width", [120], indirect=True)
def test_of_no_rows_nothing_is_printed(width: int, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.table(("", "clip"), [])
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("width", [120], indirect=True)
def test_a_name_cannot_steer_the_terminal(width: int, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.table(("file", "reason"), [("a\x1b[2Jb\x07.bvh", "x")])
    out = capsys.readouterr().out
    assert "\x1b" not in out
    assert "\x07" not in out


@pytest.mark.parametrize("width", [120], indirect=True)
def test_colours_can_be_switched_off(
    found: Hits, width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    terminal.hits(found, "walks", as_json=False)
    assert "\x1b[33mplausible" in capsys.readouterr().out
    monkeypatch.setenv("NO_COLOR", "1")
    terminal.hits(found, "walks", as_json=False)
    assert "\x1b[33m" not in capsys.readouterr().out


@pytest.mark.parametrize("width", [20], indirect=True)
def test_numbers_are_never_cut_off(width: int, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.table(("", "R@1", "R@10"), [("a long name of a row of numbers", "12.5", "100.0")], right=("R@1", "R@10"))
    out = capsys.readouterr().out
    assert "12.5" in out
    assert "100.0" in out
