"""Jumps: with both feet, hops, leaps, hurdles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import (
    ANKLE,
    HIP,
    LEFT,
    LEGS,
    RIGHT,
    SIDE_INDEX,
    STAND,
    Array,
    Curves,
    ease,
    frames_of,
    standing,
)
from encoders.corpus.engine.gait import PAD, Gait, step_along, swing_arms
from encoders.corpus.engine.program import AMPLITUDES, program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.trajectories import TURN, effort, plan_gait
from encoders.corpus.engine.whole_body_poses import perform, pose
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

_GRAVITY = 9.81


def _jumps(
    manner: Manner,
    rng: Generator,
    count: int,
    *,
    height: float,
    stride: Array,
    angle: float,
    tuck: float,
    wind_up: float,
) -> Curves:
    """Both-footed jumps in a row.

    Parameters
    ----------
    height : float
        Rise of the hips in metres.
    stride : (2,)
        x and z of one jump, in the frame it starts in.
    angle : float
        Turn in the air.
    tuck : float
        How far the feet are drawn up.
    wind_up : float
        Seconds of crouching before the jump.
    """
    flight = 2 * np.sqrt(2 * height / _GRAVITY)
    push, landing = 0.16, rng.uniform(0.3, 0.45)
    bounds = np.array([0.0, wind_up, wind_up + push, wind_up + push + flight])
    period = bounds[-1] + landing
    frames = max(int(period * count * FPS) + 1, 8)
    time = np.arange(frames) / FPS
    number = np.minimum((time / period).astype(np.int64), count - 1)
    local = time - number * period
    crouch, rise = local / wind_up, (local - bounds[1]) / push
    air, land = np.clip((local - bounds[2]) / flight, 0.0, 1.0), (local - bounds[3]) / landing
    depth = rng.uniform(0.14, 0.28)
    sink = ease(crouch) * (1 - ease(rise)) + 0.75 * ease(land / 0.35) * (1 - ease((land - 0.35) / 0.65)) * (air >= 1)
    up = height * 4 * air * (1 - air)
    # The hips lead at take-off and trail the feet at landing.
    gone = number + 0.22 * ease(rise) + 0.6 * air + 0.18 * ease(land / 0.5) * (air >= 1)
    turned = angle * (number + ease(air))
    landed = number + ease((air - 0.1) / 0.8)
    start = angle * np.arange(count + 1)
    spots = np.concatenate(
        [np.zeros((1, 2)), np.cumsum([[stride[0] * np.cos(a) + stride[1] * np.sin(a),
                                       stride[1] * np.cos(a) - stride[0] * np.sin(a)] for a in start[:-1]], axis=0)]
    )  # fmt: skip
    at = np.arange(count + 1)
    curves = standing(frames)
    curves.heading[:] = turned
    for axis, column in ((0, 0), (2, 1)):
        curves.root[:, axis] = np.interp(gone, at, spots[:, column])
    curves.root[:, 1] = STAND - depth * sink + up + 0.06 * ease(rise) * (air <= 0) + 0.06 * (air > 0) * (1 - air)
    centre = np.stack([np.interp(landed, at, spots[:, 0]), np.interp(landed, at, spots[:, 1])], axis=1)
    apart = HIP * rng.uniform(0.9, 1.5)
    toes = ease((rise - 0.4) / 0.6) * (1 - ease(air / 0.7)) * (land <= 0)
    for side, sign in ((LEFT, 1.0), (RIGHT, -1.0)):
        curves.feet[:, side, 0] = centre[:, 0] + sign * apart * np.cos(turned)
        curves.feet[:, side, 2] = centre[:, 1] - sign * apart * np.sin(turned)
        curves.feet[:, side, 1] = ANKLE + up + tuck * np.sin(np.pi * air) + 0.09 * toes
        curves.foot_pitch[:, side] = -0.8 * toes
    curves.foot_yaw[:] += turned[:, None]
    bow = rng.uniform(0.25, 0.8) * sink
    curves.spine[:, 0] = 0.5 * bow
    curves.pelvis[:, 0] = 0.5 * bow
    curves.head[:, 0] = -0.5 * bow
    lift = rng.choice([rng.uniform(0.2, 1.0), rng.uniform(0.8, 2.6)]) * float(np.clip(manner.factor("reach"), 0.5, 1.3))
    swing = -rng.uniform(0.3, 1.0) * ease(crouch) * (1 - ease(rise * 0.9)) + lift * ease(rise) * (1 - ease(land + 0.35))
    swing_arms(curves, swing[:, None] + np.zeros(2), np.full((frames, 2), rng.uniform(0.3, 0.7)), 0.16)
    return curves


_RISE = {
    "low": (0.05, 0.12),
    "small": (0.05, 0.12),
    "": (0.09, 0.3),
    "middle": (0.15, 0.3),
    "large": (0.35, 0.5),
    "high": (0.35, 0.5),
}


@program(
    "jump", group="locomotion", directions=("up", "forward", "backward", "left", "right", "in place", "around"),
    amplitudes=AMPLITUDES, heights=("low", "high"), counts=(1, 6), weight=3,
)  # fmt: skip
def jump(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Jump with both feet, once or several times."""
    count = step.count or int(rng.choice([1, 1, 2, 3]))
    far = {"small": 0.5, "": 1.0, "large": 1.5}[step.amplitude]
    upright = step.direction in ("", "up", "in place", "around")
    way = 0.0 if upright and (step.direction or rng.random() < 0.7) else rng.uniform(0.4, 1.3) * far
    way *= {"left": 0.6, "right": 0.6, "backward": 0.5}.get(step.direction, 1.0)
    toward = TURN.get(step.direction, 0.0)
    angle = rng.choice([-1, 1]) * np.pi * rng.uniform(0.9, 1.1) if step.direction == "around" else rng.normal(0, 0.03)
    height = rng.uniform(*_RISE[step.height or step.amplitude]) * float(np.clip(manner.factor("bounce"), 0.6, 1.3))
    return _jumps(
        manner, rng, count, height=height, stride=way * np.array([np.sin(toward), np.cos(toward)]), angle=float(angle),
        tuck=rng.uniform(0.0, 0.32), wind_up=rng.uniform(0.3, 0.55) / manner.factor("pace") if count < 3 else 0.25,
    )  # fmt: skip


@program("jump over", group="locomotion", directions=("forward", "left", "right"), heights=("low", "high"), weight=1.5)
def jump_over(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Jump over something with both feet, knees drawn up."""
    toward = TURN[step.direction]
    stride = rng.uniform(0.6, 1.3) * np.array([np.sin(toward), np.cos(toward)]) * (1.0 if not toward else 0.6)
    return _jumps(
        manner, rng, 1, height=rng.uniform(*_RISE[step.height or "middle"]) + 0.1, stride=stride, angle=0.0,
        tuck=rng.uniform(0.2, 0.4), wind_up=rng.uniform(0.3, 0.5),
    )  # fmt: skip


@program(
    "spin jump",
    group="locomotion",
    directions=("left", "right", "clockwise", "counterclockwise", "around"),
    degrees=(90, 180, 360),
)
def spin_jump(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Jump up and turn in the air."""
    side = {"left": 1, "counterclockwise": 1, "right": -1, "clockwise": -1}.get(step.direction, rng.choice([-1, 1]))
    usual = {"left": 90, "right": 90, "around": 180}.get(step.direction, rng.choice([180, 360]))
    degrees = step.degrees or usual
    return _jumps(
        manner, rng, 1, height=rng.uniform(0.2, 0.45), stride=np.zeros(2), angle=float(side * np.deg2rad(degrees)),
        tuck=0.05, wind_up=rng.uniform(0.3, 0.55),
    )  # fmt: skip


@program(
    "hop",
    group="locomotion",
    parts=LEGS,
    sides=("left", "right"),
    directions=("forward", "in place", "backward", "left", "right"),
    counts=(2, 8),
    weight=1.5,
)
def hop(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Hop on one leg, the other held bent."""
    on = SIDE_INDEX[step.side] if step.side else int(rng.integers(2))
    count = step.count or int(rng.integers(3, 8))
    period = rng.uniform(0.38, 0.6)
    settle = 0.35
    frames = int((count * period + 2 * settle) * FPS)
    time = np.arange(frames) / FPS - settle
    beat = np.clip(time / period, 0.0, count)
    number = np.minimum(np.floor(beat), count - 1)
    air = np.clip((beat - number - 0.4) / 0.6, 0.0, 1.0)
    toward = TURN.get(step.direction, 0.0)
    way = 0.0 if step.direction in ("", "in place") else rng.uniform(0.25, 0.55)
    gone = way * (number + air)
    raised = ease((time + settle) / settle) * ease((count * period + settle - time) / settle)
    sign = 1.0 if on == LEFT else -1.0
    up = rng.uniform(0.06, 0.16) * 4 * air * (1 - air)
    curves = standing(frames, LEGS)
    curves.root[:, 0] = np.sin(toward) * gone + sign * 0.06 * raised
    curves.root[:, 2] = np.cos(toward) * gone
    curves.root[:, 1] = STAND - raised * 0.05 * (1 + np.cos(2 * np.pi * beat)) / 2 + up
    curves.feet[..., 0] += np.sin(toward) * gone[:, None]
    curves.feet[..., 2] += np.cos(toward) * gone[:, None]
    curves.feet[:, on, 0] -= 0.04 * sign * raised
    curves.feet[..., 1] += up[:, None]
    free, back = 1 - on, rng.choice([-0.35, -0.3, 0.15])
    curves.feet[:, free, 1] += raised * rng.uniform(0.25, 0.45)
    curves.feet[:, free, 2] += raised * back
    curves.foot_pitch[:, free] = -0.8 * raised
    curves.foot_pitch[:, on] = -0.5 * np.sin(np.pi * air)
    curves.pelvis[:, 1] = 0.08 * sign * raised
    swing = 0.3 * raised * np.sin(2 * np.pi * beat)
    swing_arms(curves, swing[:, None] + 0.1, np.full((frames, 2), 0.3) + raised[:, None] * rng.uniform(0.3, 0.9), 0.25)
    return curves


def _flights(
    step: ActionStep, gait: Gait, manner: Manner, rng: Generator, frames: int, *, count: int, height: float, over: float
) -> Curves:
    """Run and fly `count` times from one foot to the other, legs split; `over` raises the feet in flight."""
    air = 2 * np.sqrt(2 * height / _GRAVITY)
    frames = frames or int((1.6 + count * (air + 1.2)) * FPS)
    trajectory, gait = plan_gait(step, gait, manner, rng, frames, effort(frames, rng, rest=0.4))
    # The phase of the legs is stretched from take-off to landing while the body travels on.
    index = np.arange(len(trajectory.phase), dtype=np.float64)
    begin, end = trajectory.phase[PAD], trajectory.phase[-PAD]
    takeoff = np.round(2 * (begin + (end - begin) * (np.arange(count) + 0.5) / (count + 0.4))) / 2 + gait.duty
    edges = np.stack([takeoff, takeoff + 0.5 - gait.duty], axis=1).ravel()
    before = np.interp(edges, trajectory.phase, index)
    extra = np.maximum(air * FPS - np.diff(before)[::2], 0.0)
    after = before + np.repeat(np.cumsum(extra), 2) - np.stack([extra, 0 * extra], axis=1).ravel()
    clock = np.interp(index, [index[0], *after, index[-1] + extra.sum()], [index[0], *before, index[-1]])
    share = np.clip((index[:, None] - after[::2]) / np.diff(after)[::2], 0.0, 1.0)
    flight = (4 * share * (1 - share)).sum(1)
    lift = over * np.sqrt(flight)
    trajectory = replace(trajectory, phase=np.interp(clock, index, trajectory.phase), lift=lift)
    curves = step_along(trajectory, gait, manner)
    flight = flight[PAD:-PAD]
    curves.root[:, 1] += height * flight
    curves.feet[..., 1] += height * flight[:, None]
    curves.hands[..., 0] += rng.uniform(0.2, 0.6) * flight[:, None]
    curves.hands[..., 1] += rng.uniform(0.1, 0.5) * flight[:, None]
    first, last = after[0] - PAD - 0.5 * FPS, after[-1] - PAD + 0.5 * FPS
    if count == 1:
        curves.spans = [(max(int(first), 0), min(int(last), frames))]
    return curves


_RUN = Gait(
    duty=0.38, lift=0.26, bob=0.03, push=0.9, lean=0.16, arms=0.6, elbow=1.2, width=0.06, crouch=0.05, cadence=2.7
)


@program("leap", group="locomotion", directions=("forward", "left", "right"), counts=(1, 3), weight=1.5)
def leap(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """A run-up and a long jump from one foot to the other."""
    gait = replace(_RUN, speed=rng.uniform(2.2, 3.6))
    height = rng.uniform(0.15, 0.4)
    return _flights(step, gait, manner, rng, frames, count=step.count or 1, height=height, over=0.1)


@program("hurdle", group="sport", directions=("forward",), counts=(1, 3))
def hurdle(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Run over hurdles, knees high."""
    gait = replace(_RUN, speed=rng.uniform(3.0, 4.5), lean=0.3)
    return _flights(
        step,
        gait,
        manner,
        rng,
        frames,
        count=step.count or int(rng.integers(1, 4)),
        height=rng.uniform(0.2, 0.4),
        over=0.35,
    )


def _crouched(depth: float, hands: ArrayLike) -> Array:
    return pose(
        root=(0, STAND - depth, -0.3 * depth), pelvis=(0.9 * depth, 0, 0), spine=(1.6 * depth, 0, 0), hands=hands
    )


@program("jump start", group="locomotion", amplitudes=AMPLITUDES, ends="air", styled=False)
def jump_start(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Sink into the knees, push off and rise: a jump as far as its highest point."""
    high = rng.uniform(0.2, 0.5) * {"small": 0.6, "": 1.0, "large": 1.4}[step.amplitude]
    dip, push, rise = rng.uniform(0.3, 0.6), 0.17, float(np.sqrt(2 * high / _GRAVITY))
    total = dip + push + rise
    back, up = (0.2, -0.8, -0.45), [(0.05, 0.9, 0.2), (0.0, 0.1, 0.8), (0.4, -0.4, 0.3)][int(rng.integers(3))]
    tiptoe = pose(
        root=(0, STAND + 0.07, 0.03), feet=(HIP, ANKLE + 0.08, 0.02), foot_pitch=-0.7, hands=(0.3, -0.6, 0.45)
    )
    flying = pose(root=(0, STAND + 0.07, 0.03), feet=(HIP, ANKLE + 0.08, 0.0), foot_pitch=-0.8, hands=up)
    keys = [(0.0, pose()), (dip / total, _crouched(rng.uniform(0.2, 0.35), back)), ((dip + push) / total, tiptoe)]
    curves = perform(frames_of(total), [*keys, (1.0, flying)])
    local = np.maximum(np.arange(len(curves)) / FPS - dip - push, 0.0)
    _raise(curves, np.sqrt(2 * high * _GRAVITY) * local - _GRAVITY / 2 * local**2)
    return curves


@program("land", group="locomotion", amplitudes=AMPLITUDES, starts="air", styled=False)
def land(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Come down from a jump or a ledge, absorb it with the knees, and rise; a hard landing goes to a hand."""
    high = rng.uniform(0.25, 0.8) * {"small": 0.5, "": 1.0, "large": 1.6}[step.amplitude]
    fall, sink, rest = float(np.sqrt(2 * high / _GRAVITY)), rng.uniform(0.18, 0.3), rng.uniform(0.0, 0.4)
    rise = rng.uniform(0.4, 0.9)
    total = fall + sink + rest + rise
    arms = [(0.6, -0.1, 0.3), (0.35, 0.3, 0.4), (0.3, -0.6, 0.3)][int(rng.integers(3))]
    flying = pose(
        root=(0, STAND - 0.03, 0), hands=arms, spine=(0.15, 0, 0), feet=(1.3 * HIP, ANKLE + 0.02, 0.06), foot_pitch=-0.4
    )
    touching = pose(root=(0, STAND - 0.08, -0.05), hands=arms, spine=(0.25, 0, 0), feet=(1.3 * HIP, ANKLE, 0.06))
    low = _crouched(min(0.25 + 0.35 * high, 0.55), (0.2, -0.6, 0.4))
    if high > 0.6 and rng.random() < 0.4:
        low = pose(root=(0, 0.36, -0.15), pelvis=(0.6, 0, 0), spine=(0.7, 0, 0), right_reach=(-0.2, 0.05, 0.4))
    at = np.cumsum([fall, sink, rest]) / total
    curves = perform(frames_of(total), [(0.0, flying), (at[0], touching), (at[1], low), (at[2], low), (1.0, pose())])
    curves.feet[..., [0, 2]] = curves.feet[0, :, [0, 2]].T  # they stay where they land
    curves.feet[..., 1] = np.where(np.arange(len(curves))[:, None] / FPS > fall, ANKLE, curves.feet[..., 1])
    before = np.minimum(np.arange(len(curves)) / FPS, fall)
    _raise(curves, high - _GRAVITY / 2 * before**2)
    return curves


def _raise(curves: Curves, by: Array) -> None:
    """Lift the whole body by (F,) metres, in place."""
    curves.root[:, 1] += by
    curves.feet[..., 1] += by[:, None]
