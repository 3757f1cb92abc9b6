"""`motionseek judge`: figures in every form, and what is wrong in one line."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from tests.search.conftest import Run, made_motion


@pytest.fixture
def generated(tmp_path: Path) -> Path:
    """Five motions for two sentences, and a real one for each sentence."""
    made, real = tmp_path / "made here", tmp_path / "real"
    made.mkdir()
    real.mkdir()
    rows = ["path,text,label,reference"]
    for i in range(5):
        np.save(made / f"{i}.npy", made_motion(4.0 + i, i).joints)
        rows.append(f"{i}.npy,{('walks', 'jumps')[i % 2]},{('walk', 'jump')[i % 2]},{i % 2}")
    for i in range(2):
        np.save(real / f"{i}.npy", made_motion(5.0, 10 + i).joints)
    (tmp_path / "texts.csv").write_text("\n".join(rows), encoding="utf-8")
    return tmp_path


def test_figures_as_table_json_csv_and_latex(run: Run, generated: Path) -> None:
    arguments = [
        "judge",
        generated / "made here",
        "--texts",
        generated / "texts.csv",
        "--references",
        generated / "real",
    ]
    ran = run(*arguments, "--repeats", 2)
    table = {line.split("\t")[0]: line.split("\t")[1:] for line in ran.out.splitlines()}
    assert table["TMR-score, motion to motion (0..1)"][2] == "1.000", "of real motions with themselves"
    assert "left out (no transitions)" in ran.err
    figures = run(*arguments, "--repeats", 2, "--json").document["figures"]
    assert figures["score_text"]["source"].startswith("STMC")
    assert [figures["diversity"]["generated"]["repeats"], figures["frechet"]["generated"]["interval"]] == [2, None]
    rows = list(csv.DictReader(io.StringIO(run(*arguments, "--repeats", 2, "--format", "csv").out)))
    assert {row["figure"] for row in rows} == {figure["name"] for figure in figures.values()}
    latex = run(*arguments, "--repeats", 2, "--format", "latex").out.splitlines()
    assert [line.split(" & ")[0] for line in latex[1:]] == ["real", "generated"]
    assert {line.count("&") for line in latex} == {len(figures)}


def test_repeats_of_a_generator_are_folders_of_the_same_names(run: Run, generated: Path) -> None:
    again = generated / "again"
    again.mkdir()
    for i in range(5):
        np.save(again / f"{i}.npy", made_motion(4.0 + i, 20 + i).joints)
    document = run("judge", generated / "made here", again, "--json").document
    assert document["figures"]["skate"]["generated"]["repeats"] == 2
    (again / "4.npy").unlink()
    ran = run("judge", generated / "made here", again)
    assert ran.code == 2
    assert "4 is not in both" in ran.err


def test_time_lines_and_their_crops(run: Run, generated: Path) -> None:
    (generated / "lines.txt").write_text("".join(f"## {i}\nwalks # 0 # 2\njumps # 2 # 4\n\n" for i in range(5)))
    (generated / "clips.tsv").write_text("text\tpath\nwalks\treal/0.npy\njumps\treal/1.npy\n")
    arguments = ["judge", generated / "made here", "--timelines", generated / "lines.txt"]
    arguments += ["--references", generated / "clips.tsv", "--crops", generated / "crops.csv"]
    document = run(*arguments, "--json").document
    assert {"score_text", "score_motion", "precision_1", "frechet_crops", "transition"} <= document["figures"].keys()
    crops = list(csv.DictReader((generated / "crops.csv").open()))
    assert [crop["text"] for crop in crops] == [crop["text"] for crop in document["crops"]] == ["walks", "jumps"] * 5
    assert "exists" in run(*arguments).err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["empty"], "no motion in this folder"),
        (["made here", "--texts", "none.tsv"], "does not exist"),
        (["made here", "--texts", "real"], "no text for this motion"),
        (["made here", "--references", "texts.csv"], "a table goes with --timelines"),
        (["made here", "--crops", "x.csv"], "--crops needs --timelines"),
        (["made here", "--texts", "texts.csv", "--labels", "labels.txt"], "'jump' is asked for"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(run: Run, generated: Path, arguments: list[str], message: str) -> None:
    (generated / "empty").mkdir()
    (generated / "labels.txt").write_text("walk, stroll\nrun\n")
    ran = run("judge", *(a if a.startswith("--") else generated / a for a in arguments))
    assert (ran.code, ran.err.count("\n")) == (2, 1)
    assert message in ran.err
