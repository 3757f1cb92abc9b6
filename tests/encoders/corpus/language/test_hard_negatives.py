"""Contrasting scenes differ in one attribute or the order."""

from __future__ import annotations

from encoders.corpus.language.hard_negatives import contrasting_scenes
from encoders.corpus.scene import ActionStep, Scene
from tests.encoders.corpus.scenes import one


def test_contrasting_scenes_differ_once_and_stay_legal() -> None:
    scene = Scene(((ActionStep("wave", side="left", count=3),), (ActionStep("turn", direction="right"),)))
    found = {str(other) for other in contrasting_scenes(scene)}
    assert "turn, right; then wave, left, 3 times" in found
    assert "wave, right, 3 times; then turn, right" in found
    assert "wave, left, 3 times; then turn, left" in found
    assert "wave, left, 4 times; then turn, right" in found
    assert str(scene) not in found
    assert contrasting_scenes(one("clap")) == []
