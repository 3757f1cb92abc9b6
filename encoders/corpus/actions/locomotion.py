"""Locomotion: walking, running and the other named gaits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import LEFT, LEGS, RIGHT, SIDE_INDEX, Curves, ease
from encoders.corpus.engine.gait import PAD, Gait, step_along
from encoders.corpus.engine.program import AMPLITUDES, ActionFunction, program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.trajectories import AHEAD, CURVED, STRAIGHT, perform_gait, plan_gait, seconds
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

Range = tuple[float, float]


def _plain(gait: Gait, speed: Range, cadence: Range) -> ActionFunction:
    """Register a program of one gait, with speed and cadence sampled from these ranges.

    In whatever manner, who runs is no slower than who walks, and who sprints goes as fast as can be.
    """

    def make(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
        own = _slowed(_own(gait, speed, cadence, rng), rng)
        if own.duty < 0.5:
            least = -0.15 if own.gains else -0.35
            manner = replace(manner, pace=max(manner.pace, least), stride=max(manner.stride, least))
        return perform_gait(step, own, manner, rng, frames)

    return make


def _own(gait: Gait, speed: Range, cadence: Range, rng: Generator) -> Gait:
    """A performer's variant of a gait: cadence correlates with speed, and every parameter varies.

    Few are athletes: many let their arms hang, hold them off the body, set their feet wide or bounce.
    """
    share = rng.random()
    feet = float(np.clip(share + rng.normal(0.0, 0.3), 0.0, 1.0))
    runs = gait.duty < 0.5
    loose = 0.35 if runs else 0.15
    return replace(
        gait,
        speed=speed[0] + share * (speed[1] - speed[0]),
        cadence=cadence[0] + feet * (cadence[1] - cadence[0]),
        duty=gait.duty * rng.uniform(0.91, 1.05),
        lift=gait.lift * (float(np.exp(rng.normal(-0.05, 0.35))) if runs else rng.uniform(0.7, 1.35)),
        bob=gait.bob * float(np.exp(rng.normal(0.05, 0.45))) * (rng.uniform(1.5, 3.0) if rng.random() < 0.1 else 1.0),
        push=gait.push * rng.uniform(0.8, 1.15),
        lean=gait.lean * rng.uniform(0.3, 1.7) + rng.normal(0.0, 0.03),
        nod=gait.nod * rng.uniform(0.4, 2.0),
        arms=gait.arms * float(np.exp(rng.normal(-0.05, 0.45))),
        elbow=rng.uniform(0.25, 1.5) if rng.random() < loose else gait.elbow * rng.uniform(0.7, 1.25),
        drawn=gait.drawn + rng.normal(0.0, 0.12 if runs else 0.06),
        knees=rng.normal(0.0, 0.25 if runs else 0.08),
        kick=gait.kick * rng.uniform(0.4, 1.6),
        around=gait.around * rng.uniform(0.2, 2.0),
        behind=gait.behind + rng.normal(0.0, 0.03 if runs else 0.012),
        out=rng.uniform(0.0, 0.25) if rng.random() < loose else rng.normal(0.0, 0.03),
        width=gait.width * float(np.exp(rng.normal(0.0, 0.4))) + rng.uniform(-0.03, 0.09) * (rng.random() < 0.25),
        tip=gait.tip * float(np.exp(rng.normal(0.0, 0.4))),
    )


def _slowed(own: Gait, rng: Generator) -> Gait:
    """A slow variant of a run, bouncing nearly on the spot or heavy; never of a sprint."""
    if own.duty > 0.5 or own.gains or rng.random() > 0.15:
        return own
    return replace(own, speed=own.speed * rng.uniform(0.45, 0.8), bob=own.bob * rng.uniform(1.2, 1.8))


EVERYWHERE = (*STRAIGHT, *CURVED, "in place")
RUNNING = (*AHEAD, *CURVED, "in place", "backward")

_JOG = Gait(
    duty=0.34, lift=0.27, bob=0.04, push=0.9, lean=0.25, arms=0.45, elbow=1.85, twist=0.2, yaw=-0.2, behind=0.06,
    width=0.022, around=0.05, nod=0.04, tip=0.11, kick=0.09, drawn=0.42, crouch=0.01,
)  # fmt: skip
_RUN = replace(_JOG, duty=0.32, lift=0.29, bob=0.045, push=1.0, lean=0.29, arms=0.5, twist=0.24, kick=0.1)
_SPRINT = replace(
    _RUN, duty=0.28, lift=0.33, bob=0.035, push=1.1, lean=0.34, arms=0.75, elbow=1.65, drawn=0.3, twist=0.28, nod=0.05,
    crouch=0.03, gains=True,
)  # fmt: skip
_TIPTOE = Gait(duty=0.62, lift=0.06, bob=0.01, push=0.6, tiptoe=0.6, arms=0.15, elbow=0.5)
_MARCH = Gait(duty=0.58, lift=0.32, push=0.4, lean=-0.05, arms=0.75, elbow=0.15, width=0.08)
_STOMP = Gait(duty=0.6, lift=0.26, bob=0.04, push=0.2, lean=0.1, arms=0.35, elbow=0.7, width=0.12, crouch=0.04)
_SHUFFLE = Gait(duty=0.72, lift=0.025, bob=0.006, push=0.15, lean=0.1, arms=0.12, elbow=0.4, crouch=0.03)
_SNEAK = Gait(duty=0.68, lift=0.16, bob=0.015, push=0.7, lean=0.5, arms=0.2, elbow=1.4, width=0.09, crouch=0.17)
_SIDESTEP = Gait(
    duty=0.6, lift=0.08, push=0.2, lean=0.05, arms=0.08, elbow=0.4, width=0.15, crouch=0.03, faces=True,
)  # fmt: skip
_CROUCH = Gait(duty=0.66, lift=0.08, bob=0.015, push=0.6, lean=0.6, arms=0.2, elbow=0.8, width=0.11, crouch=0.32)
_HIGH_KNEES = Gait(duty=0.45, lift=0.42, bob=0.03, push=0.6, lean=0.0, arms=0.6, elbow=1.5, width=0.09)

#: Name, gait, metres per second, steps per second, directions, sampling weight.
_GAITS: tuple[tuple[str, Gait, Range, Range, tuple[str, ...], float], ...] = (
    ("walk", Gait(), (1.0, 1.5), (1.7, 2.1), EVERYWHERE, 5.0),
    ("jog", _JOG, (1.6, 3.5), (2.4, 3.1), RUNNING, 3.0),
    ("run", _RUN, (1.9, 4.6), (2.4, 3.2), RUNNING, 5.0),
    ("sprint", _SPRINT, (3.5, 7.0), (3.0, 4.3), ("forward", "left", "right", "back and forth"), 6.0),
    ("tiptoe", _TIPTOE, (0.4, 0.8), (1.5, 2.0), (*AHEAD, "backward", "around"), 1.0),
    ("march", _MARCH, (0.7, 1.2), (1.6, 2.0), (*AHEAD, "in place", "around", "backward"), 1.0),
    ("stomp", _STOMP, (0.5, 1.0), (1.4, 1.8), ("forward", "in place", "around"), 1.0),
    ("shuffle", _SHUFFLE, (0.3, 0.65), (1.5, 2.1), (*STRAIGHT, *CURVED), 1.0),
    ("sneak", _SNEAK, (0.4, 0.8), (1.0, 1.4), (*AHEAD, "around", "zigzag"), 1.5),
    ("sidestep", _SIDESTEP, (0.4, 0.9), (1.6, 2.2), ("left", "right"), 1.5),
    ("crouch walk", _CROUCH, (0.4, 0.8), (1.4, 1.9), (*AHEAD, "backward"), 1.0),
    ("high knees", _HIGH_KNEES, (0.5, 1.5), (2.6, 3.4), ("in place", "forward"), 1.0),
)
for _name, _gait, _speed, _cadence, _directions, _weight in _GAITS:
    program(_name, group="locomotion", parts=LEGS, directions=_directions, amplitudes=AMPLITUDES, weight=_weight)(
        _plain(_gait, _speed, _cadence)
    )


@program("limp", group="locomotion", parts=LEGS, sides=("left", "right"), directions=AHEAD, weight=1.5)
def limp(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk sparing one leg: short stance on it, the body sinks and leans over it."""
    spared = (1 if step.side == "left" else -1) if step.side else rng.choice([-1, 1])
    manner = replace(manner, limp=spared * rng.uniform(0.8, 1.6), pace=manner.pace - 0.15)
    gait = Gait(speed=rng.uniform(0.5, 0.9), cadence=rng.uniform(1.3, 1.7), arms=0.25, lift=0.07, lean=0.1)
    curves = perform_gait(step, gait, manner, rng, frames)
    if rng.random() < 0.3:  # a hand on the sore leg
        curves.hands[:, LEFT if spared > 0 else RIGHT] = (0.02, -0.72, 0.3)
    return curves


@program("drag leg", group="locomotion", parts=LEGS, sides=("left", "right"), directions=("forward",), weight=0.7)
def drag_leg(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk with one leg stiff, its foot dragged over the ground."""
    curves = limp(step, replace(manner, stride=manner.stride - 0.15), rng, frames)
    lame = SIDE_INDEX[step.side] if step.side else int(rng.integers(2))
    low = curves.feet[:, lame, 1]
    curves.feet[:, lame, 1] = np.minimum(low, low.min() + 0.03 + 0.25 * (low - low.min()))
    curves.foot_yaw[:, lame] += (0.4, -0.4)[lame]
    curves.foot_pitch[:, lame] *= 0.4
    return curves


@program("skip", group="locomotion", parts=LEGS, directions=("forward", "around", "left", "right"), weight=1.0)
def skip(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Step and hop on each foot in turn, knees high, arms swinging."""
    gait = Gait(speed=rng.uniform(1.5, 2.4), cadence=rng.uniform(1.7, 2.1), duty=0.56, lift=0.3, bob=0.0, arms=0.8)
    trajectory, gait = plan_gait(step, gait, manner, rng, frames or int(rng.uniform(2.0, 5.0) * FPS))
    curves = step_along(trajectory, gait, manner)
    beat = (2 * trajectory.phase[PAD:-PAD] - 0.3) % 1.0
    rise = rng.uniform(0.1, 0.2) * trajectory.effort[PAD:-PAD] * np.clip(np.sin(2 * np.pi * beat), 0.0, None)
    curves.root[:, 1] += rise - 0.03
    curves.feet[..., 1] += rise[:, None]
    return curves


@program(
    "gallop", group="locomotion", parts=LEGS, sides=("left", "right"), directions=("forward", "left", "right", "around")
)
def gallop(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """One foot leads, the other closes behind it, with a flight in between."""
    offset = {"left": 0.3, "right": 0.7}.get(step.side, float(rng.choice([0.3, 0.7])))
    gait = Gait(
        speed=rng.uniform(1.6, 2.4), cadence=rng.uniform(3.2, 3.8), duty=0.42, lift=0.16, bob=0.0, arms=0.15, elbow=0.9,
        crouch=0.05, offset=offset,
    )  # fmt: skip
    trajectory, gait = plan_gait(step, gait, manner, rng, frames or int(rng.uniform(2.0, 5.0) * FPS))
    curves = step_along(trajectory, gait, manner)
    flight = 0.09 * np.cos(2 * np.pi * (trajectory.phase[PAD:-PAD] - (0.86 if offset < 0.5 else 0.56)))
    curves.root[:, 1] += trajectory.effort[PAD:-PAD] * flight
    curves.feet[..., 1] += (trajectory.effort[PAD:-PAD] * np.maximum(flight, 0.0))[:, None]
    return curves


@program("stop suddenly", group="locomotion", parts=LEGS, directions=("forward",), weight=0.7)
def stop_suddenly(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Run or walk and stop from one step to the next, the body thrown back, then forward."""
    frames = frames or int(rng.uniform(2.5, 4.5) * FPS)
    now, when = seconds(frames), frames / FPS * rng.uniform(0.5, 0.75)
    runs = rng.random() < 0.6
    gait = (
        Gait(
            speed=rng.uniform(2.4, 3.5), cadence=2.7, duty=0.38, lift=0.26, lean=0.15, arms=0.6, elbow=1.4, crouch=0.05
        )
        if runs
        else Gait(speed=rng.uniform(1.1, 1.5), cadence=1.9)
    )
    trajectory, gait = plan_gait(step, gait, manner, rng, frames, 1 - ease((now - when) / 0.35))
    curves = step_along(trajectory, gait, manner)
    jolt = np.exp(-np.square((now[PAD:-PAD] - when - 0.3) / 0.18))
    curves.pelvis[:, 0] -= (0.25 if runs else 0.12) * jolt
    curves.root[:, 1] -= (0.1 if runs else 0.04) * jolt
    curves.hands[..., 2] += 0.2 * jolt[:, None]
    return curves
