"""Turns on the spot: in small steps, round and round, or on the ball of one foot."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, HIP, LEFT, LEGS, SIDE_INDEX, Array, Curves, ease, hold, standing
from encoders.corpus.engine.gait import PAD, Gait, Trajectory, gait_phase, step_along
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.trajectories import seconds
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS


@program(
    "turn",
    group="locomotion",
    parts=LEGS,
    directions=("left", "right", "around", "clockwise", "counterclockwise"),
    degrees=(45, 90, 135, 180, 270, 360),
    weight=2.5,
)
def turn(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn on the spot in small steps: by the step's angle, else a quarter to a side, half or a whole turn around."""
    side = {"left": 1, "counterclockwise": 1, "right": -1, "clockwise": -1}.get(step.direction, rng.choice([-1, 1]))
    usual = {"left": 90, "right": 90, "around": 180}.get(step.direction, rng.choice([180, 360]))
    degrees = (step.degrees or usual) * rng.uniform(0.88, 1.1)
    return spin_in_place(step, manner, rng, frames, np.deg2rad(side * degrees), rng.uniform(90, 160))


def spin_in_place(
    step: ActionStep, manner: Manner, rng: Generator, frames: int, angle: float, degrees_per_second: float
) -> Curves:
    """Turn by an angle (radians, left positive) on the spot."""
    pace = {"slow": 0.6, "": 1.0, "fast": 1.6}[step.speed] * manner.factor("pace")
    rate = np.deg2rad(degrees_per_second) * pace
    total = frames or max(int((abs(angle) / rate + 0.5) * FPS), 12)
    now = seconds(total) / (total / FPS)
    facing = angle * ease((now - 0.08) / 0.84)
    going = np.minimum(np.abs(np.gradient(facing)) * FPS / rate, 1.0)
    phase = gait_phase(np.full(len(now), rng.uniform(1.7, 2.4) * np.sqrt(pace)), rng.random(), manner)
    gait = Gait(speed=0.2, lift=0.06, bob=0.01, push=0.15, arms=0.1, width=0.09)
    curves = step_along(Trajectory(np.zeros((len(now), 2)), facing, going, phase), gait, manner)
    ahead = np.gradient(facing)[PAD:-PAD] * FPS
    curves.head[:, 2] += 0.18 * ahead
    curves.spine[:, 2] += 0.08 * ahead
    return curves


@program("spin", group="locomotion", parts=LEGS, directions=("clockwise", "counterclockwise"), counts=(1, 4))
def spin(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn round and round on the spot, arms sometimes held out."""
    side = {"counterclockwise": 1, "clockwise": -1}.get(step.direction, rng.choice([-1, 1]))
    angle = side * 2 * np.pi * (step.count or int(rng.integers(1, 4)))
    curves = spin_in_place(step, manner, rng, frames, float(angle), rng.uniform(150, 300))
    if rng.random() < 0.4:
        out = np.array([rng.uniform(0.7, 0.95), rng.uniform(-0.4, 0.1), 0.05])
        curves.hands[:] += (out - curves.hands) * hold(len(curves), 0.2, 0.2)[:, None, None]
    return curves


@program(
    "pivot",
    group="locomotion",
    parts=LEGS,
    sides=("left", "right"),
    directions=("left", "right", "around"),
    degrees=(90, 180),
)
def pivot(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn at once on the ball of one foot, the other foot carried around it."""
    side = {"left": 1, "right": -1}.get(step.direction, rng.choice([-1, 1]))
    usual = 180 if step.direction == "around" else rng.uniform(80, 175)
    angle = side * np.deg2rad((step.degrees or usual) * rng.uniform(0.87, 1.06))
    on = SIDE_INDEX[step.side] if step.side else int(rng.integers(2))
    frames = frames or int(rng.uniform(0.9, 1.5) / (1.4 if step.speed == "fast" else 1.0) * FPS)
    curves = standing(frames, LEGS)
    when = ease((np.linspace(0, 1, frames) - 0.2) / 0.6)
    facing = angle * when
    axis = np.array([HIP if on == LEFT else -HIP, 0.0])
    sin, cos = np.sin(facing), np.cos(facing)

    def about(x: float) -> Array:
        return np.stack([axis[0] + (x - axis[0]) * cos, -(x - axis[0]) * sin], axis=1)

    curves.heading[:] = facing
    shift = 0.5 * hold(frames, 0.25, 0.25)[:, None]
    curves.root[:, [0, 2]] = about(0.0) * (1 - shift) + np.array([axis[0], 0.0]) * shift
    curves.feet[:, 1 - on][:, [0, 2]] = about(-axis[0])
    curves.feet[:, 1 - on, 1] = ANKLE + 0.08 * hold(frames, 0.35, 0.35)
    curves.feet[:, 1 - on, 0], curves.feet[:, 1 - on, 2] = about(-axis[0]).T
    curves.foot_yaw[:] += facing[:, None]
    curves.spine[:, 2] = 0.25 * np.gradient(facing) * FPS * 0.4
    return curves
