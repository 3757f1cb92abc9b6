"""Runs of version 0.1 can still be released and resumed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.tmr.training.checkpoint import read_checkpoint, read_recipe  # noqa: E402
from encoders.tmr.training.recipe import Recipe  # noqa: E402

FORMER = {
    "head_steps": "gist_steps",
    "hard_negative_weight": "telling",
    "similar_share": "alike",
    "pose_jitter": "posture",
    "token_dropout": "words_lost",
    "sentence_head": "gist",
}


def test_a_recipe_is_read_under_the_names_it_was_written_with(tmp_path: Path) -> None:
    text = json.dumps(Recipe(pose_jitter=3.0, head_steps=7).to_dict())
    for now, before in FORMER.items():
        assert f'"{now}"' in text
        text = text.replace(f'"{now}"', f'"{before}"')
    (tmp_path / "recipe.json").write_text(text)
    assert read_recipe(tmp_path) == Recipe(pose_jitter=3.0, head_steps=7)


def test_weights_are_read_under_the_names_they_have_now(tmp_path: Path) -> None:
    tensors = {"text_encoder.gist.mix.bias": torch.ones(2), "text_encoder.tokens": torch.zeros(2)}
    torch.save({"step": 3, "model": tensors, "average": tensors}, tmp_path / "last.pt")
    saved = read_checkpoint(tmp_path)
    assert saved["step"] == 3
    for part in ("model", "average"):
        assert set(saved[part]) == {"text_encoder.sentence_head.mix.bias", "text_encoder.tokens"}
