"""What a run's folder holds, also under the names that version 0.1 gave to parts of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import torch

from encoders.tmr.training.recipe import Recipe

_RENAMED = {
    "gist": "sentence_head",
    "gist_steps": "head_steps",
    "telling": "hard_negative_weight",
    "alike": "similar_share",
    "posture": "pose_jitter",
    "words_lost": "token_dropout",
}


def read_recipe(run: Path) -> Recipe:
    """The recipe of a run."""
    return Recipe.from_dict(_renamed(json.loads((run / "recipe.json").read_text(encoding="utf-8"))))


def read_checkpoint(run: Path) -> dict[str, Any]:
    """The last state of a run: weights by name under "model" and "average", and what is needed to resume."""
    saved: dict[str, Any] = torch.load(run / "last.pt", weights_only=True)
    for part in saved.keys() & {"model", "average"}:
        saved[part] = {name.replace(".gist.", ".sentence_head."): value for name, value in saved[part].items()}
    return saved


def _renamed(values: dict[str, Any]) -> dict[str, Any]:
    return {
        _RENAMED.get(name, name): _renamed(value) if isinstance(value, dict) else value
        for name, value in values.items()
    }
