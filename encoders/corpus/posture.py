"""Changing and keeping posture: stand, sit, bow, kneel, squat, lean."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.curves import STAND, Curves, ease, hold, keys, standing
from encoders.corpus.programs import program
from encoders.corpus.scene import Step
from encoders.corpus.style import Manner
from encoders.corpus.timing import duration


@program("bow", group="posture", parts={"spine", "head"}, amplitudes=("small", "large"), counts=(1, 3), weight=2)
def bow(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend at the waist and come up again."""
    count = step.count or 1
    frames = duration(2.2 * count, step, manner, rng, frames)
    curves = standing(frames, frozenset({"spine", "head"}))
    depth = rng.uniform(*{"small": (0.35, 0.6), "": (0.6, 1.1), "large": (1.1, 1.6)}[step.amplitude])
    local = (np.arange(frames) * count / frames) % 1.0
    down = depth * ease(local / rng.uniform(0.25, 0.4)) * ease((1 - local) / rng.uniform(0.25, 0.4))
    curves.pelvis[:, 0] += 0.55 * down
    curves.root[:, 2] -= 0.11 * down
    curves.root[:, 1] -= 0.02 * down
    curves.spine[:, 0] += 0.45 * down
    curves.head[:, 0] += 0.25 * down
    return curves


@program("sit down", group="posture", heights=("low", "middle"), ends="sit")
def sit_down(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Sit down on a chair."""
    frames = duration(2.0, step, manner, rng, frames)
    curves = standing(frames)
    seat = rng.uniform(0.44, 0.56)
    when = ease(np.linspace(0.0, 1.1, frames))
    curves.root[:, 1] = STAND + (seat - STAND) * when
    curves.root[:, 2] = -0.42 * ease(when * 1.2)
    curves.spine[:, 0] = 0.45 * hold(frames, 0.4, 0.5)
    curves.pelvis[:, 0] = 0.4 * hold(frames, 0.4, 0.5) - 0.1 * when
    hands = keys(frames, [(0.1, (0.13, -0.95, 0.09)), (0.9, (0.0, -0.55, 0.55))])
    curves.hands[:] = hands[:, None]
    return curves
