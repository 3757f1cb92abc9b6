"""Counted single steps in any direction, and a foot slid over the ground."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import LEFT, LEGS, RIGHT, SIDE_INDEX, Array, Curves, ease, frames_of, standing
from encoders.corpus.engine.inbetweens import through
from encoders.corpus.engine.program import AMPLITUDES, program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import tempo
from encoders.corpus.engine.trajectories import STRAIGHT, TURN
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

_SIDED = ("left", "right")


@program(
    "take steps", group="locomotion", parts=LEGS, sides=_SIDED, directions=STRAIGHT, amplitudes=AMPLITUDES,
    counts=(1, 8), weight=2.5,
)  # fmt: skip
def take_steps(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """`count` steps from standing, facing ahead; the last step is mostly closed, sideways steps always."""
    count = step.count or int(rng.integers(1, 4))
    direction = step.direction or "forward"
    closes = direction in _SIDED
    first = SIDE_INDEX[step.side] if step.side else SIDE_INDEX.get(direction.rpartition("-")[2], int(rng.integers(2)))
    length = {"small": 0.6, "": 1.0, "large": 1.4}[step.amplitude] * rng.uniform(0.3, 0.65) * manner.factor("stride")
    length = min(length * (0.8 if closes or "back" in direction else 1.0), 0.75)
    one = rng.uniform(0.4, 0.85) / (tempo(step, rng) * manner.factor("pace"))
    moves = _moves(count, first, closes, step_home=rng.random() < 0.8)
    ends = rng.uniform(0.1, 0.4) + one * np.arange(1.0, len(moves) + 1.0)
    curves = standing(max(frames, frames_of(ends[-1] + rng.uniform(0.2, 0.6))), LEGS)
    _place_feet(
        curves, moves, np.asarray(ends, np.float64), one, length * _way(direction, rng), max(0.07 + manner.lift, 0.03)
    )
    _swing_along(curves, rng.uniform(0.0, 0.5) * manner.factor("swing"))
    return curves


def _moves(count: int, first: int, closes: bool, *, step_home: bool) -> list[tuple[int, int]]:
    """The moving foot and the index of its target, for each step."""
    if closes:
        return [move for i in range(1, count + 1) for move in ((first, i), (1 - first, i))]
    moves = [((first + i) % 2, i + 1) for i in range(count)]
    return [*moves, ((first + count) % 2, count)] if step_home else moves


def _way(direction: str, rng: Generator) -> Array:
    angle = TURN[direction] + rng.normal(0.0, 0.06)
    return np.array([np.sin(angle), np.cos(angle)])


def _place_feet(curves: Curves, moves: list[tuple[int, int]], ends: Array, one: float, way: Array, lift: float) -> None:
    """Feet move to their targets, each within its time, with the hips between them."""
    now, place = np.arange(len(curves)) / FPS, [0, 0]
    weight = [(0.0, 0.0, 0.0)]
    crossing = float(np.sign(way[0])) * (1 if moves[0][0] == LEFT else -1) < 0 and abs(way[0]) > abs(way[1])
    for (foot, to), end in zip(moves, ends, strict=True):
        share = ease((now - end + 0.85 * one) / (0.8 * one))
        gone = (to - place[foot]) * share
        curves.feet[:, foot, 0] += gone * way[0]
        curves.feet[:, foot, 2] += gone * way[1]
        aside = np.sin(np.pi * share)
        curves.feet[:, foot, 1] += lift * aside
        curves.foot_pitch[:, foot] -= 0.3 * np.sin(2 * np.pi * share) * (share < 0.5) * abs(way[1]) * 1.5
        if crossing:
            curves.feet[:, foot, 2] += 0.14 * aside * (1 if foot == moves[0][0] else -1)
        place[foot] = to
        middle = (place[0] + place[1]) / 2
        onto = 0.03 * (1 if foot == LEFT else -1)
        weight += [(end, middle * way[0] + onto, middle * way[1])]
    weight += [(float(now[-1]) + 0.05, weight[-1][1] - (0.03 if moves[-1][0] == LEFT else -0.03), weight[-1][2])]
    table = np.array(weight)
    hips = through(now, table[:, 0], table[:, 1:])
    curves.root[:, 0] += hips[:, 0]
    curves.root[:, 2] += hips[:, 1]
    apart = np.ptp(curves.feet[..., 2], axis=1)
    curves.root[:, 1] -= 0.01 + 0.28 * np.square(apart) / 2 + 0.1 * np.square(np.ptp(curves.feet[..., 0], axis=1)) / 2


def _swing_along(curves: Curves, size: float) -> None:
    """Arms swing opposite to the feet."""
    ahead = np.clip(curves.feet[:, LEFT, 2] - curves.feet[:, RIGHT, 2], -0.6, 0.6)[:, None]
    curves.hands[..., 2] += size * ahead * [-1.0, 1.0]
    curves.spine[:, 2] -= 0.15 * size * ahead[:, 0]


@program(
    "slide foot", group="exercise", parts=LEGS, sides=_SIDED, directions=("forward", "backward", "left", "right"),
    counts=(1, 5), weight=0.8,
)  # fmt: skip
def slide_foot(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """One foot glides out over the ground and back, the other knee bending or not; repeatedly."""
    aside = step.direction if step.direction in _SIDED else ""
    foot = SIDE_INDEX[step.side or aside] if step.side or aside else int(rng.integers(2))
    out = 1.0 if foot == LEFT else -1.0
    direction = step.direction or ("forward", "backward", "left" if foot == LEFT else "right")[int(rng.integers(3))]
    count = step.count or int(rng.integers(1, 4))
    one = rng.uniform(0.9, 1.8) / (tempo(step, rng) * manner.factor("pace"))
    curves = standing(max(frames, frames_of(one * count + 0.4)), LEGS)
    now = np.arange(len(curves)) / FPS - 0.2
    share = np.where((now > 0) & (now < one * count), (now / one) % 1.0, 0.0)
    gone = ease(share / 0.45) * ease((1 - share) / 0.45)
    far = rng.uniform(0.2, 0.55) if direction == "forward" or aside else rng.uniform(0.2, 0.45)
    way = far * np.array([np.sin(TURN[direction]), np.cos(TURN[direction])])
    if way[0] * out < -0.05:  # past the standing foot, in front of it
        curves.feet[:, foot, 2] += 0.14 * np.minimum(2 * gone, 1.0)
    curves.feet[:, foot, 0] += gone * way[0]
    curves.feet[:, foot, 2] += gone * way[1]
    rest = ease((now + 0.2) / 0.3) * ease((now[-1] - now) / 0.2)
    curves.root[:, 0] += -0.06 * out * rest + 0.25 * gone * way[0]
    curves.root[:, 2] += 0.25 * gone * way[1]
    curves.root[:, 1] -= (0.5 * far**2 + rng.uniform(0.0, 0.12)) * gone
    curves.spine[:, 0] += rng.uniform(0.0, 0.25) * gone
    if rng.random() < 0.4:
        place = np.array([(0.3, -0.6, 0.02), (0.6, -0.6, 0.2), (-0.15, -0.7, -0.24)][int(rng.integers(3))])
        curves.hands[:] += (place - curves.hands) * rest[:, None, None]
    return curves
