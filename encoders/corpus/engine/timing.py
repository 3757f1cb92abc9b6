"""Durations, from the step's speed, the performer's pace, and noise."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import frames_of
from encoders.corpus.engine.style import Manner
from encoders.corpus.scene import ActionStep

SPEED = {"slow": 0.62, "": 1.0, "fast": 1.45}


def tempo(step: ActionStep, rng: Generator, spread: float = 0.08) -> float:
    """Random factor of the pace for the step's speed."""
    return SPEED[step.speed] * float(np.exp(rng.normal(0.0, spread)))


def duration(base: float, step: ActionStep, manner: Manner, rng: Generator, frames: int = 0) -> int:
    """Frames of an action that takes `base` seconds at ordinary pace; a hint `frames` takes precedence."""
    return frames or frames_of(base / (tempo(step, rng, 0.15) * manner.factor("pace") ** 0.6))
