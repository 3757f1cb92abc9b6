"""Figures of composed motion, on a small library; and the command that prints them."""

from __future__ import annotations

from pathlib import Path

import motionseek
from motionseek import Interval, Timeline
from search.judging.composed_motion import evaluate_composed
from tests.search.conftest import Run

LINES = [
    Timeline.of([Interval("walks", 0, 3), Interval("sits down", 3, 5), Interval("waves with the left hand", 0.5, 2.5)]),
    Timeline.of([Interval("sits down", 0, 2)]),
]


def test_every_row_has_its_figures(indexed: Path, tiny_bundle: Path) -> None:
    with motionseek.Library.open(indexed, bundle=motionseek.Bundle.load(tiny_bundle, threads=1)) as library:
        found = evaluate_composed(library, LINES)
    assert list(found.rows) == ["composed", "cuts unjoined", "cuts with straight lines", "best clips alone"]
    for name, row in found.rows.items():
        assert 0 <= row["R@1"] <= row["R@1 aside"] <= 100
        assert row["R@1"] <= row["R@3"]
        assert {"R@1 free", "R@1 under", "R@1 over"} < set(row)
        assert ("transition cm" in row) == (name != "best clips alone")
    assert found.rows["composed"]["transition cm"] < found.rows["cuts unjoined"]["transition cm"]
    assert found.timelines == 2


def test_the_command_needs_time_lines_and_an_indexed_folder(run: Run, indexed: Path, tmp_path: Path) -> None:
    lines = tmp_path / "lines.txt"
    lines.write_text("walks # 0 # 2\n\nsits # 0 # 2\n", encoding="utf-8")
    told = run("evaluate", indexed, "--protocol", "compose")
    assert (told.code, "--protocol compose needs --timelines FILE" in told.err) == (2, True)
    assert run("evaluate", tmp_path, "--protocol", "compose", "--timelines", lines).code == 1
    ran = run("evaluate", indexed, "--protocol", "compose", "--timelines", lines, "--count", 1, "--json")
    assert ran.code == 0, ran.err
    assert ran.document["timelines"] == 1
    assert "transition cm" not in ran.document["rows"]["composed"], "one sentence has no transition"
