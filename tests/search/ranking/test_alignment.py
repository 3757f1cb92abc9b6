"""Alignment in time: the same performance is ranked before other clips of the same meaning."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.motion import Motion
from search.ranking.alignment import alignment_bonus
from tests.search.fakes import MeanEncoder


def _motion(seed: int, frames: int = 80) -> Motion:
    steps = np.random.default_rng(seed).normal(size=(frames, 22, 3))
    return Motion(np.cumsum(steps, axis=0) * 0.02)


@pytest.fixture
def bundle() -> MeanEncoder:
    return MeanEncoder()


def test_the_same_movement_gains_most_and_another_nothing_or_little(bundle: MeanEncoder) -> None:
    motion = _motion(0)
    noisy = Motion(motion.joints + 0.005)
    gains = alignment_bonus(bundle, motion, [noisy, *(_motion(seed) for seed in range(1, 6))])
    assert gains.argmax() == 0
    assert gains[0] > 0.25
    assert (gains >= 0).all()


def test_the_same_movement_at_a_slightly_other_pace_still_gains(bundle: MeanEncoder) -> None:
    motion = _motion(0)
    slower = Motion(motion.joints, motion.fps * 0.9).resample(motion.fps)
    assert alignment_bonus(bundle, motion, [slower, _motion(1)])[0] > 0.2


def test_clips_of_very_different_length_gain_nothing(bundle: MeanEncoder) -> None:
    motion = _motion(0)
    assert alignment_bonus(bundle, motion, [motion.crop(0, motion.duration / 2)]).tolist() == [0.0]
