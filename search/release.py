"""A finished training run becomes a bundle that can judge its own hits."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.captioned_motion import CaptionedTake
from encoders.corpus.composition.seeds import CALIBRATION
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, synthetic_clips
from encoders.errors import MotionSeekError
from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.conversion.to_bundle import export_bundle
from encoders.tmr.model.network import TMR
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.text.language_model import LanguageModel
from encoders.tmr.training.dataset import unrelated_sentences
from encoders.tmr.training.recipe import Recipe
from search.ranking.calibration import calibrate

_BACKGROUND, _ASKED, _UNRELATED = 1500, 800, 400


def release(
    runs: Sequence[Path],
    folder: Path,
    *,
    name: str,
    kind: str = "body",
    training: Mapping[str, Any] | None = None,
    takes: Sequence[CaptionedTake] = (),
) -> Bundle:
    """Export the averaged weights of one run or several, calibrate them on made clips nobody trained on, and write it.

    Parameters
    ----------
    runs : sequence of Path
        Each with recipe.json, last.pt and normaliser.npz; see `mean_weights`.
    folder : Path
        The bundle; one that is there is replaced when the new one is whole.
    takes : sequence of CaptionedTake
        Real takes for validation, to calibrate on beside made clips.
    training : mapping
        What the manifest says of the training, beside the recipe's main numbers.
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

    clips = calibration_clips(kind)
    unrelated = unrelated_sentences(_UNRELATED, seed=1)
    return export(calibrate(export(None), clips[:_BACKGROUND], clips[_BACKGROUND:], unrelated, takes))


def mean_weights(runs: Sequence[Path]) -> tuple[Recipe, dict[str, torch.Tensor], list[int]]:
    """The encoders of runs that went on from the same one, averaged: the last one's recipe, weights, each one's steps.

    Such a mean finds more than any of them and costs no more than one (Wortsman et al., "Model soups", ICML 2022).

    Raises
    ------
    MotionSeekError
        If their encoders or normalisers differ in size or numbers.
    """
    recipes, saved, norms = [], [], []
    for run in runs:
        recipe = Recipe.from_dict(json.loads((run / "recipe.json").read_text(encoding="utf-8")))
        recipes.append(replace(recipe, network=replace(recipe.network, decoder=None)))
        saved.append(torch.load(run / "last.pt", weights_only=True))
        normaliser = Normaliser.load(run)
        norms.append(np.stack([normaliser.mean, normaliser.std]))
        if recipes[-1].network != recipes[0].network or not np.array_equal(norms[-1], norms[0]):
            raise MotionSeekError(f"{run}: has other sizes or another normaliser than {runs[0]}; release it by itself")
    names = TMR(recipes[-1].network).state_dict()
    weights = {name: torch.stack([one["average"][name] for one in saved]).mean(dim=0) for name in names}
    return recipes[-1], weights, [one["step"] for one in saved]


def calibration_clips(kind: str) -> Sequence[SyntheticClip]:
    """Made clips that are in no training, validation or test set."""
    return list(synthetic_clips(CALIBRATION, _BACKGROUND + _ASKED, FEATURE_KINDS[kind]))
