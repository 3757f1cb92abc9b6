"""Clips from scenes: programs acted out, joined, overlaid, varied and posed on random bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator

from encoders.corpus.body import pose, random_geometry
from encoders.corpus.curves import Curves
from encoders.corpus.programs import programs
from encoders.corpus.scene import Clip, Scene, Step
from encoders.corpus.style import apply_manner, sample_manner
from encoders.motion import FPS


def act(step: Step, rng: Generator, frames: int = 0) -> Curves:
    """Act one step out by a random performer."""
    manner = sample_manner(step.style, rng)
    curves = programs()[step.action].make(step, manner, rng, frames)
    apply_manner(curves, manner, rng)
    return curves


def make_clip(scene: Scene, rng: Generator, *, captions: Sequence[str] = ()) -> Clip:
    """Act a scene out by one random performer."""
    curves = act(scene.steps[0][0], rng)
    joints = pose(curves, random_geometry(rng)).astype(np.float32)
    spans = tuple((start / FPS, end / FPS) for start, end in curves.spans)
    return Clip(joints, FPS, scene, spans, tuple(captions))
