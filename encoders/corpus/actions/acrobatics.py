"""Acrobatics: somersault, cartwheel, handstand, backflip."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, HIP, Array, Curves, ease
from encoders.corpus.engine.joining import place
from encoders.corpus.engine.posing import OFFSETS, rotation, turn
from encoders.corpus.engine.posing import pose as pose_body
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.engine.whole_body_poses import STANDING, perform, pose
from encoders.corpus.scene import ActionStep
from encoders.skeleton import INDEX

_TRUNK = [INDEX[name] for name in ("pelvis", "spine3", "neck", "head", "left_foot", "right_foot")]


def _carry_feet(curves: Curves, weight: Array, offset: tuple[float, float, float]) -> None:
    """Attach the feet to the pelvis at `offset` (outward, up, forward of the hip centre), blended by `weight`."""
    frame = rotation(*curves.pelvis.T)
    for side, sign in ((0, 1.0), (1, -1.0)):
        follow = curves.root + turn(frame, np.array([offset]) * [sign, 1.0, 1.0])[:, 0]
        curves.feet[:, side] += (follow - curves.feet[:, side]) * weight[:, None]
        # The sole turns with the shin; beyond upright the toes point up.
        curves.foot_pitch[:, side] -= weight * curves.pelvis[:, 0]


def _keep_above_ground(curves: Curves, weight: Array) -> None:
    """Raise the body, blended by `weight`, where trunk, head or feet would penetrate the ground."""
    lowest = pose_body(curves, OFFSETS)[:, _TRUNK, 1].min(axis=1)
    deficit = np.maximum(0.05 - lowest, 0.0) * weight
    raised = np.convolve(np.pad(deficit, 2, mode="edge"), np.full(5, 0.2), mode="valid")
    curves.root[:, 1] += raised
    curves.feet[..., 1] += raised[:, None]


@program("somersault", group="sport", directions=("forward", "backward"), counts=(1, 2), weight=1)
def somersault(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Roll head over heels on the ground and stand up."""
    way = -1.0 if step.direction == "backward" else 1.0
    count = step.count or 1
    frames = duration(1.6 + 1.2 * count, step, manner, rng, frames)
    low = pose(
        root=(0, 0.38, 0.1 * way), pelvis=(0.4, 0, 0), spine=(0.8, 0, 0), head=(0.4, 0, 0), hands=(0.0, -0.2, 0.8)
    )
    length = 0.95 * count
    end = pose(
        root=(0, 0.38, length * way),
        pelvis=(0.4, 0, 0),
        spine=(0.8, 0, 0),
        head=(0.4, 0, 0),
        hands=(0.0, -0.3, 0.8),
        feet=(HIP, ANKLE, length * way),
    )
    stood = pose(root=(0, 0.9, length * way), feet=(HIP, ANKLE, length * way))
    curves = perform(frames, [(0.0, STANDING), (0.25, low), (0.75, end), (1.0, stood)])
    now = np.linspace(0, 1, frames)
    over = ease((now - 0.24) / 0.52)
    tucked = ease((now - 0.24) / 0.1) * ease((0.78 - now) / 0.1)
    curves.pelvis[:, 0] += way * 2 * np.pi * count * over
    # Upside down the body rests on its shoulders, and the hips are highest.
    curves.root[:, 1] += tucked * (0.22 * np.sin(np.pi * count * over) ** 2 - 0.1)
    curves.hands[:] += (np.array([-0.15, -0.5, 0.45]) - curves.hands) * tucked[:, None, None]
    curves.spine[:, 0] += 0.5 * tucked
    curves.head[:, 0] += 0.4 * tucked
    _carry_feet(curves, tucked, (0.1, -0.38, 0.25))
    _keep_above_ground(curves, tucked)
    curves.pelvis[over >= 1.0, 0] -= way * 2 * np.pi * count
    return curves


@program("cartwheel", group="sport", directions=("left", "right"), counts=(1, 2), weight=1)
def cartwheel(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn sideways over the hands, legs straight and apart."""
    sign = 1.0 if (step.direction or rng.choice(["left", "right"])) == "left" else -1.0
    frames = duration(2.4, step, manner, rng, frames)
    now = np.linspace(0, 1, frames)
    wide = pose(hands=(0.55, 0.8, 0.05), feet=(0.3, ANKLE, 0), root=(0, 0.84, 0))
    length = rng.uniform(1.6, 2.0)
    after = pose(
        hands=(0.55, 0.8, 0.05),
        root=(sign * length, 0.84, 0),
        left_feet=(sign * length + 0.3, ANKLE, 0),
        right_feet=(sign * length - 0.3, ANKLE, 0),
    )
    stood = pose(
        root=(sign * length, 0.9, 0),
        left_feet=(sign * length + HIP, ANKLE, 0),
        right_feet=(sign * length - HIP, ANKLE, 0),
    )
    curves = perform(frames, [(0.0, STANDING), (0.2, wide), (0.8, after), (1.0, stood)])
    over = ease((now - 0.18) / 0.64) * 0.5 + np.clip((now - 0.18) / 0.64, 0, 1) * 0.5
    swung = ease((now - 0.2) / 0.12) * ease((0.82 - now) / 0.12)
    curves.pelvis[:, 1] += sign * 2 * np.pi * over
    curves.root[:, 1] += 0.12 * np.sin(np.pi * over) ** 2
    _carry_feet(curves, swung, (0.42, -0.68, 0.0))
    curves.foot_pitch[:] = -0.5 * swung[:, None]
    down = np.clip((now - 0.3) / 0.08, 0, 1) * np.clip((0.66 - now) / 0.08, 0, 1)
    for side, out in ((0, 1.0), (1, -1.0)):
        early = out == sign
        where = sign * length * (0.36 if early else 0.6)
        curves.reach[:, side] = (where, 0.07, 0.0)
        curves.reach_weight[:, side] = np.roll(down, -1 if early else 1) ** 0.7
    curves.pelvis[over >= 1.0, 1] -= sign * 2 * np.pi
    if rng.random() < 0.7:  # starts and ends facing the direction of travel: a quarter turn in and out
        curves = place(curves, np.zeros(3), -sign * np.pi / 2)
        aside = sign * np.pi / 2 * (1 - ease(now / 0.25) * ease((1 - now) / 0.2))
        curves.heading[:] += aside
        curves.foot_yaw[:] += aside[:, None]
    curves.pelvis[:, 0] += rng.uniform(0.0, 0.4) * np.sin(np.pi * now)
    return curves


@program("handstand", group="sport", weight=0.8)
def handstand(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Kick up onto the hands, hold, come down."""
    frames = duration(3.6, step, manner, rng, frames)
    hands = (0.2, 0.07, 0.62)
    bent = pose(root=(0, 0.72, 0.05), pelvis=(1.1, 0, 0), spine=(0.7, 0, 0), reach=hands, head=(-0.2, 0, 0))
    inverted = pose(root=(0, 1.14, 0.64), pelvis=(np.pi - 0.05, 0, 0), reach=hands, head=(-0.5, 0, 0))
    raised = pose(hands=(0.25, 0.9, 0.2))
    curves = perform(
        frames,
        [
            (0.0, STANDING),
            (0.12, raised),
            (0.28, bent),
            (0.45, inverted),
            (0.68, inverted),
            (0.84, bent),
            (1.0, STANDING),
        ],
    )
    up = ease((curves.pelvis[:, 0] - 1.1) / 1.0)
    _carry_feet(curves, up, (0.08, -0.79, 0.0))
    curves.foot_pitch[:] = -0.9 * up[:, None]
    curves.foot_yaw[:] += np.pi * (up > 0.75)[:, None]
    return curves


@program("backflip", group="sport", directions=("backward", "forward"), weight=0.5)
def backflip(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Jump and turn over in the air, backward (or forward), and land on the feet."""
    way = 1.0 if step.direction == "forward" else -1.0
    frames = duration(2.4, step, manner, rng, frames)
    now = np.linspace(0, 1, frames)
    low = pose(root=(0, 0.62, -0.1), pelvis=(0.4, 0, 0), spine=(0.4, 0, 0), hands=(0.2, -0.75, -0.5))
    far = way * rng.uniform(0.3, 0.9)
    landed = pose(
        root=(0, 0.6, far), pelvis=(0.4, 0, 0), spine=(0.4, 0, 0), hands=(0.1, -0.4, 0.7), feet=(HIP, ANKLE, far)
    )
    reach = pose(hands=(0.2, 0.93, 0.1), root=(0, 0.98, 0), feet=(HIP, ANKLE + 0.08, 0), foot_pitch=-0.7)
    stood = pose(root=(0, 0.9, far), feet=(HIP, ANKLE, far))
    curves = perform(frames, [(0.0, STANDING), (0.25, low), (0.38, reach), (0.72, landed), (1.0, stood)])
    air = np.clip((now - 0.38) / 0.32, 0.0, 1.0)
    over = ease(air)
    curves.pelvis[:, 0] += way * 2 * np.pi * over
    curves.root[:, 1] += 2.4 * air * (1 - air)
    tucked = ease(air / 0.25) * ease((1 - air) / 0.2)
    _carry_feet(curves, tucked, (0.1, -0.4, 0.2))
    curves.feet[..., 1] += (2.4 * air * (1 - air) * (1 - tucked))[:, None]
    curves.pelvis[over >= 1.0, 0] -= way * 2 * np.pi
    return curves
