"""Courses: where a performer goes, in every direction a sentence can name, from rest or on the move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.curves import Array, Curves, ease
from encoders.corpus.gait import PAD, Course, Gait, gait_phase, step_along
from encoders.corpus.scene import Step
from encoders.corpus.style import Manner
from encoders.corpus.timing import tempo
from encoders.motion import FPS

TURN = {
    "": 0.0, "forward": 0.0, "backward": np.pi, "left": np.pi / 2, "right": -np.pi / 2,
    "forward-left": np.pi / 4, "forward-right": -np.pi / 4,
    "backward-left": 3 * np.pi / 4, "backward-right": -3 * np.pi / 4,
}  # fmt: skip
STRAIGHT = ("forward", "backward", "left", "right", "forward-left", "forward-right", "backward-left", "backward-right")
AHEAD = ("forward", "left", "right", "forward-left", "forward-right")
CURVED = ("clockwise", "counterclockwise", "around", "zigzag", "back and forth")


def seconds(frames: int) -> Array:
    """Time of every frame of a course, (N,), 0 where the kept part begins."""
    return (np.arange(frames + 2 * PAD) - PAD) / FPS


def effort(frames: int, rng: Generator, *, rest: float = 0.6, rise: float = 0.6) -> Array:
    """Speed over time, 0 to 1, (N,): from rest or already going, to rest or still going.

    `rest` is the chance of rest at either end, `rise` the seconds it takes to get going.
    """
    now, total = seconds(frames), frames / FPS
    rise = min(rise, 0.35 * total)
    going = np.ones(len(now))
    if rng.random() < rest:
        going *= ease((now - rng.uniform(0.0, 0.2)) / (rise * rng.uniform(0.8, 1.3)))
    if rng.random() < rest:
        going *= ease((total - rng.uniform(0.0, 0.2) - now) / (rise * rng.uniform(0.8, 1.3)))
    return going


def _circling(direction: str, gone: Array, total: float, rng: Generator) -> Array:
    side = {"clockwise": -1.0, "counterclockwise": 1.0}.get(direction, rng.choice([-1.0, 1.0]))
    radius = max(rng.uniform(0.5, 1.6), total / (3.5 * np.pi))
    return np.asarray(side * gone / min(radius, total / (1.3 * np.pi)))


def _zigzag(gone: Array, rng: Generator) -> Array:
    length = rng.uniform(0.9, 1.8)
    return np.asarray(rng.choice([-1, 1]) * rng.uniform(0.5, 0.9) * np.tanh(2.5 * np.sin(np.pi * gone / length)))


def _back_and_forth(gone: Array, total: float, rng: Generator) -> Array:
    turns = max(1, round(total / rng.uniform(1.5, 3.0)) - 1)
    at = total * np.arange(1, turns + 1) / (turns + 1)
    return np.asarray(rng.choice([-1, 1]) * np.pi * ease((gone[:, None] - at) / 0.6 + 0.5).sum(1))


def bearing(direction: str, way: Array, rng: Generator) -> tuple[Array, float]:
    """How a body faces and moves along its way.

    Parameters
    ----------
    way : float array (N,)
        Metres gone.

    Returns
    -------
    facing : (N,) heading; angle : radians from the facing to the direction of movement, to the left.
    """
    gone = way - way[PAD]
    total = max(float(gone[-PAD - 1]), 0.3)
    if direction in ("clockwise", "counterclockwise", "around"):
        return _circling(direction, gone, total, rng), 0.0
    if direction == "zigzag":
        return _zigzag(gone, rng), 0.0
    if direction == "back and forth":
        return _back_and_forth(gone, total, rng), 0.0
    angle = TURN[direction]
    backward = direction.startswith("backward")
    if backward or not angle or rng.random() < (0.75 if "-" in direction else 0.4):
        return rng.normal(0.0, 0.1) * gone / max(total, 3.0), angle
    start = rng.uniform(0.0, 0.4) * total
    return angle * rng.uniform(0.85, 1.1) * ease((gone - start) / rng.uniform(0.5, 1.1)), 0.0


def travel(
    step: Step, gait: Gait, manner: Manner, rng: Generator, frames: int, going: Array | None = None
) -> tuple[Course, Gait]:
    """The course of a step, and the gait as direction, speed, amplitude and manner change it."""
    pace = tempo(step, rng)
    stride = manner.factor("stride") * {"small": 0.65, "": 1.0, "large": 1.3}[step.amplitude]
    still = step.direction == "in place"
    sideways = {"left": 0.8, "right": 0.8}.get(step.direction, 0.7 if step.direction.startswith("back") else 1.0)
    fastest = 1.9 if gait.duty > 0.5 else 7.0
    speed = gait.speed * pace * manner.factor("pace") * stride * sideways
    speed = min(speed, fastest)
    going = effort(frames, rng, rest=0.35 if gait.duty < 0.5 else 0.45) if going is None else going
    way = np.cumsum(speed * going) / FPS
    facing, angle = bearing("" if still else step.direction, np.zeros_like(way) if still else way, rng)
    pace_of_feet = gait.cadence * np.sqrt(pace) * manner.factor("pace")
    # A leg reaches only so far: who steps out further at this cadence stands shorter.
    reach = 0.66 if gait.duty < 0.5 else 0.95
    duty = min(gait.duty, max(reach * pace_of_feet / 2 / max(speed, 0.1), 0.52 if gait.duty > 0.5 else 0.2))
    phase = gait_phase(pace_of_feet * (0.75 + 0.25 * going), rng.random(), manner)
    course = Course(_integrate(0.0 * way if still else way, facing + angle), facing - facing[PAD], going, phase)
    changed = replace(
        gait,
        speed=speed,
        duty=duty,
        arms=gait.arms * float(np.clip(stride * pace, 0.4, 1.4)),
        push=gait.push * (0.3 if still else max(float(np.cos(angle)), 0.15)),
        width=gait.width + 0.03 * abs(float(np.sin(angle))),
    )
    return course, changed


def _integrate(way: Array, direction: Array) -> Array:
    stretch = np.diff(way, prepend=way[0])[:, None]
    root = np.cumsum(stretch * np.stack([np.sin(direction), np.cos(direction)], axis=1), axis=0)
    return np.asarray(root - root[PAD])


def go(step: Step, gait: Gait, manner: Manner, rng: Generator, frames: int = 0) -> Curves:
    """Act a gait out along the step's direction, 2 to 6 seconds long unless `frames` says."""
    course, gait = travel(step, gait, manner, rng, frames or int(rng.uniform(2.0, 6.0) * FPS))
    return step_along(course, gait, manner)
