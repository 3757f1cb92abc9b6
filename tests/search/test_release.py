"""Releasing: several runs that went on from the same one become one model, their mean."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.errors import MotionSeekError  # noqa: E402
from encoders.tmr.model.network import TMR, TMRConfig, TransformerConfig  # noqa: E402
from encoders.tmr.model.normaliser import Normaliser  # noqa: E402
from encoders.tmr.training.recipe import Recipe  # noqa: E402
from search.cli.commands.model.train import initial_model  # noqa: E402
from search.release import mean_weights  # noqa: E402

SMALL = {"width": 8, "layers": 1, "heads": 2, "feedforward": 8}
NETWORK = TMRConfig(TransformerConfig(6, **SMALL), TransformerConfig(4, **SMALL), decoder=None, latent=4)


def finished(folder: Path, value: float, network: TMRConfig = NETWORK, deviation: float = 1.0, step: int = 7) -> Path:
    """A run that ended at a step with every weight at `value`."""
    folder.mkdir()
    (folder / "recipe.json").write_text(json.dumps(Recipe(network=network).to_dict()), "utf-8")
    weights = {name: torch.full_like(tensor, value) for name, tensor in TMR(network).state_dict().items()}
    torch.save({"average": weights, "step": step}, folder / "last.pt")
    np.savez(folder / "normaliser.npz", mean=np.zeros(6, np.float32), std=np.full(6, deviation, np.float32))
    return folder


def test_the_weights_of_several_runs_are_averaged_and_decoders_left_behind(tmp_path: Path) -> None:
    decoding = replace(NETWORK, decoder=TransformerConfig(6, **SMALL))
    runs = [finished(tmp_path / "a", 1.0, decoding), finished(tmp_path / "b", 4.0, step=5)]
    recipe, weights, _, steps = mean_weights(runs)
    assert (recipe.network, steps) == (NETWORK, [7, 5])
    assert set(weights) == set(TMR(NETWORK).state_dict())
    assert all(torch.all(tensor == 2.5) for tensor in weights.values())


@pytest.mark.parametrize("other", [{"network": replace(NETWORK, latent=8)}, {"deviation": 2.0}])
def test_runs_that_have_nothing_in_common_are_not_averaged(tmp_path: Path, other: dict) -> None:
    runs = [finished(tmp_path / "a", 1.0), finished(tmp_path / "b", 1.0, **other)]
    with pytest.raises(MotionSeekError, match="release it by itself"):
        mean_weights(runs)


def test_a_new_run_may_begin_with_the_mean_of_others(tmp_path: Path) -> None:
    runs = [finished(tmp_path / "a", 1.0), finished(tmp_path / "b", 4.0)]
    model, normaliser = initial_model(runs, Recipe(network=NETWORK))
    assert all(torch.all(tensor == 2.5) for tensor in model.state_dict().values())
    assert np.array_equal(normaliser.std, np.ones(6))
    with pytest.raises(MotionSeekError, match="other networks"):
        initial_model(runs, Recipe(network=replace(NETWORK, latent=8)))


def test_a_bundle_that_runs_began_from_counts_as_one_of_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, bundle = finished(tmp_path / "a", 4.0), tmp_path / "bundle"
    bundle.mkdir()
    began = TMR(NETWORK)
    began.load_state_dict({name: torch.ones_like(tensor) for name, tensor in began.state_dict().items()})
    monkeypatch.setattr("search.release.restore", lambda folder, network: (began, Normaliser.load(run)))
    _, weights, _, steps = mean_weights([run, run, bundle])
    assert steps == [7, 7, 0]
    assert all(torch.all(tensor == 3.0) for tensor in weights.values())
    with pytest.raises(MotionSeekError, match="no run"):
        mean_weights([bundle])
