"""`motionseek generate`: motions as files, with their scores beside the best real clip."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import motionseek
from tests.search.conftest import Run


@pytest.fixture(scope="module")
def generator(tiny_bundle: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundle of random weights with a decoder of random weights."""
    torch = pytest.importorskip("torch")
    from encoders.tmr.conversion.with_decoder import add_generator
    from encoders.tmr.model.normaliser import Normaliser
    from encoders.tmr.synthesis.motion_vae import MotionVAE, VAEConfig

    torch.manual_seed(0)
    sentence = motionseek.load_model(tiny_bundle).latent_size
    model = (
        MotionVAE(VAEConfig(96, sentence, latent=8, width=16, layers=1, feedforward=16)).eval().requires_grad_(False)
    )
    normaliser = Normaliser(np.zeros(96, np.float32), np.ones(96, np.float32))
    labels = ["kick", "walk"], np.zeros((2, 8)), np.zeros((2, 8))
    return add_generator(tiny_bundle, tmp_path_factory.mktemp("made") / "generator", model, normaliser, labels, {})


@pytest.mark.torch
def test_samples_are_files_with_scores_beside_the_best_real_clip(
    run: Run, indexed: Path, generator: Path, tmp_path: Path
) -> None:
    arguments = ["generate", "a person walks", tmp_path / "a walk.bvh", "--model", generator, "--library", indexed]
    document = run(*arguments, "--samples", 2, "--seconds", 3, "--json").document
    files = [Path(row["path"]) for row in document["generated"]]
    assert [file.name for file in files] == ["a walk-1.bvh", "a walk-2.bvh"]
    assert [motionseek.load(file).duration for file in files] == pytest.approx([2.95, 2.95])
    assert all(0 <= row["score"] <= 1 for row in document["generated"])
    hits = run("search", "a person walks", "--library", indexed, "--json").document["hits"]
    assert document["best_real"]["path"] in {hit["path"] for hit in hits}
    assert "exists" in run(*arguments, "--samples", 2).err


@pytest.mark.torch
def test_labels_and_what_is_wrong(run: Run, generator: Path, tmp_path: Path) -> None:
    arguments = ["generate", "kick", tmp_path / "kick.npy", "--label", "--model", generator]
    ran = run(*arguments, "--seed", 1)
    assert ran.code == 0
    assert ran.err == "no real motion to compare with: no library here\n"
    assert np.load(tmp_path / "kick.npy").shape[1:] == (22, 3)
    for changed, message in (
        (["generate", "kicks", *arguments[2:]], "knows no label 'kicks'; near: kick"),
        ([*arguments, "--seconds", 60], "the model makes motions of 0.4 to"),
        (["generate", "kick", tmp_path / "kick.fbx", *arguments[3:]], "unsupported format"),
    ):
        wrong = run(*changed, "--force")
        assert (wrong.code, wrong.err.count("\n")) == (2, 1)
        assert message in wrong.err


def test_a_model_without_a_decoder_says_how_to_get_one(run: Run, tiny_bundle: Path, tmp_path: Path) -> None:
    ran = run("generate", "a person walks", tmp_path / "x.bvh", "--model", tiny_bundle)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "'motionseek model decoder' trains one" in ran.err
