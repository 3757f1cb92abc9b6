"""`motionseek evaluate` on a captioned data set: every form of the figures, and every bad layout by its name."""

from __future__ import annotations

import csv
import io
import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.indexer.datasets.toy_dataset import write_dataset, write_embeddings
from tests.search.conftest import Run, made_motion

TEXTS = ("a man walks", "a man walks", "a person jumps", "someone sits")
KEYS = [f"{i:06d}" for i in range(len(TEXTS))]


@pytest.fixture
def joints(tmp_path: Path) -> Path:
    """A data set whose motions are joints, in a folder with a space in its name."""
    root = tmp_path / "my sets"
    write_dataset(root, {k: [(t, 0.0, 3.0)] for k, t in zip(KEYS, TEXTS, strict=True)}, {"test": KEYS})
    for number, key in enumerate(KEYS):
        np.save(root / "motions" / "guoh3dfeats" / "SYN" / f"{key}.npy", made_motion(3.0, number).joints)
    write_embeddings(root / "annotations" / "toy", list(dict.fromkeys(TEXTS)), width=768)
    return root


def test_a_data_set_is_known_by_its_layout_and_printed_in_every_form(run: Run, joints: Path) -> None:
    ran = run("evaluate", joints)
    assert ran.code == 0, ran.err
    lines = [line.split("\t") for line in ran.out.splitlines()]
    assert len(lines) == 10
    assert lines[0][:4] == ["all", "strict", "4", "text->motion"]
    assert "sentence similarity: sentence-transformers/all-mpnet-base-v2" in ran.err
    document = run("evaluate", joints, "--json").document
    assert [f"{row[f'R@{k}']:.2f}" for row in [document["protocols"][0]["text->motion"]] for k in (1, 2, 3)] == lines[
        0
    ][4:7]
    rows = list(csv.reader(io.StringIO(run("evaluate", joints, "--format", "csv").out)))
    assert [row[5:] for row in rows[1:]] == lines
    assert run("evaluate", joints, "--format", "latex").out.count(r"\\") == 5


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda root: (root / "annotations/toy/splits/test.txt").unlink(), "has no split 'test'"),
        (lambda root: (root / "motions/guoh3dfeats/SYN/000002.npy").unlink(), "000002: is not there"),
        (
            lambda root: np.save(root / "motions/guoh3dfeats/SYN/000002.npy", np.zeros((60, 135))),
            "has 135 numbers a frame",
        ),
        (
            lambda root: np.save(root / "motions/guoh3dfeats/SYN/000002.npy", np.full((60, 22, 3), np.nan)),
            "holds values that are no numbers",
        ),
        (lambda root: shutil.rmtree(root / "motions"), "no folder of motions"),
        (lambda root: (root / "annotations/toy/annotations.json").write_text("{"), "cannot be read as annotations"),
    ],
)
def test_a_bad_layout_is_one_line_that_says_which(run: Run, joints: Path, damage, reason: str) -> None:
    damage(joints)
    ran = run("evaluate", joints)
    assert (ran.code, ran.out, ran.err.count("\n")) == (1, "", 1)
    assert reason in ran.err


def test_joints_at_another_frame_rate_are_told_and_read_once_it_is_given(run: Run, joints: Path) -> None:
    for number, key in enumerate(KEYS):
        motion = made_motion(4.5, number)
        np.save(joints / "motions" / "guoh3dfeats" / "SYN" / f"{key}.npy", motion.joints)
    ran = run("evaluate", joints)
    assert (ran.code, ran.out) == (1, "")
    assert "frames for each second" in ran.err
    assert run("evaluate", joints, "--fps", 30).code == 0


def test_captions_of_parts_of_motions_are_moments(run: Run, joints: Path) -> None:
    ran = run("evaluate", joints, "--protocol", "moments", "--split", "test")
    assert (ran.code, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert "no caption of the split 'test' is about a part of its motion" in ran.err
    place = joints / "annotations" / "toy" / "annotations.json"
    annotations = json.loads(place.read_text())
    annotations[KEYS[0]]["annotations"].append({"text": "waves", "start": 1.0, "end": 2.0})
    place.write_text(json.dumps(annotations))
    document = run("evaluate", joints, "--protocol", "moments", "--split", "test", "--json").document
    ((name, figures),) = document.items()
    assert name.endswith("on toy, split test")
    assert figures["best of the three"]["questions"] == 1.0
    printed = run("evaluate", joints, "--protocol", "moments", "--split", "test").out
    assert printed.startswith(f"### {name}\n\n| first answer, by IoU |")


def test_a_folder_without_a_data_set_and_a_run_beside_a_model(run: Run, joints: Path, tmp_path: Path) -> None:
    ran = run("evaluate", tmp_path, "--protocol", "retrieval")
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "holds no data set" in ran.err
    assert run("evaluate", joints, "--run", joints, "--model", joints).code == 2


@pytest.mark.parametrize("option", ["--run", "--sentence-model"])
def test_without_torch_the_extra_is_named(run: Run, joints: Path, monkeypatch: pytest.MonkeyPatch, option: str) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    ran = run("evaluate", joints, option, joints)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "torch" in ran.err
    assert "pip install '.[train]'" in ran.err


@pytest.mark.torch
def test_a_run_directory_is_evaluated_with_the_data_sets_token_features(run: Run, joints: Path, tmp_path: Path) -> None:
    pytest.importorskip("torch")
    from tests.encoders.published_layout import STATISTICS, write_run, write_statistics

    place = write_run(tmp_path / "a run")
    ran = run("evaluate", joints, "--run", place)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "--stats" in ran.err
    write_statistics(tmp_path / "elsewhere")
    elsewhere = run("evaluate", joints, "--run", place, "--stats", tmp_path / "elsewhere", "--json").document
    assert (elsewhere["model"], len(elsewhere["protocols"])) == ("a run", 5)
    write_statistics(joints / "stats" / "toy" / "guoh3dfeats")
    assert run("evaluate", joints, "--run", place, "--json").document == elsewhere, "those of the data set"
    write_statistics(place / STATISTICS)
    assert run("evaluate", joints, "--run", place, "--json").document == elsewhere, "those that the run names"
    ran = run("evaluate", joints, "--sentence-model", "./mpent")
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "mpent: no such folder, and no name" in ran.err
    ran = run("evaluate", joints, "--run", place, "--language-model", "./bert")
    assert "bert: no such folder, and no name" in ran.err


def test_a_published_run_has_the_published_figures(run: Run, golden: Path) -> None:
    pytest.importorskip("torch")
    document = run("evaluate", golden / "published_dataset", "--run", golden / "published_run", "--json").document
    wanted = json.loads((golden / "retrieval_metrics_run.json").read_text())
    names = ("normal", None, "threshold_0.95", "nsim", None, "guo", None)
    for row, name in zip(document["protocols"], names, strict=True):
        if name is None:
            continue
        for way, short in (("text->motion", "t2m"), ("motion->text", "m2t")):
            figures = [round(row[way][f"R@{k}"], 2) for k in (1, 2, 3, 5, 10)]
            assert figures == [wanted[name][f"{short}/R{k:02d}"] for k in (1, 2, 3, 5, 10)]
            assert round(row[way]["MedR"], 2) == wanted[name][f"{short}/MedR"]
