"""`motionseek evaluate`: every protocol prints its figures, as a table or as JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.composition.long_takes import Event, annotated_take
from tests.search.conftest import Run, made_motion


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    """Two takes with descriptions, labels, captions of a part of one and a timed label."""
    rows = ["path\ttrial\tkind\tsplit\tuse\tfps_in_file\tfps_true\tdescription"]
    for i, name in enumerate(("walks", "jumps")):
        np.save(tmp_path / f"{name}.npy", made_motion(6.0, i).joints)
        rows.append(f"{name}.npy\t{i}\ttake\tval\tval\t20\t\t{name}")
    (tmp_path / "manifest.tsv").write_text("\n".join(rows), encoding="utf-8")
    line = {"trial": "0", "start_frame": 20, "end_frame": 60, "fps": 20, "split": "val", "captions": ["strolls"]}
    (tmp_path / "captions.jsonl").write_text(json.dumps(line), encoding="utf-8")
    (tmp_path / "labels.tsv").write_text("path\tlabel\nwalks.npy\twalk\njumps.npy\tjump\n", encoding="utf-8")
    (tmp_path / "queries.tsv").write_text("label\tquery\nwalk\twalks\njump\tjumps\n", encoding="utf-8")
    (tmp_path / "timed.json").write_text('{"0": [{"start": 1, "end": 3, "label": "Kick"}]}', encoding="utf-8")
    return tmp_path


def test_labels(run: Run, archive: Path) -> None:
    document = run("evaluate", archive, "--json").document
    assert document["labels"].keys() == {"walk", "jump"}
    lines = run("evaluate", archive).out.splitlines()
    assert [line.split("\t")[0] for line in lines] == ["walk", "jump", "mean"]


def test_captions(run: Run, archive: Path) -> None:
    arguments = ["evaluate", archive, "--protocol", "captions", "--captions", archive / "captions.jsonl"]
    document = run(*arguments, "--json").document
    assert (document["files"], document["descriptions"]) == (2, 2)
    assert len(document["ranks"]["walks"]) == 2, "the description and the caption"
    ran = run(*arguments)
    assert [line.split("\t")[0] for line in ran.out.splitlines()] == ["walks", "jumps"]
    assert "R@10 100.0 %" in ran.err


def test_corpus(run: Run) -> None:
    figures = run("evaluate", "--protocol", "corpus", "--count", 40, "--json").document
    assert {"same sentence, text -> motion", "relevant clips, text -> motion", "hard negatives"} <= figures.keys()


def test_out_of_domain_needs_a_calibrated_model(run: Run) -> None:
    ran = run("evaluate", "--protocol", "out-of-domain", "--count", 1)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "carries no calibration" in ran.err


def test_moments_of_each_set(run: Run, archive: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    events = [
        Event(text, (2.0 * i, 2.0 * i + 2), frozenset({text})) for i, text in enumerate(("walks", "sits", "bows"))
    ]
    take = annotated_take(made_motion(6.0, 0), events)
    monkeypatch.setattr("search.evaluate.annotated_takes.synthetic_takes", lambda count: [take] * count)
    arguments = ["evaluate", archive, "--protocol", "moments", "--count", 1, "--segments", archive / "timed.json"]
    lines = run(*arguments).out.splitlines()
    assert [line for line in lines if line.startswith("###")] == [
        "### synthetic takes",
        "### timed segments",
    ]
    assert sum(line.startswith("| three steps in order") for line in lines) == 1
    figures = run(*arguments, "--json").document
    assert figures["timed segments"]["motionseek"]["questions"] == 1


@pytest.mark.parametrize(("protocol", "missing"), [("labels", "FOLDER"), ("captions", "--captions")])
def test_what_a_protocol_needs_is_named(run: Run, protocol: str, missing: str) -> None:
    ran = run("evaluate", "--protocol", protocol)
    assert (ran.code, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert missing in ran.err
