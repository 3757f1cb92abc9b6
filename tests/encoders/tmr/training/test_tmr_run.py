"""Training by TMR's recipe: the published configuration, learning, and going on exactly where it stopped."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.errors import MotionSeekError  # noqa: E402
from encoders.features.registry import FEATURE_KINDS, FeatureKind  # noqa: E402
from encoders.tmr.conversion import from_published  # noqa: E402
from encoders.tmr.conversion.import_run import statistics_of_run  # noqa: E402
from encoders.tmr.conversion.run_encoder import RunEncoder  # noqa: E402
from encoders.tmr.training import tmr_run  # noqa: E402
from encoders.tmr.training.captioned_clips import CaptionedClips, TextFeatures, statistics  # noqa: E402
from encoders.tmr.training.losses import LossWeights  # noqa: E402
from encoders.tmr.training.tmr_recipe import TMRRecipe  # noqa: E402
from encoders.tmr.training.tmr_run import TMRTraining  # noqa: E402
from tests.conftest import ROOT  # noqa: E402

KINDS, SIZE = 3, 8
KIND = FeatureKind("toy", SIZE, 20.0, lambda motion: np.zeros((1, SIZE), np.float32))
RECIPE = TMRRecipe(latent=32, layers=1, heads=2, feedforward=48, batch=8, rate=3e-3)
#: Learns a toy in seconds.
QUICK = replace(RECIPE, batch=4, epochs=30, dropout=0.0, contrastive=1.0, seed=3)
AXES = np.random.default_rng(0).normal(size=(KINDS, SIZE)).astype(np.float32)


def clips(count: int, seed: int) -> CaptionedClips:
    """Motions of one kind each, with two captions that name it."""
    rng = np.random.default_rng(seed)
    kinds = np.arange(count) % KINDS
    motions = [AXES[k] + 0.1 * rng.normal(size=(rng.integers(8, 14), SIZE)).astype(np.float32) for k in kinds]
    return CaptionedClips([(f"kind {k}", f"of kind {k}") for k in kinds], lambda i, c: motions[i])


def tokens(texts: Sequence[str]) -> list[np.ndarray]:
    return [np.eye(10, dtype=np.float32)[[9] * (text.count(" ")) + [int(text[-1])]] for text in texts]


TEXTS = TextFeatures(
    "words", 10, tokens, "kinds", lambda texts: np.eye(KINDS, dtype=np.float32)[[int(text[-1]) for text in texts]]
)


def training(folder: Path, recipe: TMRRecipe = RECIPE, number: int = 20) -> TMRTraining:
    data = clips(number, 0)
    return TMRTraining(folder, recipe, KIND, data, TEXTS, statistics(data))


def silent(_: str) -> None:
    pass


def test_it_learns_and_leaves_a_run_as_published(tmp_path: Path) -> None:
    training(tmp_path / "run", QUICK).run(clips(KINDS, 1), say=silent)
    rows = [json.loads(line) for line in (tmp_path / "run" / "log.jsonl").read_text().splitlines()]
    assert [row["epoch"] for row in rows] == [*range(1, 31)]
    assert rows[-1]["loss"] < 0.5 * rows[0]["loss"]
    assert rows[-1]["text->motion R@1"] == rows[-1]["motion->text R@1"] == 100.0
    weights, temperature, threshold = from_published.read_weights(tmp_path / "run")
    assert (weights, temperature, threshold) == (LossWeights(contrastive=1.0), 0.1, 0.8)
    encoder = RunEncoder.load(tmp_path / "run", tmp_path / "run" / "stats")
    held_out = clips(KINDS, 1)
    motions = encoder.encode_features([held_out.clip(i, 0) for i in range(KINDS)])
    sentences = encoder.encode_token_features(tokens([f"kind {k}" for k in range(KINDS)]))
    assert np.argmax(sentences @ motions.T, axis=1).tolist() == [*range(KINDS)]
    data = from_published.read_data(tmp_path / "run")
    assert (data.features, data.size, data.fps, data.language_model) == ("datasets/motions/toy", SIZE, 20.0, "words")
    assert statistics_of_run(tmp_path / "run", data) == (tmp_path / "run" / "stats").resolve()


def test_a_run_that_is_stopped_anywhere_ends_as_one_that_is_not(tmp_path: Path, monkeypatch) -> None:
    recipe = replace(RECIPE, epochs=3)
    training(tmp_path / "whole", recipe).run(say=silent)
    with monkeypatch.context() as patched:
        for _ in range(4):  # seconds pass with every look at the clock: three steps a session
            ticks = count()
            patched.setattr(tmr_run, "time", SimpleNamespace(monotonic=lambda t=ticks: float(next(t))))
            training(tmp_path / "parts", recipe).run(minutes=7 / 60, say=silent)
    training(tmp_path / "parts", recipe).run(say=silent)
    whole, parts = (torch.load(tmp_path / name / "last.pt", weights_only=True)["model"] for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)
    logs = [
        [json.loads(line) for line in (tmp_path / n / "log.jsonl").read_text().splitlines()] for n in ("whole", "parts")
    ]
    assert [row["loss"] for row in logs[0]] == pytest.approx([row["loss"] for row in logs[1]])


def test_a_folder_goes_on_with_its_own_run_only(tmp_path: Path) -> None:
    short = replace(RECIPE, epochs=1)
    training(tmp_path, short).run(say=silent)
    training(tmp_path, replace(short, epochs=2)).run(say=silent)
    assert len((tmp_path / "log.jsonl").read_text().splitlines()) == 2
    with pytest.raises(MotionSeekError, match="another recipe, data set or device"):
        training(tmp_path, replace(short, rate=1e-2))
    with pytest.raises(MotionSeekError, match="another recipe, data set or device"):
        training(tmp_path, short, number=21)


def test_the_default_is_the_published_configuration(golden: Path) -> None:
    published = json.loads((golden / "published_config_default_humanml3d.json").read_text())
    ours = TMRRecipe().published_config(FEATURE_KINDS["humanml3d"], 768, "distilbert-base-uncased")
    model = dict(published["model"])
    for part in (model, *(model[name] for name in ("motion_encoder", "text_encoder", "motion_decoder"))):
        part.pop("_target_")
    assert ours["model"] == model
    assert ours["dataloader"]["batch_size"] == published["dataloader"]["batch_size"]
    assert ours["trainer"]["max_epochs"] == published["trainer"]["max_epochs"]
    assert ours["seed"] == published["seed"]
    for name in ("fps", "nfeats"):
        assert ours["data"]["motion_loader"][name] == published["data"]["motion_loader"][name]


def test_the_published_sizes_and_weights_without_the_golden_file() -> None:
    published = json.loads((ROOT / "tests" / "data" / "published_config.json").read_text())["model"]
    small = TMRRecipe(latent=64, layers=2, feedforward=128)
    ours = small.published_config(FEATURE_KINDS["humanml3d"], 768, "distilbert-base-uncased")["model"]
    for name, value in ours.items():
        wanted = published[name]
        assert value == ({k: v for k, v in wanted.items() if k != "_target_"} if isinstance(wanted, dict) else wanted)


def test_statistics_are_those_of_the_frames_of_first_clips() -> None:
    data = CaptionedClips([("a",), ("b", "c")], lambda i, c: np.array([[i + 10 * c, 5.0], [2 + i, 5.0]], np.float32))
    mean, std = statistics(data)
    np.testing.assert_allclose(mean, [1.5, 5.0])
    np.testing.assert_allclose(std, [np.std([0, 2, 1, 3], ddof=1), 1.0], rtol=1e-6)


@pytest.mark.parametrize("change", [{"batch": 0}, {"threshold": 0.3}, {"epochs": 1.5}, {"rate": -1}, {"dropout": 1}])
def test_what_is_no_recipe_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(change))):
        TMRRecipe(**change)
