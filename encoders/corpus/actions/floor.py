"""Movements to the floor, on it and up again: lie, fall, roll, get up."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ANKLE, HIP, Array, Curves, ease
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.engine.whole_body_poses import STANDING, perform, pose
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

WAYS = ("backward", "forward", "left", "right")


def lying_row(way: str, rng: Generator) -> Array:
    """A lying row: on the back ("backward"), the belly ("forward") or a side; the hips half a metre that way."""
    hands = [(0.15, -0.95, 0.05), (0.6, -0.6, 0.05), (0.3, 0.9, 0.05), (-0.2, -0.45, 0.25)][int(rng.integers(4))]
    if way == "backward":
        legs: dict[str, ArrayLike] = (
            {"feet": (rng.uniform(0.08, 0.25), 0.09, 0.3), "foot_pitch": 0.9, "knee": 0.1}
            if rng.random() < 0.6
            else {"feet": (0.12, ANKLE, -0.05), "foot_pitch": 0.0}
        )
        return pose(root=(0, 0.12, -0.5), pelvis=(-1.5, 0, 0), head=(0.15, 0, 0), hands=hands, hang=0.0, **legs)
    if way == "forward":
        hands = [(0.15, -0.95, -0.05), (0.2, 0.45, 0.1), (-0.1, 0.55, 0.1)][int(rng.integers(3))]
        return pose(
            root=(0, 0.13, 0.6), pelvis=(1.52, 0, 0), head=(-0.3, rng.normal(0, 0.2), rng.normal(0, 0.4)), hands=hands,
            hang=0.0, feet=(rng.uniform(0.08, 0.2), 0.09, -0.2), foot_pitch=-1.5,
        )  # fmt: skip
    sign = 1.0 if way == "left" else -1.0
    bent = rng.uniform(0.1, 0.5)
    away = sign * (-0.28 + 0.6 * bent)
    return pose(
        root=(sign * 0.5, 0.16, 0), pelvis=(0, sign * 1.5, 0), spine=(0.2 + 0.4 * bent, 0, 0), head=(0.1, 0, 0),
        hands=(-0.25, rng.uniform(-0.6, 0.1), 0.4), hang=0.0, foot_pitch=-0.4,
        left_feet=(away, 0.12 - 0.03 * sign, bent - 0.05), right_feet=(away, 0.12 + 0.03 * sign, bent + 0.02),
        left_foot_yaw=-sign * 0.6, right_foot_yaw=-sign * 0.6,
    )  # fmt: skip


def _down(way: str, rng: Generator) -> list[Array]:
    """Rows from standing to the floor in good order, hands first on the ground."""
    if way == "forward":
        kneeling = pose(
            root=(0, 0.47, 0.0), spine=(0.3, 0, 0), feet=(HIP, 0.08, -0.4), foot_pitch=-1.4, hands=(0, -0.6, 0.5)
        )
        fours = pose(
            root=(0, 0.45, 0.05), pelvis=(1.2, 0, 0), head=(-0.5, 0, 0), feet=(HIP, 0.08, -0.38), foot_pitch=-1.5,
            reach=(0.2, 0.07, 0.6),
        )  # fmt: skip
        return [kneeling, fours]
    squatting = pose(
        root=(0, 0.42, -0.15),
        pelvis=(0.3, 0, 0),
        spine=(0.6, 0, 0),
        hands=(0.1, -0.7, 0.4),
        right_reach=(-0.35, 0.06, -0.3),
    )
    if way == "backward":
        seated = pose(
            root=(0, 0.13, -0.45),
            pelvis=(-0.3, 0, 0),
            spine=(0.4, 0, 0),
            feet=(0.12, ANKLE, 0.1),
            reach=(0.25, 0.06, -0.75),
        )
        return [squatting, seated]
    sign = 1.0 if way == "left" else -1.0
    name = "left_reach" if sign > 0 else "right_reach"
    seated = pose(**{
        "root": (sign * 0.2, 0.15, -0.1), "pelvis": (0, sign * 0.6, 0), "spine": (0.3, sign * 0.2, 0),
        "feet": (0.1, 0.09, 0.35), "hands": (0, -0.6, 0.4), name: (sign * 0.65, 0.06, 0.1),
    })  # fmt: skip
    return [pose(root=(0, 0.42, -0.1), spine=(0.6, 0, 0), hands=(0.1, -0.7, 0.4)), seated]


@program("lie down", group="posture", directions=WAYS, ends="floor", weight=2)
def lie_down(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Get down and lie on the back (backward), the belly (forward) or a side."""
    way = step.direction or str(rng.choice(WAYS, p=[0.55, 0.25, 0.1, 0.1]))
    first, second = _down(way, rng)
    lying = lying_row(way, rng)
    frames = duration(4.2, step, manner, rng, frames)
    return perform(frames, [(0.02, STANDING), (0.3, first), (0.55, second), (0.85, lying), (1.0, lying)])


@program("get up", group="posture", directions=WAYS, starts="floor", weight=2)
def get_up(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Rise from lying on the back (backward), the belly (forward) or a side to standing."""
    way = step.direction or str(rng.choice(WAYS, p=[0.55, 0.25, 0.1, 0.1]))
    first, second = _down(way, rng)
    lying = lying_row(way, rng)
    frames = duration(4.0, step, manner, rng, frames)
    return perform(frames, [(0.1, lying), (0.4, second), (0.65, first), (0.95, STANDING), (1.0, STANDING)])


@program("lie", group="posture", directions=WAYS, starts="floor", ends="floor")
def lie(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Lie still."""
    frames = duration(3.5, step, manner, rng, frames)
    row = lying_row(step.direction or str(rng.choice(WAYS)), rng)
    curves = perform(frames, [(0.0, row), (1.0, row)])
    breath = np.sin(2 * np.pi * rng.uniform(0.2, 0.35) * np.arange(frames) / FPS)
    curves.spine[:, 0] += 0.015 * breath
    return curves


def falling_row(way: str) -> Array:
    """Half-way to the ground, the arms flung out to catch the body."""
    if way == "forward":
        return pose(
            root=(0, 0.55, 0.3), pelvis=(0.75, 0, 0), spine=(0.2, 0, 0), head=(-0.5, 0, 0), hands=(0.0, 0.2, 0.75),
            foot_pitch=-0.7, feet=(HIP, ANKLE + 0.06, -0.05),
        )  # fmt: skip
    if way == "backward":
        return pose(
            root=(0, 0.42, -0.4), pelvis=(-0.55, 0, 0), spine=(0.6, 0, 0), head=(0.3, 0, 0), hands=(0.5, -0.2, 0.45),
            foot_pitch=0.4,
        )  # fmt: skip
    sign = 1.0 if way == "left" else -1.0
    return pose(
        root=(sign * 0.3, 0.5, 0), pelvis=(0.1, sign * 0.8, 0), spine=(0.3, -sign * 0.2, 0), hands=(0.5, -0.2, 0.4)
    )


@program("fall", group="posture", directions=WAYS, ends="floor", weight=2)
def fall(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Fall to the ground, forward, backward or to a side, and stay there; sometimes get up."""
    way = step.direction or str(rng.choice(WAYS))
    lying = lying_row(way, rng)
    wobble = pose(root=(0, 0.87, 0), spine=(0.2, 0.1, 0), hands=(0.5, -0.3, 0.3))
    going = falling_row(way)
    frames = duration(rng.uniform(2.0, 3.5), step, manner, rng, frames)
    drop = rng.uniform(0.45, 0.8) * FPS / frames
    begin = rng.uniform(0.1, 0.35)
    keys = [(0.0, STANDING), (begin, wobble), (begin + 0.55 * drop, going), (begin + drop, lying), (1.0, lying)]
    return perform(frames, keys)


@program("faint", group="posture", directions=("left", "right", "backward"), ends="floor", weight=0.7)
def faint(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Go limp: knees give way, the body sinks and lies."""
    way = step.direction or str(rng.choice(["backward", "left", "right"]))
    sign = {"left": 1.0, "right": -1.0}.get(way, 0.0)
    limp = pose(root=(0, 0.84, 0), spine=(0.2, 0.2 * sign, 0), head=(0.5, 0.3 * sign, 0), left_hands=(-0.3, 0.35, 0.3))
    sunk = pose(
        root=(0.15 * sign, 0.35, -0.2),
        pelvis=(-0.1, 0.3 * sign, 0),
        spine=(0.6, 0.3 * sign, 0),
        head=(0.6, 0, 0),
        hands=(0.2, -0.9, 0.1),
    )
    frames = duration(3.2, step, manner, rng, frames)
    lying = lying_row(way, rng)
    return perform(frames, [(0.0, STANDING), (0.3, limp), (0.5, sunk), (0.68, lying), (1.0, lying)])


@program(
    "roll over", group="posture", directions=("left", "right"), counts=(1, 3), starts="roll", ends="roll", weight=1
)
def roll_over(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Roll over the ground, stretched out, about the body's long axis."""
    count = step.count or rng.choice([0.5, 1, 1, 2])
    sign = 1.0 if (step.direction or rng.choice(["left", "right"])) == "left" else -1.0
    frames = duration(1.6 * max(count, 1), step, manner, rng, frames)
    rolled = 2 * np.pi * float(count) * ease((np.linspace(0, 1, frames) - 0.1) / 0.8)
    raised = rng.random() < 0.5
    row = pose(root=(0, 0.15, 0), pelvis=(0, 0, 0), hands=(0.1, 0.93, 0.1) if raised else (0.05, -0.95, 0.05), hang=0.0)
    curves = perform(frames, [(0.0, row), (1.0, row)])
    # The body lies along x, head to +x; it turns about that axis and travels along z.
    curves.pelvis[:, 1] = np.pi / 2
    curves.pelvis[:, 0] = -np.pi / 2 + sign * rolled
    curves.root[:, 2] = sign * 0.14 * rolled
    pitch = curves.pelvis[:, 0]
    for side, out in ((0, 0.09), (1, -0.09)):
        curves.feet[:, side, 0] = -0.8
        curves.feet[:, side, 1] = 0.14 - out * np.sin(pitch) * -1.0
        curves.feet[:, side, 2] = curves.root[:, 2] - out * np.cos(pitch)
    curves.foot_yaw[:] = -np.pi / 2
    curves.foot_pitch[:] = -0.3
    return curves
