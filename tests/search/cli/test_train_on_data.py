"""`motionseek model train --data`: from a data set to a run that `evaluate` takes; and what is refused."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.indexer.datasets.toy_dataset import write_dataset, write_embeddings
from tests.search.conftest import Run

TEXTS = ("a man walks", "a man walks", "a person jumps", "someone sits")
KEYS = [f"{i:06d}" for i in range(len(TEXTS))]
SMALL = {"latent": 16, "layers": 1, "heads": 2, "feedforward": 16, "batch": 2, "epochs": 2}


@pytest.fixture
def data(tmp_path: Path) -> Path:
    root = tmp_path / "datasets"
    captions = {key: [(text, 0.0, 2.5), (f"{text} on", 0.5, 2.5)] for key, text in zip(KEYS, TEXTS, strict=True)}
    write_dataset(root, captions, {"train": KEYS, "val": KEYS[2:], "test": KEYS})
    write_embeddings(root / "annotations" / "toy", sorted({text for rows in captions.values() for text, _, _ in rows}))
    (tmp_path / "small.json").write_text(json.dumps(SMALL), "utf-8")
    return root


@pytest.mark.torch
def test_a_run_is_trained_resumed_and_evaluated(run: Run, data: Path, tmp_path: Path) -> None:
    pytest.importorskip("torch")
    arguments = ["model", "train", tmp_path / "a run", "--data", data, "--recipe", tmp_path / "small.json"]
    ran = run(*arguments, "--device", "cpu")
    assert ran.code == 0, ran.err
    assert "tokens by distilbert-base-uncased, similarity of captions by sentence-transformers/all-mpnet" in ran.out
    assert sum(line.startswith("epoch ") for line in ran.out.splitlines()) == 2
    assert "text->motion R@1" in ran.out
    ran = run(*arguments, "--device", "cpu", "--epochs", 3)
    assert [line.split()[1] for line in ran.out.splitlines() if line.startswith("epoch ")] == ["3"]
    ran = run("evaluate", data, "--run", tmp_path / "a run", "--json")
    assert ran.code == 0, ran.err
    assert (ran.document["model"], ran.document["protocols"][0]["gallery"]) == ("a run", 4)


@pytest.mark.torch
def test_without_a_validation_split_it_is_said_and_trained_all_the_same(run: Run, data: Path, tmp_path: Path) -> None:
    pytest.importorskip("torch")
    (data / "annotations/toy/splits/val.txt").unlink()
    ran = run("model", "train", tmp_path / "run", "--data", data, "--recipe", tmp_path / "small.json", "--epochs", 1)
    assert ran.code == 0, ran.err
    assert "not validated" in ran.err
    assert "R@1" not in ran.out


@pytest.mark.torch
def test_an_imported_run_has_the_figures_of_the_run(
    run: Run, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From a data set without embeddings to a bundle that needs no torch, by the language model of a folder."""
    pytest.importorskip("torch")
    from tests.encoders.published_layout import write_language

    monkeypatch.setenv("MOTIONSEEK_MODELS", str(tmp_path / "models"))
    for name in ("token_embeddings", "sent_embeddings"):
        shutil.rmtree(data / "annotations" / "toy" / name)
    language = write_language(tmp_path / "distilbert-base-uncased", width=16)
    train = ["model", "train", tmp_path / "run", "--data", data, "--recipe", tmp_path / "small.json"]
    ran = run(*train, "--language-model", language)
    assert ran.code == 0, ran.err
    assert "tokens by distilbert-base-uncased, similarity of captions by distilbert-base-uncased" in ran.out
    ran = run("model", "import", tmp_path / "run", "--name", "toy", "--language-model", language)
    assert ran.code == 0, ran.err
    of_run, of_model = (
        run("evaluate", data, *chosen, "--sentence-model", language, "--json").document
        for chosen in (["--run", tmp_path / "run", "--language-model", language], ["--model", "toy"])
    )
    assert of_run["sentence_similarity"] == "distilbert-base-uncased"
    assert of_run["protocols"] == of_model["protocols"]


@pytest.mark.torch
@pytest.mark.parametrize(
    ("arguments", "code", "reason"),
    [
        (["--recipe", "tmr"], 2, "add --data"),
        (["--features", "humanml3d"], 2, "--features: not without --data"),
        (["--data", "DATA", "--synthetic", "2000", "--steps", "3"], 2, "--synthetic, --steps: not with --data"),
        (["--data", "DATA", "--recipe", "ODD"], 2, "has no latnet"),
        (["--data", "DATA", "--recipe", "tmr", "--features", "smpl"], 1, "'smpl' is unknown"),
        (["--data", "DATA", "--language-model", "./bert"], 1, "bert: no such folder, and no name"),
        (["--data", "DATA", "--motions", "HERE"], 1, "is not there"),
    ],
)
def test_what_is_refused(run: Run, data: Path, tmp_path: Path, arguments: list[str], code: int, reason: str) -> None:
    pytest.importorskip("torch")
    (tmp_path / "odd.json").write_text('{"latnet": 3}', "utf-8")
    places = {"DATA": data, "ODD": tmp_path / "odd.json", "HERE": tmp_path}
    ran = run("model", "train", tmp_path / "run", *(places.get(argument, argument) for argument in arguments))
    assert (ran.code, ran.err.count("\n")) == (code, 1), ran.err
    assert reason in ran.err
