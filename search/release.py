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
from encoders.tmr.conversion.to_bundle import export_bundle
from encoders.tmr.model.network import TMR
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
        Each with recipe.json, last.pt and normaliser.npz; see `mean_weights`.
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
    recipe, weights, steps = mean_weights(runs)
    model = TMR(recipe.network)
    model.load_state_dict(weights)
    normaliser = Normaliser.load(runs[0])

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


def mean_weights(runs: Sequence[Path]) -> tuple[Recipe, dict[str, torch.Tensor], list[int]]:
    """The averaged encoder weights of runs that began from the same one (Wortsman et al., "Model soups", ICML 2022).

    Returns
    -------
    recipe : Recipe
        That of the last run.
    weights : {name: tensor}
    steps : list of int
        Training steps of each run.

    Raises
    ------
    MotionSeekError
        If their networks or normalisers differ.
    """
    recipes, saved, norms = [], [], []
    for run in runs:
        recipe = read_recipe(run)
        recipes.append(replace(recipe, network=replace(recipe.network, decoder=None)))
        saved.append(read_checkpoint(run))
        normaliser = Normaliser.load(run)
        norms.append(np.stack([normaliser.mean, normaliser.std]))
        if recipes[-1].network != recipes[0].network or not np.array_equal(norms[-1], norms[0]):
            raise MotionSeekError(f"{run}: has another network or normaliser than {runs[0]}; release it by itself")
    names = TMR(recipes[-1].network).state_dict()
    weights = {name: torch.stack([one["average"][name] for one in saved]).mean(dim=0) for name in names}
    return recipes[-1], weights, [one["step"] for one in saved]
