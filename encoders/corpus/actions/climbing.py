"""Climbing and crawling: stairs, ladders, obstacles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import LEFT, LEGS, RIGHT, Array, Curves, ease, frames_of, keys, standing
from encoders.corpus.engine.gait import PAD, Gait, Trajectory, plant, step_along
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import tempo
from encoders.corpus.engine.trajectories import AHEAD, effort, plan_gait, seconds
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS


@program("climb stairs", group="locomotion", parts=LEGS, directions=("up", "down"), weight=2)
def climb_stairs(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk up or down a flight of stairs, often with a few steps on the level at either end."""
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    down = step.direction == "down" or (not step.direction and rng.random() < 0.3)
    tread, riser = rng.uniform(0.24, 0.32), rng.uniform(0.14, 0.2)
    cadence = rng.uniform(1.4, 1.9)
    gait = Gait(
        speed=tread * cadence, cadence=cadence, lift=0.1 if down else 0.16, arms=0.2, lean=-0.02 if down else 0.16,
        push=0.45, bob=0.01, duty=0.6,
    )  # fmt: skip
    trajectory, gait = plan_gait(
        replace(step, direction="", amplitude=""), gait, replace(manner, stride=0.0), rng, frames
    )
    cadence = float(np.median(np.diff(trajectory.phase))) * 2 * FPS
    run = trajectory.root[:, 1] * (tread * cadence / max(gait.speed, 1e-3))
    trajectory = replace(trajectory, root=np.stack([trajectory.root[:, 0], run], axis=1))
    flat_start, flat_end = rng.choice([0, 0, 2], 2)
    stairs = max(int(run[-PAD] / tread) - flat_end, flat_start + 2)
    number: Array = np.clip(np.floor(run / tread + 0.5), flat_start, stairs) - flat_start
    trajectory = replace(trajectory, level=(-riser if down else riser) * number.astype(np.float64))
    curves = step_along(trajectory, gait, manner)
    lowest = float(np.min(curves.feet[..., 1])) - 0.085
    curves.root[:, 1] -= lowest + (0.03 if down else 0.0)
    curves.feet[..., 1] -= lowest
    curves.head[:, 0] += 0.2 if down else 0.05
    if rng.random() < 0.25:  # a hand on the rail
        curves.hands[:, int(rng.integers(2))] = (0.25, -0.45, 0.45)
    return curves


@program("climb ladder", group="locomotion", directions=("up", "down"), weight=1.5)
def climb_ladder(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Climb rungs hand over hand, a foot and the other hand at a time."""
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    pace = tempo(step, rng) * manner.factor("pace")
    sign = -1.0 if step.direction == "down" else 1.0
    rung = rng.uniform(0.26, 0.34)
    going = effort(frames, rng, rest=0.5)
    phase = rng.random() + np.cumsum(going) * rng.uniform(0.5, 0.75) * pace / FPS
    climbed = 2 * rung * phase * sign
    climbed -= climbed[PAD]
    zero = np.zeros(len(phase))
    # Footholds are planted along z; the ladder is that trajectory turned upright.
    trajectory = Trajectory(np.stack([zero, climbed], axis=1), zero, going, phase)
    curves = standing(frames)
    keep = slice(PAD, -PAD)
    top = rng.uniform(0.05, 0.55)
    base = max(0.0, -float(climbed[keep].min())) + rng.choice([-0.1, 0.25])
    curves.root[:, 1] = 0.88 + base + climbed[keep]
    curves.root[:, 2] = 0.03 * np.sin(4 * np.pi * phase[keep])
    for side, out in ((LEFT, 1.0), (RIGHT, -1.0)):
        own = phase + (0.0 if side == LEFT else 0.5)
        foot, _, lift = plant(trajectory, own, 0.7, out * 0.12)
        hand, _, reach = plant(trajectory, own + 0.5, 0.7, out * 0.2)
        curves.feet[:, side] = np.stack(
            [foot[:, 0], base + 0.12 + foot[:, 2], 0.18 - 0.12 * np.sin(np.pi * lift)], axis=1
        )[keep]
        curves.reach[:, side] = np.stack(
            [hand[:, 0], base + 0.95 + top + hand[:, 2], 0.38 - 0.1 * np.sin(np.pi * reach)], axis=1
        )[keep]
    curves.reach_weight[:] = 1.0
    curves.foot_pitch[:] = -0.1
    curves.pelvis[:, 2] = 0.06 * np.cos(2 * np.pi * phase[keep])
    curves.pelvis[:, 0] = rng.uniform(-0.05, 0.3)
    curves.spine[:, 1] = 0.08 * np.cos(2 * np.pi * phase[keep])
    curves.head[:, 0] = -0.35 * sign + 0.1
    return curves


def _obstacle(
    step: ActionStep, manner: Manner, rng: Generator, frames: int, *, lift: float, level: float, settle: float
) -> Curves:
    """Walk up to an obstacle and over it (both feet raised by `lift`) or onto it (`level` above the ground)."""
    frames = frames or int(rng.uniform(3.0, 4.5) * FPS)
    now, when = seconds(frames), frames / FPS * rng.uniform(0.4, 0.6)
    near = np.exp(-np.square((now - when) / 0.5))
    going = effort(frames, rng, rest=0.7) * (1 - 0.3 * near)
    if settle:
        going = going * (1 - ease((now - when - 0.7) / 0.5))
    gait = Gait(speed=rng.uniform(0.8, 1.2), cadence=rng.uniform(1.4, 1.7), arms=0.3)
    trajectory, gait = plan_gait(replace(step, count=0), gait, manner, rng, frames, going)
    trajectory = replace(
        trajectory, lift=lift * np.exp(-(np.square((now - when) / 0.55) ** 2)), level=np.where(now > when, level, 0.0)
    )
    curves = step_along(trajectory, gait, manner)
    near = near[PAD:-PAD]
    curves.head[:, 0] += 0.3 * near
    curves.spine[:, 0] += 0.15 * near
    curves.hands[..., 0] += 0.25 * near[:, None] * rng.uniform(0.3, 1.0)
    curves.hands[..., 1] += 0.15 * near[:, None]
    middle, half = int(when * FPS), int(0.9 * FPS)
    curves.spans = [(max(0, middle - half), min(frames, middle + half))]
    return curves


@program("step over", group="locomotion", directions=AHEAD[:3], heights=("low", "high"), weight=1.5)
def step_over(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk and step over something on the ground."""
    lift = rng.uniform(*{"low": (0.15, 0.25), "": (0.2, 0.45), "high": (0.4, 0.55)}[step.height])
    return _obstacle(step, manner, rng, frames, lift=lift, level=0.0, settle=0.0)


@program("step up", group="locomotion", directions=("forward",), heights=("low", "high"), weight=1.5)
def step_up(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk up to something, step onto it and stand there."""
    level = rng.uniform(*{"low": (0.12, 0.2), "": (0.18, 0.35), "high": (0.3, 0.45)}[step.height])
    return _obstacle(step, manner, rng, frames, lift=0.1, level=level, settle=1.0)


@program("step down", group="locomotion", directions=("forward",), weight=1.0)
def step_down(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Step down from something and walk on."""
    level = rng.uniform(0.15, 0.35)
    curves = _obstacle(step, manner, rng, frames, lift=0.04, level=-level, settle=0.0)
    curves.root[:, 1] += level
    curves.feet[..., 1] += level
    return curves


def _creep(
    step: ActionStep, manner: Manner, rng: Generator, frames: int, *, speed: float, rate: float
) -> tuple[Trajectory, Array, Gait]:
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    gait = Gait(speed=speed, cadence=rate)
    trajectory, gait = plan_gait(
        step,
        gait,
        replace(manner, limp=0.0, stride=min(manner.stride, 0.0)),
        rng,
        frames,
        effort(frames, rng, rest=0.3),
    )
    return trajectory, trajectory.phase, gait


@program(
    "crawl", group="locomotion", directions=("forward", "backward", "left", "right", "around"), weight=2,
    starts="floor", ends="floor",
)  # fmt: skip
def crawl(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Crawl on hands and knees; sometimes on hands and feet, like a bear."""
    trajectory, phase, _ = _creep(step, manner, rng, frames, speed=rng.uniform(0.35, 0.7), rate=rng.uniform(1.6, 2.4))
    keep = slice(PAD, -PAD)
    facing = trajectory.facing[keep]
    bear = rng.random() < 0.15
    curves = standing(len(facing))
    hips = 0.72 if bear else 0.46
    ahead = 0.62 if bear else 0.5
    curves.heading[:] = facing
    curves.root[:, [0, 2]] = trajectory.root[keep]
    curves.root[:, 1] = hips + 0.01 * np.cos(4 * np.pi * phase[keep])
    curves.pelvis[:, 0] = (1.5 if bear else 1.3) + rng.normal(0.0, 0.07)
    # On all fours a roll about the level spine is a yaw, and a bend to the side sways the hips.
    beat = np.cos(2 * np.pi * phase[keep] + rng.normal(0.0, 0.4))
    curves.heading[:] += rng.uniform(0.02, 0.14) * beat
    curves.pelvis[:, 2] = rng.uniform(0.04, 0.2) * beat
    curves.spine[:, 0] = rng.normal(0.12, 0.12)
    curves.spine[:, 1] = rng.uniform(0.05, 0.3) * beat
    curves.spine[:, 2] = rng.normal(0.0, 0.12) * beat
    curves.root[:, 0] += rng.uniform(0.0, 0.03) * beat * np.cos(facing)
    curves.root[:, 2] -= rng.uniform(0.0, 0.03) * beat * np.sin(facing)
    curves.head[:, 0] = rng.uniform(-1.1, -0.4)
    for side, out in ((LEFT, 1.0), (RIGHT, -1.0)):
        own = phase + (0.0 if side == LEFT else 0.5)
        foot, _, swing = plant(trajectory, own, 0.62, out * 0.12, -0.15 if bear else -0.42)
        hand, _, reach = plant(trajectory, own + 0.5 + 0.08, 0.62, out * 0.19, ahead)
        curves.feet[:, side, 0], curves.feet[:, side, 2] = foot[keep, 0], foot[keep, 2]
        curves.feet[:, side, 1] = ((0.12 if bear else 0.075) + 0.06 * np.sin(np.pi * swing))[keep]
        curves.foot_yaw[:, side] = foot[keep, 3]
        curves.reach[:, side, 0], curves.reach[:, side, 2] = hand[keep, 0], hand[keep, 2]
        curves.reach[:, side, 1] = (0.07 + 0.1 * np.sin(np.pi * reach))[keep]
    curves.foot_pitch[:] = -0.5 if bear else -1.6
    curves.reach_weight[:] = 1.0
    return curves


@program("army crawl", group="locomotion", directions=("forward",), starts="floor", ends="floor")
def army_crawl(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Crawl flat on the belly on the forearms, a knee drawn up at a time."""
    trajectory, phase, _ = _creep(step, manner, rng, frames, speed=rng.uniform(0.2, 0.45), rate=rng.uniform(1.2, 1.8))
    keep = slice(PAD, -PAD)
    cycle = 2 * np.pi * phase[keep]
    facing = trajectory.facing[keep]
    curves = standing(len(facing))
    curves.heading[:] = facing
    curves.root[:, [0, 2]] = trajectory.root[keep]
    curves.root[:, 1] = 0.17
    curves.pelvis[:, 0] = 1.5
    curves.pelvis[:, 2] = 0.18 * np.cos(cycle)
    curves.spine[:, 0] = -0.35
    curves.spine[:, 1] = 0.2 * np.cos(cycle)
    curves.head[:, 0] = -0.8
    for side, out in ((LEFT, 1.0), (RIGHT, -1.0)):
        own = phase + (0.0 if side == LEFT else 0.5)
        hand, _, reach = plant(trajectory, own, 0.6, out * 0.16, 0.72)
        curves.reach[:, side, 0], curves.reach[:, side, 2] = hand[keep, 0], hand[keep, 2]
        curves.reach[:, side, 1] = (0.07 + 0.05 * np.sin(np.pi * reach))[keep]
        drawn = 0.5 - 0.5 * out * np.cos(cycle)
        aside, behind = out * (0.14 + 0.2 * drawn), -0.78 + 0.42 * drawn
        curves.feet[:, side, 0] = curves.root[:, 0] + aside * np.cos(facing) + behind * np.sin(facing)
        curves.feet[:, side, 2] = curves.root[:, 2] - aside * np.sin(facing) + behind * np.cos(facing)
        curves.feet[:, side, 1] = 0.09
        curves.knee[:, side] = out * 1.2 * drawn
    curves.foot_pitch[:] = -1.7
    curves.foot_yaw[:] = facing[:, None]
    curves.reach_weight[:] = 1.0
    return curves


@program("climb over", group="locomotion", directions=("forward",), heights=("low", "high"))
def climb_over(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Put the hands on something waist-high, swing one leg after the other over it and stand behind it."""
    frames = frames or frames_of(rng.uniform(2.8, 4.2) / tempo(step, rng))
    wall = rng.uniform(0.6, 0.95) * {"low": 0.75, "": 1.0, "high": 1.15}[step.height]
    first = int(rng.integers(2))
    curves = standing(frames)
    at = [0.0, 0.15, 0.4, 0.6, 0.85, 1.0]
    path = [(0, 0.9, 0), (0, 0.9, 0.15), (0, wall + 0.18, 0.42), (0, wall + 0.2, 0.6), (0, 0.88, 0.95), (0, 0.9, 1.0)]
    curves.root[:] = keys(frames, list(zip(at, path, strict=True)))
    lead, trail = (0.2, 0.28, 0.38, 0.5), (0.45, 0.58, 0.7, 0.82)
    for side, times in ((first, lead), (1 - first, trail)):
        x = 0.1 if side == LEFT else -0.1
        places = [(x, 0.085, 0.02), (x * 2.5, wall * 0.8, 0.15), (x * 2, wall + 0.12, 0.5), (x, 0.085, 0.98)]
        curves.feet[:, side] = keys(frames, list(zip(times, places, strict=True)))
        curves.knee[:, side] = keys(frames, [(times[0], 0.0), (times[1], 8 * x), (times[2], 8 * x), (times[3], 0.0)])
    curves.spine[:, 0] = keys(frames, [(0.05, 0.0), (0.35, 0.6), (0.65, 0.5), (0.95, 0.0)])
    curves.reach[:] = np.array([[0.2, wall, 0.5], [-0.2, wall, 0.5]])
    curves.reach_weight[:] = keys(frames, [(0.05, 0.0), (0.18, 1.0), (0.68, 1.0), (0.85, 0.0)])[:, None]
    return curves
