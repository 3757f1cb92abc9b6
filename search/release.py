"""A finished training run becomes a bundle that can judge its own hits."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from encoders.bundle import Bundle
from encoders.corpus.made import Made, made_clips
from encoders.corpus.real import CaptionedTake
from encoders.corpus.seeds import CALIBRATION
from encoders.kinds import FEATURE_KINDS
from encoders.tmr.export import export_bundle
from encoders.tmr.language import LanguageModel
from encoders.tmr.material import unrelated_sentences
from encoders.tmr.network import TMR
from encoders.tmr.recipe import Recipe
from search.calibrate import calibrate

_BACKGROUND, _ASKED, _UNRELATED = 1500, 800, 400


def release(
    run: Path,
    folder: Path,
    *,
    name: str,
    kind: str = "body",
    training: Mapping[str, Any] | None = None,
    takes: Sequence[CaptionedTake] = (),
) -> Bundle:
    """Export the averaged weights of a run, calibrate them on made clips nobody trained on, and write the bundle.

    Parameters
    ----------
    run : Path
        With recipe.json, last.pt and normaliser.npz.
    folder : Path
        The bundle; one that is there is replaced when the new one is whole.
    takes : sequence of CaptionedTake
        Real takes for validation, to calibrate on beside made clips.
    training : mapping
        What the manifest says of the training, beside the recipe's main numbers.
    """
    recipe = Recipe.from_dict(json.loads((run / "recipe.json").read_text(encoding="utf-8")))
    saved = torch.load(run / "last.pt", weights_only=True)
    model = TMR(recipe.network)
    model.load_state_dict(saved["average"])
    with np.load(run / "normaliser.npz", allow_pickle=False) as arrays:
        mean, std = arrays["mean"], arrays["std"]

    def export(calibration: Mapping[str, Any] | None) -> Bundle:
        export_bundle(
            folder,
            name=name,
            motion_encoder=model.eval().motion_encoder,
            text_encoder=model.text_encoder,
            language=LanguageModel.load(),
            mean=mean,
            std=std,
            feature_kind=kind,
            max_frames=recipe.max_frames,
            training={"steps": saved["step"], "batch": recipe.batch, **(training or {})},
            calibration=calibration,
        )
        return Bundle.load(folder)

    clips = calibration_clips(kind)
    unrelated = unrelated_sentences(_UNRELATED, seed=1)
    return export(calibrate(export(None), clips[:_BACKGROUND], clips[_BACKGROUND:], unrelated, takes))


def calibration_clips(kind: str) -> Sequence[Made]:
    """Made clips that are in no training, validation or test set."""
    return list(made_clips(CALIBRATION, _BACKGROUND + _ASKED, FEATURE_KINDS[kind]))
