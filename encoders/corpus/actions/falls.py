"""Falls with a cause: trip, slip, knees that give way, a deadly hit."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.actions.floor import WAYS, falling_row, lying_row
from encoders.corpus.engine.curves import ANKLE, HIP, Array, Curves, ease, frames_of
from encoders.corpus.engine.gait import Gait, step_along
from encoders.corpus.engine.joining import place
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.engine.trajectories import plan_gait, seconds
from encoders.corpus.engine.whole_body_poses import STANDING, perform, pose
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

_BLEND = 0.3  #: seconds in which a gait gives way to the fall


def _moved(row: Array, ahead: float) -> Array:
    """A row with hips, feet and the places of the hands further ahead, metres."""
    curves = Curves(row[None].copy(), [])
    for places in (curves.root[:, None], curves.feet, curves.reach):
        places[..., 2] += ahead
    return np.asarray(curves.data[0])


def _out_of_a_gait(step: ActionStep, manner: Manner, rng: Generator, falling: Curves) -> Curves:
    """Some steps of walking or running, at which end the fall takes over from the moving body."""
    runs = rng.random() < 0.35
    gait = Gait(speed=2.6, cadence=2.6, duty=0.4) if runs else Gait(speed=rng.uniform(1.0, 1.5), cadence=1.9)
    at = frames_of(rng.uniform(0.7, 2.5))
    frames, now = at + len(falling), seconds(at + len(falling))
    rise = 1.0 if rng.random() < 0.5 else ease(now / 0.6)
    going = rise * (1.0 - ease((now - at / FPS) / 0.7))
    trajectory, gait = plan_gait(step, gait, manner, rng, frames, going)
    curves = step_along(trajectory, gait, manner)
    ground = curves.root[at] * [1.0, 0.0, 1.0]
    fallen = place(falling, ground, float(curves.heading[at]))
    share = ease(np.arange(len(falling)) / (_BLEND * FPS))[:, None]
    curves.data[at:] += (fallen.data - curves.data[at:]) * share
    curves.spans = [(0, len(curves))]
    return curves


@program("trip and fall", group="posture", directions=("forward",), ends="floor", weight=1.5)
def trip_and_fall(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk or run, catch a foot on something, pitch forward onto the hands and lie."""
    caught, other = ("left", "right") if rng.random() < 0.5 else ("right", "left")
    sign = 1.0 if caught == "left" else -1.0
    far = rng.uniform(0.35, 0.75)
    tripping: dict[str, ArrayLike] = {
        "root": (0, 0.8, far * 0.6), "pelvis": (0.4, 0, 0), "spine": (0.35, 0, 0), "hands": (0.3, -0.1, 0.6),
        f"{caught}_feet": (sign * HIP, ANKLE + 0.12, 0.05), f"{caught}_foot_pitch": -0.9,
        f"{other}_feet": (-sign * HIP, ANKLE, far * 0.9),
    }  # fmt: skip
    lying = _moved(lying_row("forward", rng), far + 0.3)
    lasts = rng.uniform(2.0, 3.2)
    drop = rng.uniform(0.35, 0.5) / lasts
    keys = [(0.0, STANDING), (drop, pose(**tripping)), (2.0 * drop, _moved(falling_row("forward"), far + 0.1))]
    return _out_of_a_gait(step, manner, rng, perform(frames_of(lasts), [*keys, (3.0 * drop, lying), (1.0, lying)]))


@program("slip and fall", group="posture", directions=("backward",), ends="floor", weight=1.2)
def slip_and_fall(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk or run, the feet shoot away ahead, and the body drops onto seat and back."""
    first, second = ("left", "right") if rng.random() < 0.5 else ("right", "left")
    sign = 1.0 if first == "left" else -1.0
    slipping: dict[str, ArrayLike] = {
        "root": (0, 0.72, 0.05), "pelvis": (-0.5, 0, 0), "spine": (0.3, 0, 0), "hands": (0.6, 0.3, 0.3),
        f"{first}_feet": (sign * HIP, 0.25, 0.62), f"{first}_foot_pitch": 0.6,
        f"{second}_feet": (-sign * HIP, ANKLE, 0.3), f"{second}_foot_pitch": 0.2,
    }  # fmt: skip
    seated: dict[str, ArrayLike] = {
        "root": (0, 0.16, 0.1), "pelvis": (-0.7, 0, 0), "spine": (0.5, 0, 0), "head": (0.3, 0, 0),
        "feet": (0.14, 0.25, 0.75), "foot_pitch": 0.7, "reach": (0.35, 0.06, -0.3),
    }  # fmt: skip
    lying = _moved(lying_row("backward", rng), 0.6)
    stays_seated = rng.random() < 0.3
    last = pose(**{**seated, "feet": (0.14, 0.09, 0.8), "pelvis": (-0.35, 0, 0)}) if stays_seated else lying
    lasts = rng.uniform(2.0, 3.2)
    drop = rng.uniform(0.3, 0.42) / lasts
    keys = [(0.0, STANDING), (drop, pose(**slipping)), (2.0 * drop, pose(**seated)), (3.2 * drop, last), (1.0, last)]
    go_forward = ActionStep("walk", speed=step.speed)
    return _out_of_a_gait(go_forward, manner, rng, perform(frames_of(lasts), keys))


def _kneeling(**channels: ArrayLike) -> Array:
    """Dropped to both knees, the trunk upright but limp."""
    row: dict[str, ArrayLike] = {
        "root": (0, 0.47, 0.1), "spine": (0.35, 0, 0), "head": (0.45, 0, 0), "feet": (HIP + 0.03, 0.08, -0.3),
        "foot_pitch": -1.4, "hands": (0.12, -0.93, 0.12),
    }  # fmt: skip
    return pose(**{**row, **channels})


def _topple(way: str, rng: Generator) -> tuple[Array, Array]:
    """From the knees to the ground: the tipping row, and the lying one."""
    if way == "backward":
        tipping = _kneeling(root=(0, 0.26, -0.25), pelvis=(-0.5, 0, 0), feet=(HIP + 0.08, 0.08, 0.05), foot_pitch=-0.8)
    elif way == "forward":
        tipping = _kneeling(root=(0, 0.38, 0.3), pelvis=(0.85, 0, 0), hands=(0.2, -0.75, 0.4), head=(0.1, 0, 0))
    else:
        sign = 1.0 if way == "left" else -1.0
        tipping = _kneeling(root=(sign * 0.2, 0.3, 0), pelvis=(0.1, sign * 0.75, 0), hands=(0.25, -0.8, 0.2))
    return tipping, lying_row(way, rng)


@program("collapse", group="posture", directions=WAYS, ends="floor", weight=1.5)
def collapse(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """The knees give way, the body drops to them and topples over."""
    way = step.direction or str(rng.choice(WAYS, p=[0.2, 0.4, 0.2, 0.2]))
    sagging = pose(root=(0, 0.82, -0.02), spine=(0.35, 0, 0), head=(0.5, 0, 0), hands=(0.1, -0.95, 0.1))
    tipping, lying = _topple(way, rng)
    total = duration(rng.uniform(2.2, 3.6), step, manner, rng, frames)
    drop, begin, rest = rng.uniform(0.4, 0.65) * FPS / total, rng.uniform(0.05, 0.25), rng.uniform(0.0, 0.12)
    knees = begin + 1.1 * drop
    keys = [(0.0, STANDING), (begin, sagging), (knees, _kneeling()), (knees + rest, _kneeling(head=(0.55, 0, 0)))]
    down = min(knees + rest + 1.5 * drop, 0.97)
    return perform(total, [*keys, ((knees + rest + down) / 2, tipping), (down, lying), (1.0, lying)])


@program("die", group="posture", directions=WAYS, ends="floor", styled=False, weight=1.5)
def die(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Jerk as if shot or struck, mostly clutch the wound and reel a step, then drop and lie still."""
    way = step.direction or str(rng.choice(WAYS, p=[0.45, 0.3, 0.125, 0.125]))
    along, aside = {"forward": (1, 0), "backward": (-1, 0), "left": (0, 1), "right": (0, -1)}[way]
    wound = [(-0.45, -0.25, 0.35), (-0.4, -0.5, 0.35), (0.55, -0.1, 0.3)][int(rng.integers(3))]
    step_to = rng.uniform(0.1, 0.3)
    struck = pose(
        root=(0.05 * aside, 0.85, 0.05 * along), pelvis=(0.15 * along, 0.12 * aside, 0), hands=(0.45, -0.4, 0.25),
        spine=(0.35 * along, 0.3 * aside, rng.normal(0, 0.3)), head=(-0.4 * along, -0.3 * aside, 0),
    )  # fmt: skip
    foot = "right" if aside < 0 else "left"
    reeling: dict[str, ArrayLike] = {
        "root": (0.7 * step_to * aside, 0.8, 0.7 * step_to * along), "hands": wound, "head": (0.4, 0, 0),
        "pelvis": (0.1 * along, 0.15 * aside, 0), "spine": (0.45, 0.1 * aside, 0),
        f"{foot}_feet": (HIP * (1 if foot == "left" else -1) + step_to * aside, ANKLE, step_to * along),
    }  # fmt: skip
    on_knees = rng.random() < 0.3
    middle, lying = _topple(way, rng) if on_knees else (falling_row(way), lying_row(way, rng))
    total = duration(rng.uniform(2.5, 4.2), step, manner, rng, frames)
    begin, jerk, drop = rng.uniform(0.03, 0.2), 0.14 * FPS / total, rng.uniform(0.35, 0.5) * FPS / total
    keys = [(0.0, STANDING), (begin, STANDING), (begin + jerk, struck)]
    now = begin + jerk
    if rng.random() < 0.7:
        now += rng.uniform(0.35, 0.9) * FPS / total
        keys += [(now, pose(**reeling))]
    if on_knees:
        now += drop
        keys += [(now, _kneeling(hands=wound))]
    end = min(now + 2 * drop, 0.97)
    return perform(total, [*keys, ((now + end) / 2, middle), (end, lying), (1.0, lying)])
