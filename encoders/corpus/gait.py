"""Footsteps planted along a path: the engine under everything that walks, runs, turns or marches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from encoders.corpus.curves import ANKLE, LEFT, LEGS, RIGHT, STAND, Array, Curves, ease, standing
from encoders.corpus.style import Manner
from encoders.motion import FPS

#: Frames computed before and after those kept, so that footholds outside them are known.
PAD = 30
_BALL = (0.065, 0.13)  # ball of the foot below and ahead of the ankle, metres


@dataclass(frozen=True)
class Gait:
    """How legs and arms carry the body; metres, radians, seconds.

    Attributes
    ----------
    speed : float
        Metres a second along the path.
    cadence : float
        Steps a second, both feet together.
    duty : float
        Share of a cycle that a foot stands; under 0.5 the body flies.
    lift : float
        How high the ankle rises in the swing.
    bob : float
        Rise and fall of the hips.
    push : float
        How far the heel rises in push-off, radians.
    lean : float
        Spine forward.
    arms : float
        Swing of the upper arm to either side of its middle, radians.
    elbow : float
        Bend of the elbow, radians.
    width : float
        Half the distance of the feet.
    crouch : float
        How much lower than standing the hips travel.
    """

    speed: float = 1.25
    cadence: float = 1.85
    duty: float = 0.62
    lift: float = 0.09
    bob: float = 0.02
    push: float = 0.6
    lean: float = 0.03
    arms: float = 0.4
    elbow: float = 0.35
    width: float = 0.08
    crouch: float = 0.015


@dataclass(frozen=True)
class Course:
    """Where a performer goes, on F + 2 PAD frames.

    Attributes
    ----------
    root : float array (F + 2 PAD, 2)
        x and z of the hips.
    facing : float array (F + 2 PAD,)
        Heading of the body.
    effort : float array (F + 2 PAD,)
        0 standing still to 1 full stride.
    phase : float array (F + 2 PAD,)
        Gait cycles since some start, never decreasing; the left foot lands at whole numbers.
    """

    root: Array
    facing: Array
    effort: Array
    phase: Array


def swing_arms(curves: Curves, upper: Array, bend: Array, out: float | Array = 0.13) -> None:
    """Let both arms swing in the body's middle plane.

    Parameters
    ----------
    upper, bend : float array (F, 2)
        Upper arm forward of hanging; elbow bend; radians.
    out : float or (F, 2)
        Wrist outward of its shoulder, arm lengths.
    """
    curves.hands[..., 0] = out
    curves.hands[..., 1] = -0.5 * np.cos(upper) - 0.49 * np.cos(upper + bend)
    curves.hands[..., 2] = 0.5 * np.sin(upper) + 0.49 * np.sin(upper + bend)
    reach = np.sqrt((curves.hands[..., 1:] ** 2).sum(-1))
    curves.hands[..., 1:] *= (np.minimum(reach, np.sqrt(0.97 - np.square(np.minimum(np.abs(out), 0.6)))) / reach)[
        ..., None
    ]


def _foot(course: Course, gait: Gait, manner: Manner, side: int) -> tuple[Array, Array, Array]:
    """Ankle (N, 3), foot pitch (N,) and foot yaw (N,) of one side."""
    phase = course.phase + (0.0 if side == LEFT else 0.5)
    first, last = int(np.floor(phase[0])) - 1, int(np.floor(phase[-1])) + 2
    steps = np.arange(first, last + 1)
    # A foot is put down where the hips will be in the middle of its stance.
    clock = np.arange(len(phase)) + np.linspace(0.0, 1e-6, len(phase))
    middle = np.interp(steps + gait.duty / 2, phase + np.linspace(0.0, 1e-9, len(phase)), clock)
    frames = np.arange(len(phase))
    facing = np.interp(middle, frames, course.facing)
    width = (gait.width * np.clip(np.exp(manner.width), 0.3, 2.2)) * (1.0 if side == LEFT else -1.0)
    holds = np.stack(
        [
            np.interp(middle, frames, course.root[:, 0]) + width * np.cos(facing),
            np.interp(middle, frames, course.root[:, 1]) - width * np.sin(facing),
            facing,
        ],
        axis=1,
    )
    index = np.floor(phase).astype(np.int64)
    share = phase - index
    swing = np.clip((share - gait.duty) / (1 - gait.duty), 0.0, 1.0)
    move = ease(swing)[:, None]
    here = holds[index - first] * (1 - move) + holds[index - first + 1] * move
    effort = course.effort
    raised = max(gait.lift + manner.lift, 0.02) * effort * np.sin(np.pi * swing) ** 1.5
    # Push-off: the heel rises about the ball of the foot, then the toes come up for landing.
    off = ease((share - 0.62 * gait.duty) / (0.38 * gait.duty)) * (1 - ease(swing / 0.6))
    land = ease((swing - 0.5) / 0.5) + np.where(share < gait.duty, 1 - ease(share / (0.2 * gait.duty)), 0.0)
    heel = gait.push * effort * off
    down, ahead = _BALL
    forward = down * np.sin(heel) + ahead * (1 - np.cos(heel))
    up = ahead * np.sin(heel) - down * (1 - np.cos(heel))
    ankle = np.stack(
        [
            here[:, 0] + forward * np.sin(here[:, 2]),
            ANKLE + raised + up,
            here[:, 1] + forward * np.cos(here[:, 2]),
        ],
        axis=1,
    )
    return ankle, 0.25 * min(gait.push, 0.6) / 0.6 * effort * np.minimum(land, 1.0) - heel, here[:, 2]


def step_along(course: Course, gait: Gait, manner: Manner) -> Curves:
    """Curves of a body that goes along a course; every part is posed, "legs" are needed."""
    keep = slice(PAD, len(course.phase) - PAD)
    phase, effort = course.phase[keep], course.effort[keep]
    curves = standing(len(phase), LEGS)
    for side in (LEFT, RIGHT):
        ankle, pitch, yaw = _foot(course, gait, manner, side)
        curves.feet[:, side], curves.foot_pitch[:, side] = ankle[keep], pitch[keep]
        curves.foot_yaw[:, side] += yaw[keep]
    cycle = 2 * np.pi * phase
    middle = cycle - np.pi * gait.duty  # 0 in the middle of the left foot's stance
    flight = -1.0 if gait.duty < 0.5 else 1.0
    sway = 0.022 * np.clip(manner.factor("sway"), 0.2, 2.5) * effort * np.cos(middle)
    facing = course.facing[keep]
    curves.root[:, 0] = course.root[keep, 0] + sway * np.cos(facing)
    curves.root[:, 2] = course.root[keep, 1] - sway * np.sin(facing)
    bob = gait.bob * np.clip(manner.factor("bounce"), 0.2, 2.5)
    limp = manner.limp * np.cos(middle)  # sparing the left leg: sink and lean while it stands
    curves.root[:, 1] = STAND - gait.crouch * effort + effort * (bob * flight * np.cos(2 * middle) - 0.03 * limp)
    curves.heading[:] = facing
    roll = 0.05 * np.clip(manner.factor("sway"), 0.2, 3.0)
    twist = np.clip(manner.factor("twist"), 0.2, 2.5) * min(gait.speed + 0.3, 2.0) * 0.06
    curves.pelvis[:, 1] = -roll * effort * np.cos(middle)
    curves.pelvis[:, 2] = -twist * effort * np.cos(cycle)
    curves.pelvis[:, 0] = 0.35 * gait.lean * effort
    curves.spine[:, 0] = 0.65 * gait.lean * effort
    curves.spine[:, 1] = 0.6 * roll * effort * np.cos(middle) + 0.12 * limp * effort
    curves.spine[:, 2] = 1.7 * twist * effort * np.cos(cycle)
    curves.head[:, 0] = -0.5 * gait.lean * effort
    curves.head[:, 2] = -0.7 * twist * effort * np.cos(cycle)
    swing = gait.arms * np.clip(manner.factor("swing"), 0.05, 2.2)
    sides = np.stack([-np.cos(cycle - 0.15), np.cos(cycle - 0.15)], axis=1)
    upper = effort[:, None] * (swing * sides - 0.12 * gait.elbow)
    bend = 0.2 + effort[:, None] * (gait.elbow - 0.2 + 0.45 * swing * (sides + 0.3))
    swing_arms(
        curves,
        upper,
        np.maximum(bend, 0.05),
        0.13 - 0.1 * np.maximum(sides, 0.0) * effort[:, None] * min(gait.elbow, 1.0),
    )
    return curves


def cadence_phase(rate: Array, start: float, manner: Manner) -> Array:
    """Gait cycles from steps a second (N,); uneven where the manner limps or stops and goes."""
    phase = start + np.cumsum(rate) / (2 * FPS)
    angle = 2 * np.pi * phase
    uneven = 0.045 * np.clip(manner.limp, -1.2, 1.2) * np.sin(angle)
    return np.asarray(phase + uneven + 0.05 * np.clip(manner.jerk, 0.0, 1.2) * np.sin(2 * angle) / 2)
