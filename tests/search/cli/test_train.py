"""`motionseek model train` and `release`: what is held out of training, and errors before any work is done."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from encoders.corpus.language.held_out_sentences import HeldOutSentences
from encoders.errors import QueryError
from encoders.features.registry import FEATURE_KINDS
from search.cli.commands.model.train import real_stores
from tests.search.conftest import Run, made_motion

HEADER = "path\ttrial\tkind\tsplit\tuse\tfps_in_file\tfps_true\tdescription\n"


@pytest.fixture
def people(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """A folder with a take to train on and one to validate on, and captions of both."""
    rows = [f"{split}.bvh\t{split}\ttake\t{split}\t{split}\t20\t\t\n" for split in ("train", "val")]
    (tmp_path / "manifest.tsv").write_text(HEADER + "".join(rows), "utf-8")
    sentences = {"train": ["a man hops", "a man walks"], "val": ["a man walks", "somebody strolls"]}
    lines = [
        {"trial": split, "start_frame": 0, "end_frame": -1, "fps": 20, "split": split, "captions": captions}
        for split, captions in sentences.items()
    ]
    captions = tmp_path / "captions.jsonl"
    captions.write_text("\n".join(map(json.dumps, lines)), "utf-8")
    monkeypatch.setattr("indexer.datasets.archive_tables.load_motion", lambda path, fps=None: made_motion(4, 0))
    return tmp_path, captions


def test_sentences_are_held_out_of_training_only(people: tuple[Path, Path]) -> None:
    banned = HeldOutSentences(["a man walks", "somebody strolls"])
    training, validation = real_stores(*people, FEATURE_KINDS["body"], banned)
    assert "a man hops" in training.texts
    assert not any(banned(text) for text in training.texts)
    assert validation is not None
    assert validation.texts == ["a man walks", "somebody strolls"]


def test_people_who_wait_are_a_part_of_what_is_trained_on(
    people: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, captions = people
    (folder / "waits.bvh").touch()
    monkeypatch.setattr("indexer.datasets.captioned_takes.load_motion", lambda path: made_motion(6, 0))
    banned = HeldOutSentences(())
    alone, _ = real_stores(folder, captions, FEATURE_KINDS["body"], banned)
    with_idle, _ = real_stores(folder, captions, FEATURE_KINDS["body"], banned, folder)
    assert len(with_idle) > len(alone)


def test_real_clips_without_a_caption_to_train_on_are_an_error(people: tuple[Path, Path]) -> None:
    with pytest.raises(QueryError, match="split 'train'"):
        real_stores(*people, FEATURE_KINDS["body"], HeldOutSentences(["a man hops", "a man walks"]))


@pytest.mark.parametrize("command", ["train", "release"])
def test_without_torch_the_extra_is_named(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    out = [] if command == "train" else [tmp_path / "bundle"]
    ran = run("model", command, tmp_path, *out)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "torch" in ran.err
    assert "pip install '.[train]'" in ran.err


@pytest.mark.torch
@pytest.mark.parametrize(
    ("recipe", "reason"),
    [
        ("{", "invalid JSON"),
        ("[1]", "JSON object"),
        ('{"stpes": 3}', "has no stpes"),
        ('{"contrast": "infonec"}', "must be one of"),
        ('{"network": {"latent": 3}}', "no recipe"),
        ('{"rate": "x"}', "rate='x' must be a number from 0"),
        ('{"rate": -1}', "rate=-1 must be a number from 0"),
        ('{"seed": 1.5}', "seed=1.5 must be a whole number from 0"),
        ('{"bf16": 1}', "bf16=1 must be true or false"),
        ('{"batch": 0}', "batch=0 must be positive"),
    ],
)
def test_a_wrong_recipe_is_refused_before_any_work(run: Run, tmp_path: Path, recipe: str, reason: str) -> None:
    pytest.importorskip("torch")
    file = tmp_path / "recipe.json"
    file.write_text(recipe, "utf-8")
    ran = run("model", "train", tmp_path / "run", "--recipe", file)
    assert ran.code in (1, 2)
    assert ran.err.count("\n") == 1
    assert reason in ran.err
    assert not (tmp_path / "run").exists()


@pytest.mark.torch
def test_only_a_run_is_released(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("torch")
    ran = run("model", "release", tmp_path, tmp_path / "bundle")
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "recipe.json is missing" in ran.err
