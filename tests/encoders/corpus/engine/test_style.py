"""Styles and carriages change the body."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from encoders.corpus.composition.scene_clips import perform_scene
from encoders.corpus.engine.arm_carriage import CARRIAGES, hold_arms
from encoders.corpus.engine.curves import HANGING, standing
from encoders.corpus.engine.style import NEUTRAL, STYLES, apply_manner
from encoders.corpus.engine.style_variants import STYLE_VARIANTS
from encoders.corpus.scene import ActionStep, Scene


@pytest.mark.parametrize(("style", "measure", "sign"), [
    ("old", "bend", 1), ("proud", "bend", -1), ("tired", "speed", -1), ("energetic", "speed", 1), ("heavy", "width", 1),
    ("feminine", "width", -1), ("sad", "nod", 1), ("happy", "bob", 1), ("zombie", "hands", 1),
])  # fmt: skip
def test_styles_change_the_body(style: str, measure: str, sign: int) -> None:
    def measured(name: str) -> float:
        values = []
        for seed in range(12):
            curves = perform_scene(
                Scene(((ActionStep("walk", direction="forward", style=name),),)), np.random.default_rng(seed)
            )
            values.append({
                "bend": curves.spine[:, 0].mean(),
                "speed": np.linalg.norm(np.diff(curves.root[:, [0, 2]], axis=0), axis=1).mean(),
                "width": np.abs(np.diff(curves.feet[..., 0], axis=1)).mean(),
                "nod": (curves.head + curves.spine)[:, 0].mean(),
                "bob": curves.root[:, 1].std(),
                "hands": curves.hands[..., 1].mean(),
            }[measure])  # fmt: skip
        return float(np.mean(values))

    assert sign * (measured(style) - measured("")) > 0
    assert style in STYLES


def test_style_variants_belong_to_known_styles_and_set_manner_fields() -> None:
    assert set(STYLE_VARIANTS) <= set(STYLES)
    named = {field.name for field in fields(NEUTRAL)}
    assert all(set(way) <= named for ways in STYLE_VARIANTS.values() for way in ways)


@pytest.mark.parametrize(("action", "style", "sign"), [
    ("stand", "old", 1), ("wave", "tired", 1), ("point", "proud", -1), ("guide", "sad", 1),
])  # fmt: skip
def test_styles_change_gestures_and_standing_too(action: str, style: str, sign: int) -> None:
    def bend(name: str) -> float:
        scene = Scene(((ActionStep(action, style=name),),))
        return float(np.mean([perform_scene(scene, np.random.default_rng(s)).spine[:, 0].mean() for s in range(12)]))

    assert sign * (bend(style) - bend("")) > 0.1


@pytest.mark.parametrize("carriage", sorted(CARRIAGES))
def test_a_carriage_moves_idle_hands_but_not_busy_ones(carriage: str) -> None:
    manner = replace(NEUTRAL, carriage=carriage)
    idle, waving = standing(40), standing(40)
    waving.hands[10:30, 0] = (0.2, 0.4, 0.3)
    for curves in (idle, waving):
        apply_manner(curves, manner, np.random.default_rng(0))
    assert np.abs(idle.hands - np.array(HANGING)).max() > 0.05
    np.testing.assert_allclose(waving.hands[10:30, 0], np.broadcast_to((0.2, 0.4, 0.3), (20, 3)))


def test_arms_are_held_anywhere_and_nothing_else_changes() -> None:
    places = []
    for seed in range(40):
        curves = standing(30)
        hold_arms(curves, np.random.default_rng(seed))
        assert np.array_equal(curves.data[:, :25], standing(30).data[:, :25])
        assert np.abs(curves.hands).max() < 1.5
        places.append(curves.hands[-1])
    assert (np.std(places, axis=0) > 0.15).all()
