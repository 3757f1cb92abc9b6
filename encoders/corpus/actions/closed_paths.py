"""Walks along closed paths: half a circle, a figure of eight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import LEGS, Array, Curves
from encoders.corpus.engine.gait import PAD, Gait, step_along
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.trajectories import integrate, plan_gait
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS


def _walk_facing(step: ActionStep, manner: Manner, rng: Generator, frames: int, angle: Array) -> Curves:
    """Walk with a heading that follows a curve (K,) of angles, spread evenly over the path."""
    gait = Gait(speed=rng.uniform(1.0, 1.5), cadence=rng.uniform(1.7, 2.1))
    trajectory, gait = plan_gait(replace(step, direction="forward"), gait, manner, rng, frames)
    gone = np.cumsum(np.hypot(*np.diff(trajectory.root, axis=0, prepend=trajectory.root[:1]).T))
    share = (gone - gone[PAD]) / max(float(gone[-PAD - 1] - gone[PAD]), 0.3)
    facing = np.interp(share, np.linspace(0.0, 1.0, len(angle)), angle)
    return step_along(replace(trajectory, root=integrate(gone, facing), facing=facing), gait, manner)


@program("walk half circle", group="locomotion", parts=LEGS, directions=("left", "right"), weight=1.2)
def walk_half_circle(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk an arc round to the left or right until facing back, with or without a straight run to either side."""
    side = {"left": 1.0, "right": -1.0}.get(step.direction, float(rng.choice([-1.0, 1.0])))
    lead, tail = rng.uniform(0.0, 0.2, 2)
    share = np.clip((np.linspace(0.0, 1.0, 60) - lead) / (1.0 - lead - tail), 0.0, 1.0)
    angle = side * np.pi * rng.uniform(0.85, 1.15) * share
    return _walk_facing(step, manner, rng, frames or int(rng.uniform(3.0, 6.5) * FPS), angle)


@program("walk figure eight", group="locomotion", parts=LEGS, weight=1.2)
def walk_figure_eight(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk one loop to a side and one to the other, crossing in the middle."""
    first = rng.uniform(0.44, 0.56)
    share = np.linspace(0.0, 1.0, 120)
    angle = 2 * np.pi * np.where(share < first, share / first, (1.0 - share) / (1.0 - first))
    angle = np.convolve(np.pad(angle, 4, mode="edge"), np.full(9, 1 / 9), mode="valid")
    return _walk_facing(
        step, manner, rng, frames or int(rng.uniform(6.0, 11.0) * FPS), float(rng.choice([-1.0, 1.0])) * angle
    )
