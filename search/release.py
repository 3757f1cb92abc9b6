"""Release: the weights of training runs become a bundle, exported to ONNX and with calibrated strength."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from encoders.bundle.bundle import Bundle
from encoders.errors import MotionSeekError
from encoders.tmr.conversion.from_bundle import restore
from encoders.tmr.conversion.to_bundle import export_bundle
from encoders.tmr.model.network import TMR, TMRConfig
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.text.language_model import LanguageModel
from encoders.tmr.training.checkpoint import read_checkpoint, read_recipe
from encoders.tmr.training.recipe import Recipe
from indexer.datasets.questioned_archives import QuestionedArchive
from search.evaluate.judged_hits import calibrate_on


def release(
    runs: Sequence[Path],
    folder: Path,
    *,
    name: str,
    kind: str = "body",
    training: Mapping[str, Any] | None = None,
    archives: Sequence[QuestionedArchive] = (),
) -> Bundle:
    """Export the averaged weights of one run or several, and calibrate them on motion held out of training.

    Parameters
    ----------
    runs : sequence of Path
        Each with recipe.json, last.pt and normaliser.npz, or a bundle; see `mean_weights`.
    folder : Path
        The bundle; an existing one is replaced once the new one is complete.
    training : mapping
        What the manifest says about the training, beside the recipe's main numbers.
    archives : sequence of QuestionedArchive
        Real motion that was not trained on, to calibrate sentences on; synthetic clips if there is none.

    Raises
    ------
    MotionSeekError
        If the runs cannot be averaged; see `mean_weights`.
    """
    recipe, weights, normaliser, steps = mean_weights(runs)
    model = TMR(recipe.network)
    model.load_state_dict(weights)

    def export(calibration: Mapping[str, Any] | None) -> Bundle:
        export_bundle(
            folder,
            name=name,
            motion_encoder=model.eval().motion_encoder,
            text_encoder=model.text_encoder,
            language=LanguageModel.load(),
            mean=normaliser.mean,
            std=normaliser.std,
            feature_kind=kind,
            max_frames=recipe.max_frames,
            training={"steps": steps, "batch": recipe.batch, **(training or {})},
            calibration=calibration,
        )
        return Bundle.load(folder)

    return export(calibrate_on(export(None), archives))


def mean_weights(runs: Sequence[Path]) -> tuple[Recipe, dict[str, torch.Tensor], Normaliser, list[int]]:
    """The averaged encoder weights of runs that began from the same one (Wortsman et al., "Model soups", ICML 2022).

    A bundle may be among them, such as the one that the runs began from.

    Returns
    -------
    recipe : Recipe
        That of the last run.
    weights : {name: tensor}
    normaliser : Normaliser
    steps : list of int
        Training steps of each run; 0 for a bundle.

    Raises
    ------
    MotionSeekError
        If their networks or normalisers differ, or all are bundles.
    """
    recipes = {run: read_recipe(run) for run in runs if is_run(run)}
    if not recipes:
        raise MotionSeekError(f"{runs[0]}: a bundle, and no run to average it with")
    recipe = list(recipes.values())[-1]
    recipe = replace(recipe, network=replace(recipe.network, decoder=None))
    found = [_weights(run, recipe.network) for run in runs]
    for run, (_, normaliser, _) in zip(runs, found, strict=True):
        same = all(np.array_equal(getattr(normaliser, part), getattr(found[0][1], part)) for part in ("mean", "std"))
        if not same or (run in recipes and replace(recipes[run].network, decoder=None) != recipe.network):
            raise MotionSeekError(f"{run}: has another network or normaliser than {runs[0]}; release it by itself")
    names = TMR(recipe.network).state_dict()
    weights = {name: torch.stack([one[name] for one, _, _ in found]).mean(dim=0) for name in names}
    return recipe, weights, found[0][1], [step for _, _, step in found]


def is_run(folder: Path) -> bool:
    """Whether a folder holds a run with weights, and no bundle."""
    return (folder / "last.pt").is_file()


def _weights(folder: Path, network: TMRConfig) -> tuple[Mapping[str, torch.Tensor], Normaliser, int]:
    """The weights of a run or of a bundle, its normaliser, and its steps."""
    if not is_run(folder):
        model, normaliser = restore(folder, network)
        return model.state_dict(), normaliser, 0
    saved = read_checkpoint(folder)
    return saved["average"], Normaliser.load(folder), saved["step"]
