"""Programs that compute curves directly: plausible bodies, the named count and side."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.curves import ANKLE, STAND
from encoders.corpus.scene import ActionStep, Scene
from tests.encoders.corpus.performances import peaks, perform

CURVE_PROGRAMS = sorted(n for n, p in programs().items() if p.make.__module__.startswith("encoders.corpus.actions."))


@pytest.mark.parametrize("name", CURVE_PROGRAMS)
def test_every_program_gives_plausible_motion_for_random_attributes(name: str) -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        clip = make_clip(Scene(((sample_step(programs()[name], rng, detail=0.8),),)), rng)
        assert clip.joints.dtype == np.float32
        assert np.isfinite(clip.joints).all()
        assert 0.5 <= len(clip.joints) / clip.fps <= 40
        assert -0.3 < clip.joints[..., 1].min() < 0.6
        speed = np.linalg.norm(np.diff(clip.joints, axis=0), axis=-1).max() * clip.fps
        assert speed < 25, "no joint leaps between frames"
        (start, end), *_ = clip.spans
        assert 0 <= start < end <= len(clip.joints) / clip.fps + 1e-6


@pytest.mark.parametrize("count", [1, 2, 4])
def test_counts_are_kept(count: int) -> None:
    for seed in range(3):
        feet = perform(ActionStep("jump", count=count), seed).feet[..., 1].min(axis=1)
        assert peaks(feet, ANKLE + 0.03) == count
        assert peaks(STAND - perform(ActionStep("squat", count=count), seed).root[:, 1], 0.1) == count
        bow = perform(ActionStep("bow", count=count), seed)
        assert peaks((bow.spine + bow.pelvis)[:, 0], 0.2) == count


@pytest.mark.parametrize("side", ["left", "right"])
def test_sides_are_the_bodys_own(side: str) -> None:
    on = ("left", "right").index(side)
    hop = perform(ActionStep("hop", side=side, direction="in place"))
    middle = len(hop) // 2
    assert hop.feet[middle, on, 1] < hop.feet[middle, 1 - on, 1] - 0.1
    kneeling = perform(ActionStep("kneel", side=side))
    assert kneeling.feet[:, on, 2].min() < kneeling.feet[:, 1 - on, 2].min() - 0.3
    balance = perform(ActionStep("balance on one leg", side=side))
    assert balance.feet[len(balance) // 2, 1 - on, 1] > balance.feet[len(balance) // 2, on, 1] + 0.2


@pytest.mark.parametrize("name", ["turn", "pivot", "spin jump"])
def test_turns_go_as_far_as_the_step_says(name: str) -> None:
    for degrees in programs()[name].degrees:
        for direction, sign in (("left", 1), ("right", -1)):
            heading = perform(ActionStep(name, direction=direction, degrees=degrees)).heading
            assert np.rad2deg(heading[-1] - heading[0]) == pytest.approx(sign * degrees, rel=0.15)
