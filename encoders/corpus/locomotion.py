"""Going from place to place: courses in every direction, and the programs that follow them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.curves import LEGS, Array, Curves, ease
from encoders.corpus.gait import PAD, Course, Gait, cadence_phase, step_along
from encoders.corpus.programs import program
from encoders.corpus.scene import Step
from encoders.corpus.style import Manner
from encoders.motion import FPS

_TURN = {
    "": 0.0, "forward": 0.0, "backward": np.pi, "left": np.pi / 2, "right": -np.pi / 2,
    "forward-left": np.pi / 4, "forward-right": -np.pi / 4,
    "backward-left": 3 * np.pi / 4, "backward-right": -3 * np.pi / 4,
}  # fmt: skip
STRAIGHT = ("forward", "backward", "left", "right", "forward-left", "forward-right")
CURVED = ("clockwise", "counterclockwise", "around", "zigzag", "back and forth")
SPEED = {"slow": 0.62, "": 1.0, "fast": 1.4}


def tempo(step: Step, rng: Generator, spread: float = 0.08) -> float:
    """Factor of the pace that the step's speed asks for, with some chance in it."""
    return SPEED[step.speed] * float(np.exp(rng.normal(0.0, spread)))


def _effort(frames: int, rng: Generator, rest: float = 0.65, rise: float = 0.6) -> Array:
    """Speed over time, 0 to 1, (F + 2 PAD,): from rest or already going, to rest or still going."""
    now = (np.arange(frames + 2 * PAD) - PAD) / FPS
    effort = np.ones(len(now))
    if rng.random() < rest:
        effort *= ease((now - rng.uniform(0.0, 0.3)) / (rise * rng.uniform(0.8, 1.3)))
    if rng.random() < rest:
        effort *= ease((frames / FPS - rng.uniform(0.0, 0.3) - now) / (rise * rng.uniform(0.8, 1.3)))
    return effort


def _bearing(direction: str, way: Array, rng: Generator) -> tuple[Array, float]:
    """Facing along the way (N,) and the angle at which the body moves to its facing."""
    total = max(float(way[-PAD - 1] - way[PAD]), 0.3)
    gone = way - way[PAD]
    if direction in CURVED:
        side = {"clockwise": -1.0, "counterclockwise": 1.0}.get(direction, rng.choice([-1.0, 1.0]))
        if direction in ("clockwise", "counterclockwise", "around"):
            radius = rng.uniform(0.5, 1.6)
            return side * gone / max(radius, total / (4 * np.pi)), 0.0
        if direction == "zigzag":
            length = rng.uniform(0.9, 1.6)
            return side * rng.uniform(0.5, 0.9) * np.tanh(2.5 * np.sin(np.pi * gone / length)), 0.0
        turns = max(1, round(total / rng.uniform(1.5, 3.0)) - 1)
        at = total * np.arange(1, turns + 1) / (turns + 1)
        return side * np.pi * ease((gone[:, None] - at) / 0.7 + 0.5).sum(1), 0.0
    angle = _TURN[direction]
    oblique = 0.75 if direction.count("-") else 0.45
    if direction == "backward" or (angle and rng.random() < oblique):
        return rng.normal(0.0, 0.03) * gone, angle
    if not angle:
        return rng.normal(0.0, 0.06) * gone, 0.0
    start = rng.uniform(0.0, 0.4) * total
    return angle * rng.uniform(0.85, 1.1) * ease((gone - start) / rng.uniform(0.5, 1.1)), 0.0


def travel(step: Step, gait: Gait, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Go in the step's direction with a gait, changed by manner, speed and amplitude."""
    pace = tempo(step, rng)
    stride = manner.factor("stride") * {"small": 0.65, "": 1.0, "large": 1.3}[step.amplitude]
    speed = gait.speed * pace * manner.factor("pace") * stride
    cadence = gait.cadence * np.sqrt(pace) * manner.factor("pace")
    speed *= (
        0.0 if step.direction == "in place" else {"backward": 0.7, "left": 0.75, "right": 0.75}.get(step.direction, 1.0)
    )
    frames = frames or int(rng.uniform(2.0, 6.0) * FPS)
    effort = _effort(frames, rng)
    way = np.cumsum(speed * effort) / FPS
    facing, angle = _bearing("" if step.direction == "in place" else step.direction, way, rng)
    rate = np.diff(way, prepend=way[0])[:, None]
    root = np.cumsum(rate * np.stack([np.sin(facing + angle), np.cos(facing + angle)], 1), axis=0)
    start = root[PAD].copy()
    root -= start
    turn = facing - facing[PAD]
    phase = cadence_phase(cadence * (0.75 + 0.25 * effort), rng.random(), manner)
    gait = replace(
        gait,
        speed=speed,
        arms=gait.arms * float(np.clip(stride * pace, 0.4, 1.4)),
        push=gait.push * max(np.cos(angle), 0.15),
    )
    return step_along(Course(root, turn, effort, phase), gait, manner)


@program("walk", group="locomotion", parts=LEGS, directions=(*STRAIGHT, *CURVED, "in place"), weight=4)
def walk(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk at 0.8 to 1.6 m/s."""
    return travel(step, Gait(speed=rng.uniform(1.0, 1.4), cadence=rng.uniform(1.7, 2.0)), manner, rng, frames)
