"""Unbalanced and sliding gaits: stagger, stumble, push, beam, moonwalk, skates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import BODY, LEFT, LEGS, RIGHT, Curves, frames_of
from encoders.corpus.engine.gait import PAD, Gait, Trajectory, gait_phase, step_along
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.trajectories import TURN, effort, perform_gait, plan_gait, seconds
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS


@program(
    "stagger", group="locomotion", parts=LEGS, directions=("forward", "backward", "left", "right", "around"), weight=1.5
)
def stagger(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Stagger as if drunk: a wandering path, a swaying trunk, uneven wide steps."""
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    manner = replace(manner, width=manner.width + 0.4, sway=manner.sway + 0.5, wander=max(manner.wander, 0.1))
    gait = Gait(speed=rng.uniform(0.5, 1.0), cadence=rng.uniform(1.4, 1.9), arms=0.3, push=0.4)
    trajectory, gait = plan_gait(step, gait, manner, rng, frames)
    now = seconds(frames)
    reel = sum(
        rng.normal(0.0, 0.12) * np.sin(2 * np.pi * (rng.uniform(0.2, 0.6) * now + rng.random())) for _ in range(3)
    )
    aside = np.stack([np.cos(trajectory.facing), -np.sin(trajectory.facing)], axis=1)
    root = trajectory.root + np.asarray(reel)[:, None] * aside * 1.5
    trajectory = replace(
        trajectory, root=root - root[PAD], facing=trajectory.facing + np.asarray(reel) - np.asarray(reel)[PAD]
    )
    curves = step_along(trajectory, gait, manner)
    lean = np.gradient(np.asarray(reel))[PAD:-PAD] * FPS
    curves.spine[:, 1] += 0.7 * lean
    curves.pelvis[:, 1] += 0.3 * lean
    curves.hands[..., 0] += np.array([1.0, -1.0]) * 0.4 * lean[:, None] + 0.15
    return curves


@program("stumble", group="locomotion", parts=LEGS, directions=("forward", "left", "right", "backward"), weight=1.5)
def stumble(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk, trip, catch oneself with quick steps and go on."""
    frames = frames or int(rng.uniform(2.5, 5.0) * FPS)
    now = seconds(frames)
    when = frames / FPS * rng.uniform(0.3, 0.6)
    trip = np.exp(-np.square((now - when) / rng.uniform(0.2, 0.35)))
    gait = Gait(speed=rng.uniform(0.9, 1.3), cadence=rng.uniform(1.7, 2.0))
    going = effort(frames, rng) * (1 + 0.7 * trip)
    trajectory, gait = plan_gait(step, gait, manner, rng, frames, going)
    phase = trajectory.phase + 0.5 * np.cumsum(trip) / FPS
    curves = step_along(replace(trajectory, phase=phase, effort=np.minimum(trajectory.effort, 1.2)), gait, manner)
    trip = trip[PAD:-PAD]
    back = -1.0 if step.direction == "backward" else 1.0
    curves.pelvis[:, 0] += back * rng.uniform(0.25, 0.5) * trip
    curves.spine[:, 0] += back * rng.uniform(0.2, 0.5) * trip
    curves.pelvis[:, 1] += {"left": 0.3, "right": -0.3}.get(step.direction, rng.normal(0, 0.15)) * trip
    curves.root[:, 1] -= rng.uniform(0.05, 0.15) * trip
    flung = trip[:, None] * rng.uniform(0.5, 1.0, 2)
    curves.hands[..., 0] += 0.4 * flung
    curves.hands[..., 1] += 0.55 * flung
    curves.hands[..., 2] += 0.45 * flung
    return curves


#: Where a push throws the body: chest pitched forward, and to the left; radians.
_THROWN = {"forward": (0.55, 0.0), "backward": (-0.5, 0.0), "left": (0.05, 0.5), "right": (0.05, -0.5)}


@program(
    "get pushed", group="locomotion", parts=BODY, directions=("forward", "backward", "left", "right"), counts=(1, 3),
    weight=1.2,
)  # fmt: skip
def get_pushed(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Stand, be pushed in the direction, stagger some steps with flailing arms, and regain balance."""
    direction = step.direction or str(rng.choice(list(_THROWN)))
    count = step.count or 1
    lasts = rng.uniform(1.4, 2.2)
    frames = max(frames, frames_of(lasts * count + rng.uniform(0.8, 2.0)))
    now = seconds(frames)
    starts = rng.uniform(0.3, 0.8) + lasts * np.arange(count)
    since = now[:, None] - starts
    burst = np.where(since > 0, np.square(since / 0.3) * np.exp(-since / rng.uniform(0.2, 0.35)), 0.0).sum(axis=1)
    burst /= max(float(burst.max()), 1e-6)
    far = rng.uniform(0.35, 1.3) * (0.7 if direction in ("left", "right") else 1.0)
    speed = far * count / max(float(burst.sum()) / FPS, 0.1) * burst
    angle = TURN[direction] + rng.normal(0.0, 0.15)
    way = np.cumsum(speed) / FPS
    root = (way - way[PAD])[:, None] * np.array([np.sin(angle), np.cos(angle)])
    going = np.minimum(burst * 1.5, 1.0)
    phase = gait_phase(rng.uniform(2.4, 3.4) * np.sqrt(going), rng.choice([0.3, 0.8]), manner)
    gait = Gait(speed=1.0, cadence=2.6, lift=rng.uniform(0.06, 0.14), push=0.3, arms=0.15, width=0.11, duty=0.58)
    facing = rng.normal(0.0, 0.2) * np.cumsum(burst) / max(float(burst.sum()), 1e-6)
    curves = step_along(Trajectory(root, facing - facing[PAD], going, phase), gait, manner)
    jolt = burst[PAD:-PAD]
    recoil = np.concatenate([np.zeros(7), jolt[:-7]])
    pitch, roll = (rng.uniform(0.5, 1.2) * angle for angle in _THROWN[direction])
    ahead, aside = jolt - rng.uniform(0.2, 0.6) * recoil, jolt - rng.uniform(0.0, 0.4) * recoil
    curves.pelvis[:, 0] += 0.35 * pitch * ahead
    curves.spine[:, 0] += 0.65 * pitch * ahead
    curves.head[:, 0] -= rng.uniform(0.3, 0.9) * pitch * jolt  # the head lags behind
    curves.pelvis[:, 1] += 0.4 * roll * aside
    curves.spine[:, 1] += 0.6 * roll * aside
    curves.root[:, 1] -= rng.uniform(0.03, 0.12) * recoil
    flung = recoil[:, None] * rng.uniform(0.3, 1.0, 2)
    curves.hands[..., 0] += 0.45 * flung
    curves.hands[..., 1] += 0.45 * flung
    curves.hands[..., 2] += rng.uniform(0.1, 0.5) * flung
    curves.parts = BODY
    return curves


@program(
    "balance beam",
    group="locomotion",
    parts={"legs", "left_arm", "right_arm"},
    directions=("forward", "backward"),
    weight=1.5,
)
def balance_beam(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk one foot before the other as on a narrow beam, arms out."""
    gait = Gait(speed=rng.uniform(0.3, 0.7), cadence=rng.uniform(1.0, 1.5), duty=0.68, width=0.01, bob=0.01, push=0.4)
    curves = perform_gait(step, gait, replace(manner, width=0.0), rng, frames)
    frames = len(curves)
    now = np.arange(frames) / FPS
    wobble = 0.09 * np.sin(2 * np.pi * (0.5 * now + rng.random())) + 0.05 * np.sin(
        2 * np.pi * (1.1 * now + rng.random())
    )
    curves.spine[:, 1] += wobble
    curves.hands[:] = (0.93, rng.uniform(-0.3, 0.1), 0.1)
    curves.hands[..., 1] += np.array([-1.5, 1.5]) * wobble[:, None]
    curves.head[:, 0] += 0.25
    curves.parts = frozenset({"legs", "left_arm", "right_arm"})
    return curves


@program("moonwalk", group="locomotion", parts=LEGS, directions=("backward",), weight=0.5)
def moonwalk(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Glide backward: one foot slides flat while the other stands on its toes."""
    frames = frames or int(rng.uniform(2.5, 5.0) * FPS)
    trajectory, gait = plan_gait(
        replace(step, direction="backward"),
        Gait(speed=rng.uniform(0.6, 0.9), cadence=2.0, bob=0.0, push=0.0, arms=0.2),
        manner,
        rng,
        frames,
    )
    curves = step_along(trajectory, gait, manner)
    cycle = 2 * np.pi * trajectory.phase[PAD:-PAD]
    heel = 0.7 * np.clip(np.stack([np.cos(cycle), -np.cos(cycle)], axis=1) * 2 + 0.3, 0.0, 1.0)
    curves.foot_pitch[:] = -heel
    curves.feet[..., 1] = np.minimum(curves.feet[..., 1], 0.1) + 0.13 * np.sin(heel)
    curves.knee[:] *= 0.0
    return curves


@program("ice skate", group="locomotion", parts=LEGS, directions=("forward", "left", "right", "around"), weight=0.7)
def ice_skate(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Glide on one foot and push outward with the other, arms swinging sideways."""
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    trajectory, gait = plan_gait(
        step,
        Gait(speed=rng.uniform(1.8, 3.0), cadence=rng.uniform(1.0, 1.5), crouch=0.14, lean=0.5),
        manner,
        rng,
        frames,
    )
    curves = step_along(trajectory, gait, manner)
    cycle, going = 2 * np.pi * trajectory.phase[PAD:-PAD], trajectory.effort[PAD:-PAD]
    facing = curves.heading
    for side, sign in ((LEFT, 1.0), (RIGHT, -1.0)):
        push = np.clip(sign * np.cos(cycle), 0.0, 1.0) ** 1.5 * going
        aside, ahead = sign * (0.09 + 0.32 * push), -0.4 * push + 0.08
        curves.feet[:, side, 0] = curves.root[:, 0] + aside * np.cos(facing) + ahead * np.sin(facing)
        curves.feet[:, side, 2] = curves.root[:, 2] - aside * np.sin(facing) + ahead * np.cos(facing)
        curves.feet[:, side, 1] = 0.085 + 0.14 * push**2
        curves.foot_pitch[:, side] = -0.5 * push
        curves.foot_yaw[:, side] = facing + sign * 0.5 * push
        curves.hands[:, side, 0] = 0.35 - 0.5 * sign * np.cos(cycle) * going
        curves.hands[:, side, 1] = -0.72
        curves.hands[:, side, 2] = 0.25
    curves.spine[:, 2] += 0.25 * np.cos(cycle) * going
    return curves
