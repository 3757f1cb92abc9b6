"""Going from place to place on foot: the named gaits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.courses import AHEAD, CURVED, STRAIGHT, effort, go, seconds, travel
from encoders.corpus.curves import LEFT, LEGS, RIGHT, SIDES, Curves, ease, hold
from encoders.corpus.gait import PAD, Course, Gait, gait_phase, step_along
from encoders.corpus.programs import AMPLITUDES, Make, program
from encoders.corpus.scene import Step
from encoders.corpus.style import Manner
from encoders.motion import FPS

Range = tuple[float, float]


def _plain(gait: Gait, speed: Range, cadence: Range) -> Make:
    """A program that follows one gait at a speed and cadence from these ranges."""

    def make(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
        return go(step, replace(gait, speed=rng.uniform(*speed), cadence=rng.uniform(*cadence)), manner, rng, frames)

    return make


EVERYWHERE = (*STRAIGHT, *CURVED, "in place")

for _name, _gait, _speed, _cadence, _directions, _weight in (
    ("walk", Gait(), (1.0, 1.45), (1.7, 2.05), EVERYWHERE, 5.0),
    ("jog", Gait(duty=0.37, lift=0.14, bob=0.035, push=0.9, lean=0.12, arms=0.4, elbow=1.5, twist=0.17, yaw=-0.1, behind=0.06, width=0.05, crouch=0.0),
     (1.6, 2.6), (2.3, 2.8), (*AHEAD, *CURVED, "in place", "backward"), 3.0),
    ("run", Gait(duty=0.32, lift=0.2, bob=0.045, push=1.0, lean=0.18, arms=0.5, elbow=1.6, twist=0.2, yaw=-0.2, behind=0.08, width=0.05, crouch=0.01),
     (2.1, 3.7), (2.4, 3.0), (*AHEAD, *CURVED, "in place", "backward"), 4.0),
    ("sprint", Gait(duty=0.27, lift=0.32, bob=0.03, push=1.1, lean=0.3, arms=0.85, elbow=1.6, twist=0.26, yaw=-0.2, behind=0.09, width=0.04, crouch=0.03),
     (4.0, 6.5), (3.0, 3.9), ("forward", "left", "right", "back and forth"), 3.0),
    ("tiptoe", Gait(duty=0.62, lift=0.06, bob=0.01, push=0.6, tiptoe=0.6, arms=0.15, elbow=0.5, width=0.05),
     (0.4, 0.8), (1.5, 2.0), (*AHEAD, "backward", "around"), 1.0),
    ("march", Gait(duty=0.58, lift=0.32, bob=0.02, push=0.4, lean=-0.05, arms=0.75, elbow=0.15, width=0.08),
     (0.7, 1.2), (1.6, 2.0), (*AHEAD, "in place", "around", "backward"), 1.0),
    ("stomp", Gait(duty=0.6, lift=0.26, bob=0.04, push=0.2, lean=0.1, arms=0.35, elbow=0.7, width=0.12, crouch=0.04),
     (0.5, 1.0), (1.4, 1.8), ("forward", "in place", "around"), 1.0),
    ("shuffle", Gait(duty=0.72, lift=0.025, bob=0.006, push=0.15, lean=0.1, arms=0.12, elbow=0.4, crouch=0.03),
     (0.3, 0.65), (1.5, 2.1), EVERYWHERE[:-1], 1.0),
    ("sneak", Gait(duty=0.68, lift=0.16, bob=0.015, push=0.7, lean=0.5, arms=0.2, elbow=1.4, width=0.09, crouch=0.17),
     (0.4, 0.8), (1.0, 1.4), (*AHEAD, "around", "zigzag"), 1.5),
    ("sidestep", Gait(duty=0.6, lift=0.06, bob=0.02, push=0.2, lean=0.05, arms=0.08, elbow=0.4, width=0.15, crouch=0.03),
     (0.4, 0.9), (1.6, 2.2), ("left", "right"), 1.5),
    ("crouch walk", Gait(duty=0.66, lift=0.08, bob=0.015, push=0.6, lean=0.6, arms=0.2, elbow=0.8, width=0.11, crouch=0.32),
     (0.4, 0.8), (1.4, 1.9), (*AHEAD, "backward"), 1.0),
    ("high knees", Gait(duty=0.45, lift=0.42, bob=0.03, push=0.6, lean=0.0, arms=0.6, elbow=1.5, width=0.09),
     (0.5, 1.5), (2.6, 3.4), ("in place", "forward"), 1.0),
):  # fmt: skip
    program(_name, group="locomotion", parts=LEGS, directions=_directions, amplitudes=AMPLITUDES, weight=_weight)(
        _plain(_gait, _speed, _cadence)
    )


@program("limp", group="locomotion", parts=LEGS, sides=("left", "right"), directions=AHEAD, weight=1.5)
def limp(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk sparing one leg: short stance on it, the body sinks and leans over it."""
    spared = (1 if step.side == "left" else -1) if step.side else rng.choice([-1, 1])
    manner = replace(manner, limp=spared * rng.uniform(0.8, 1.6), pace=manner.pace - 0.15)
    gait = Gait(speed=rng.uniform(0.5, 0.9), cadence=rng.uniform(1.3, 1.7), arms=0.25, lift=0.07, lean=0.1)
    curves = go(step, gait, manner, rng, frames)
    if rng.random() < 0.3:  # a hand on the sore leg
        curves.hands[:, LEFT if spared > 0 else RIGHT] = (0.02, -0.72, 0.3)
    return curves


@program("drag leg", group="locomotion", parts=LEGS, sides=("left", "right"), directions=("forward",), weight=0.7)
def drag_leg(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk with one leg stiff, its foot dragged over the ground."""
    curves = limp(step, replace(manner, stride=manner.stride - 0.15), rng, frames)
    lame = SIDES[step.side] if step.side else int(rng.integers(2))
    low = curves.feet[:, lame, 1]
    curves.feet[:, lame, 1] = np.minimum(low, low.min() + 0.03 + 0.25 * (low - low.min()))
    curves.foot_yaw[:, lame] += (0.4, -0.4)[lame]
    curves.foot_pitch[:, lame] *= 0.4
    return curves


@program("skip", group="locomotion", parts=LEGS, directions=("forward", "around", "left", "right"), weight=1.0)
def skip(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Step and hop on each foot in turn, knees high, arms swinging."""
    gait = Gait(speed=rng.uniform(1.5, 2.4), cadence=rng.uniform(1.7, 2.1), duty=0.56, lift=0.3, bob=0.0, arms=0.8)
    course, gait = travel(step, gait, manner, rng, frames or int(rng.uniform(2.0, 5.0) * FPS))
    curves = step_along(course, gait, manner)
    beat = (2 * course.phase[PAD:-PAD] - 0.3) % 1.0
    rise = rng.uniform(0.1, 0.2) * course.effort[PAD:-PAD] * np.clip(np.sin(2 * np.pi * beat), 0.0, None)
    curves.root[:, 1] += rise - 0.03
    curves.feet[..., 1] += rise[:, None]
    return curves


@program(
    "gallop", group="locomotion", parts=LEGS, sides=("left", "right"), directions=("forward", "left", "right", "around")
)
def gallop(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """One foot leads, the other closes behind it, with a flight in between."""
    offset = {"left": 0.3, "right": 0.7}.get(step.side, float(rng.choice([0.3, 0.7])))
    gait = Gait(
        speed=rng.uniform(1.6, 2.4), cadence=rng.uniform(3.2, 3.8), duty=0.42, lift=0.16, bob=0.0, arms=0.15, elbow=0.9,
        crouch=0.05, offset=offset,
    )  # fmt: skip
    course, gait = travel(step, gait, manner, rng, frames or int(rng.uniform(2.0, 5.0) * FPS))
    curves = step_along(course, gait, manner)
    flight = 0.09 * np.cos(2 * np.pi * (course.phase[PAD:-PAD] - (0.86 if offset < 0.5 else 0.56)))
    curves.root[:, 1] += course.effort[PAD:-PAD] * flight
    curves.feet[..., 1] += (course.effort[PAD:-PAD] * np.maximum(flight, 0.0))[:, None]
    return curves


@program("stop suddenly", group="locomotion", parts=LEGS, directions=("forward",), weight=0.7)
def stop_suddenly(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
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
    course, gait = travel(step, gait, manner, rng, frames, 1 - ease((now - when) / 0.35))
    curves = step_along(course, gait, manner)
    jolt = np.exp(-np.square((now[PAD:-PAD] - when - 0.3) / 0.18))
    curves.pelvis[:, 0] -= (0.25 if runs else 0.12) * jolt
    curves.root[:, 1] -= (0.1 if runs else 0.04) * jolt
    curves.hands[..., 2] += 0.2 * jolt[:, None]
    return curves


@program(
    "turn",
    group="locomotion",
    parts=LEGS,
    directions=("left", "right", "around", "clockwise", "counterclockwise"),
    weight=2.5,
)
def turn(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn on the spot in small steps: a quarter to a side, half or a whole turn around."""
    side = {"left": 1, "counterclockwise": 1, "right": -1, "clockwise": -1}.get(step.direction, rng.choice([-1, 1]))
    degrees = {"left": 90, "right": 90, "around": 180}.get(step.direction, rng.choice([180, 360]))
    degrees = {"small": 0.5, "": 1.0, "large": 1.5}[step.amplitude] * degrees * rng.uniform(0.85, 1.1)
    return spin_in_place(step, manner, rng, frames, np.deg2rad(side * degrees), rng.uniform(90, 160))


def spin_in_place(
    step: Step, manner: Manner, rng: Generator, frames: int, angle: float, degrees_per_second: float
) -> Curves:
    """Turn by an angle (radians, left positive) on the spot."""
    pace = {"slow": 0.6, "": 1.0, "fast": 1.6}[step.speed] * manner.factor("pace")
    rate = np.deg2rad(degrees_per_second) * pace
    total = frames or max(int((abs(angle) / rate + 0.5) * FPS), 12)
    now = seconds(total) / (total / FPS)
    facing = angle * ease((now - 0.08) / 0.84)
    going = np.minimum(np.abs(np.gradient(facing)) * FPS / rate, 1.0)
    phase = gait_phase(np.full(len(now), rng.uniform(1.7, 2.4) * np.sqrt(pace)), rng.random(), manner)
    gait = Gait(speed=0.2, lift=0.06, bob=0.01, push=0.15, arms=0.1, width=0.09)
    curves = step_along(Course(np.zeros((len(now), 2)), facing, going, phase), gait, manner)
    ahead = np.gradient(facing)[PAD:-PAD] * FPS
    curves.head[:, 2] += 0.18 * ahead
    curves.spine[:, 2] += 0.08 * ahead
    return curves


@program("pivot", group="locomotion", parts=LEGS, sides=("left", "right"), directions=("left", "right", "around"))
def pivot(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn at once on the ball of one foot, the other foot carried around it."""
    side = {"left": 1, "right": -1}.get(step.direction, rng.choice([-1, 1]))
    angle = side * np.deg2rad(rng.uniform(150, 190) if step.direction == "around" else rng.uniform(70, 180))
    on = SIDES[step.side] if step.side else int(rng.integers(2))
    frames = frames or int(rng.uniform(0.9, 1.5) / (1.4 if step.speed == "fast" else 1.0) * FPS)
    from encoders.corpus.curves import ANKLE, HIP, standing

    curves = standing(frames, LEGS)
    when = ease((np.linspace(0, 1, frames) - 0.2) / 0.6)
    facing = angle * when
    axis = np.array([HIP if on == LEFT else -HIP, 0.0])
    sin, cos = np.sin(facing), np.cos(facing)

    def about(x: float) -> np.ndarray:
        return np.stack([axis[0] + (x - axis[0]) * cos, -(x - axis[0]) * sin], axis=1)

    curves.heading[:] = facing
    shift = 0.5 * hold(frames, 0.25, 0.25)[:, None]
    curves.root[:, [0, 2]] = about(0.0) * (1 - shift) + np.array([axis[0], 0.0]) * shift
    curves.feet[:, 1 - on][:, [0, 2]] = about(-axis[0])
    curves.feet[:, 1 - on, 1] = ANKLE + 0.08 * hold(frames, 0.35, 0.35)
    curves.feet[:, 1 - on, 0], curves.feet[:, 1 - on, 2] = about(-axis[0]).T
    curves.foot_yaw[:] += facing[:, None]
    curves.spine[:, 2] = 0.25 * np.gradient(facing) * FPS * 0.4
    return curves


@program(
    "stagger", group="locomotion", parts=LEGS, directions=("forward", "backward", "left", "right", "around"), weight=1.5
)
def stagger(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Reel along like a drunk: the course wanders, the trunk sways, steps are uneven and wide."""
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    manner = replace(manner, width=manner.width + 0.4, sway=manner.sway + 0.5, wander=max(manner.wander, 0.1))
    gait = Gait(speed=rng.uniform(0.5, 1.0), cadence=rng.uniform(1.4, 1.9), arms=0.3, push=0.4)
    course, gait = travel(step, gait, manner, rng, frames)
    now = seconds(frames)
    reel = sum(
        rng.normal(0.0, 0.12) * np.sin(2 * np.pi * (rng.uniform(0.2, 0.6) * now + rng.random())) for _ in range(3)
    )
    aside = np.stack([np.cos(course.facing), -np.sin(course.facing)], axis=1)
    root = course.root + np.asarray(reel)[:, None] * aside * 1.5
    course = replace(course, root=root - root[PAD], facing=course.facing + np.asarray(reel) - np.asarray(reel)[PAD])
    curves = step_along(course, gait, manner)
    lean = np.gradient(np.asarray(reel))[PAD:-PAD] * FPS
    curves.spine[:, 1] += 0.7 * lean
    curves.pelvis[:, 1] += 0.3 * lean
    curves.hands[..., 0] += np.array([1.0, -1.0]) * 0.4 * lean[:, None] + 0.15
    return curves


@program("stumble", group="locomotion", parts=LEGS, directions=("forward", "left", "right", "backward"), weight=1.5)
def stumble(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk, trip, catch oneself with quick steps and go on."""
    frames = frames or int(rng.uniform(2.5, 5.0) * FPS)
    now = seconds(frames)
    when = frames / FPS * rng.uniform(0.3, 0.6)
    trip = np.exp(-np.square((now - when) / rng.uniform(0.2, 0.35)))
    gait = Gait(speed=rng.uniform(0.9, 1.3), cadence=rng.uniform(1.7, 2.0))
    going = effort(frames, rng) * (1 + 0.7 * trip)
    course, gait = travel(step, gait, manner, rng, frames, going)
    phase = course.phase + 0.5 * np.cumsum(trip) / FPS
    curves = step_along(replace(course, phase=phase, effort=np.minimum(course.effort, 1.2)), gait, manner)
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


@program(
    "balance beam",
    group="locomotion",
    parts={"legs", "left_arm", "right_arm"},
    directions=("forward", "backward"),
    weight=1.5,
)
def balance_beam(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Walk one foot before the other as on a narrow beam, arms out."""
    gait = Gait(speed=rng.uniform(0.3, 0.7), cadence=rng.uniform(1.0, 1.5), duty=0.68, width=0.01, bob=0.01, push=0.4)
    curves = go(step, gait, replace(manner, width=0.0), rng, frames)
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
def moonwalk(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Glide backward: one foot slides flat while the other stands on its toes."""
    frames = frames or int(rng.uniform(2.5, 5.0) * FPS)
    course, gait = travel(
        replace(step, direction="backward"),
        Gait(speed=rng.uniform(0.6, 0.9), cadence=2.0, bob=0.0, push=0.0, arms=0.2),
        manner,
        rng,
        frames,
    )
    curves = step_along(course, gait, manner)
    cycle = 2 * np.pi * course.phase[PAD:-PAD]
    heel = 0.7 * np.clip(np.stack([np.cos(cycle), -np.cos(cycle)], axis=1) * 2 + 0.3, 0.0, 1.0)
    curves.foot_pitch[:] = -heel
    curves.feet[..., 1] = np.minimum(curves.feet[..., 1], 0.1) + 0.13 * np.sin(heel)
    curves.knee[:] *= 0.0
    return curves


@program("ice skate", group="locomotion", parts=LEGS, directions=("forward", "left", "right", "around"), weight=0.7)
def ice_skate(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Glide on one foot and push outward with the other, arms swinging sideways."""
    frames = frames or int(rng.uniform(3.0, 6.0) * FPS)
    course, gait = travel(
        step,
        Gait(speed=rng.uniform(1.8, 3.0), cadence=rng.uniform(1.0, 1.5), crouch=0.14, lean=0.5),
        manner,
        rng,
        frames,
    )
    curves = step_along(course, gait, manner)
    cycle, going = 2 * np.pi * course.phase[PAD:-PAD], course.effort[PAD:-PAD]
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
