"""Stances: how performers stand while their arms move, with feet apart, soft knees, and shifting hips and trunk.

Nor do they stay where they are: they step about, turn and sway. The amounts were fitted to the CMU takes of the
training split.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, Array, Curves, ease
from encoders.corpus.engine.joining import smooth_noise
from encoders.motion import FPS

#: Standing: hips at least this high, feet that move less than this (metres).
_HIPS, _STAYS = 0.78, 0.02


@dataclass(frozen=True)
class Stance:
    """The stance of one performer.

    Attributes
    ----------
    apart, ahead : additional distance of each foot outward, and of the left ahead of the right; metres
    toes : additional outward turn of the toes, radians
    soft : lowering of the hips, metres
    lean, aside : lean of the trunk forward and to the left, radians
    onto : shift of the hips towards the left foot, metres
    restless : amount of movement of hips and trunk, 1 is typical
    """

    apart: float = 0.0
    ahead: float = 0.0
    toes: float = 0.0
    soft: float = 0.0
    lean: float = 0.0
    aside: float = 0.0
    onto: float = 0.0
    restless: float = 0.0


def sample_stance(rng: Generator, variation: float = 1.0) -> Stance:
    """A random stance: mostly nearly even; some wide, some with a foot well ahead or the weight on one leg."""
    wide = rng.uniform(0.0, 0.14) if rng.random() < 0.2 else 0.0
    return Stance(
        apart=variation * (wide + float(rng.normal(-0.01, 0.032))),
        ahead=variation * float(rng.normal(0.0, 0.05)) * float(rng.random() < 0.6),
        toes=variation * float(rng.normal(0.05, 0.1)),
        soft=variation * float(rng.gamma(0.8, 0.012)),
        lean=variation * float(rng.normal(0.06, 0.06)),
        aside=variation * float(rng.normal(0.0, 0.08 if rng.random() < 0.25 else 0.02)),
        onto=variation * float(rng.uniform(-0.1, 0.1)) * float(rng.random() < 0.35),
        restless=variation * float(np.exp(rng.normal(-0.2, 0.7))),
    )


def stand(curves: Curves, stance: Stance, rng: Generator) -> Curves:
    """Apply a stance to a movement, in place; unchanged if a foot moves or the body does not stand."""
    feet = curves.feet
    stays = np.ptp(feet, axis=0).max() < _STAYS and np.ptp(curves.heading) < 0.2
    if not stays or curves.root[:, 1].min() < _HIPS or abs(feet[0, 0, 1] - ANKLE) > 0.05:
        return curves
    sin, cos = np.sin(curves.heading[0]), np.cos(curves.heading[0])
    aside, along = np.array([cos, 0.0, -sin]), np.array([sin, 0.0, cos])
    shift = stance.apart * aside + 0.5 * stance.ahead * along
    feet[:, 0] += shift
    feet[:, 1] -= shift
    curves.foot_yaw[:] += np.array([stance.toes, -stance.toes])
    # A wider stance lowers the hips, because leg lengths are fixed.
    curves.root[:, 1] -= stance.soft + 0.5 * (max(stance.apart, 0.0) ** 2 + stance.ahead**2)
    curves.pelvis[:, 0] += 0.5 * stance.lean
    curves.spine[:, 0] += 0.5 * stance.lean
    # The hip over the loaded foot is higher; the trunk stays upright.
    curves.root[:] += stance.onto * aside
    curves.pelvis[:, 1] -= 1.1 * stance.onto
    curves.spine[:, 1] += 1.1 * stance.onto + stance.aside
    _sway(curves, stance.restless, aside, along, rng)
    return curves


def _sway(curves: Curves, restless: float, aside: Array, along: Array, rng: Generator) -> None:
    """Shift the weight between feet and between heel and toe; turn and lean the trunk with moving arms."""
    drift = restless * smooth_noise(len(curves), 6, rng, 1.0)
    curves.root[:] += 0.014 * drift[:, :1] * aside + 0.02 * drift[:, 1:2] * along
    curves.root[:, 1] -= 0.006 * np.abs(drift[:, 2])
    curves.pelvis[:, 0] += 0.02 * drift[:, 3]
    curves.spine[:, 0] += 0.02 * drift[:, 3]
    curves.spine[:, 2] += 0.03 * drift[:, 4]
    curves.pelvis[:, 2] += 0.02 * drift[:, 5]
    left, right = curves.hands[:, 0], curves.hands[:, 1]
    follow = min(restless, 1.5) * 0.1
    curves.spine[:, 2] += follow * np.clip(right[:, 2] - left[:, 2], -1.0, 1.0)
    curves.spine[:, 1] += 0.6 * follow * np.clip(right[:, 1] - left[:, 1], -1.0, 1.0)
    curves.spine[:, 0] += 0.5 * follow * np.clip((left[:, 2] + right[:, 2]) / 2, -0.5, 1.0)


#: A foot that is raised by more than this carries nobody's step, and below this hip height nobody steps; metres.
_RAISED, _LOW = 0.05, 0.6


def step_about(curves: Curves, rng: Generator, amount: float) -> None:
    """Steps in any direction, turns and swaying of the trunk under a movement that stands, in place.

    `amount` is 1 for a boxer who moves about, 0.2 for somebody restless. While a foot is raised, or the body is low,
    nobody steps.
    """
    frames = len(curves)
    stands = (curves.feet[..., 1].max(axis=1) < ANKLE + _RAISED) & (curves.root[:, 1] > _LOW)
    moves = np.zeros((3, frames, 3))  # x, z and angle of the hips, and of each foot
    place, facing, at = np.zeros(2), 0.0, int(rng.integers(0, 8))
    way, lift = rng.uniform(-np.pi, np.pi), rng.uniform(0.015, 0.06)
    rises = np.zeros((frames, 2))
    while at < frames:
        lasts = int(rng.uniform(0.28, 0.55) * FPS)
        if not stands[max(at - 1, 0) : at + lasts + 2].all():
            at += 3
            continue
        way += rng.normal(0.0, 0.8) if rng.random() < 0.6 else rng.uniform(-np.pi, np.pi)
        homeward = 0.35 * np.tanh(np.hypot(*place))
        far = min(amount * rng.uniform(0.05, 0.36), 0.5)
        step = far * np.array([np.sin(way), np.cos(way)]) - homeward * far * place
        turned = amount * rng.normal(0.0, 0.3)
        first = int(rng.integers(2))
        change = np.array([*step, turned])
        since = np.arange(frames) - at
        moves[0] += change * ease(since / lasts)[:, None]
        for foot, start in ((first, 0.0), (1 - first, 0.42)):
            share = np.clip((since / lasts - start) / 0.55, 0.0, 1.0)
            moves[1 + foot] += change * ease(share)[:, None]
            rises[:, foot] += (lift + 0.1 * far) * np.sin(np.pi * share)
        place, facing = place + step, facing + turned
        at += lasts + (0 if rng.random() < min(0.75 * amount, 0.92) else int(rng.exponential(12 / max(amount, 0.1))))
    _displace(curves, moves, rises)
    _reel(curves, moves[0], amount, rng)


def _displace(curves: Curves, moves: Array, rises: Array) -> None:
    """Turn hips and feet about the origin and move them, by (3, F, 3) of x, z and angle, in place."""
    for points, (x, z, angle) in (
        (curves.root, moves[0].T), (curves.feet[:, 0], moves[1].T), (curves.feet[:, 1], moves[2].T),
        (curves.reach[:, 0], moves[0].T), (curves.reach[:, 1], moves[0].T),
    ):  # fmt: skip
        cos, sin = np.cos(angle), np.sin(angle)
        points[:, 0], points[:, 2] = (
            points[:, 0] * cos + points[:, 2] * sin + x,
            points[:, 2] * cos - points[:, 0] * sin + z,
        )
    curves.feet[..., 1] += rises
    curves.heading[:] += moves[0, :, 2]
    curves.foot_yaw[:] += moves[1:, :, 2].T


def _reel(curves: Curves, moves: Array, amount: float, rng: Generator) -> None:
    """The trunk leans into and against steps, twists and sways, in place."""
    sway = amount * smooth_noise(len(curves), 4, rng, rng.uniform(0.8, 2.0))
    velocity = np.gradient(moves[:, :2], axis=0) * FPS
    sin, cos = np.sin(curves.heading), np.cos(curves.heading)
    ahead = velocity[:, 0] * sin + velocity[:, 1] * cos
    aside = velocity[:, 0] * cos - velocity[:, 1] * sin
    share = rng.normal(0.0, 0.12)
    curves.pelvis[:, 0] += 0.5 * share * ahead + 0.05 * sway[:, 0]
    curves.spine[:, 0] += 0.5 * share * ahead + 0.09 * sway[:, 0]
    curves.spine[:, 1] += share * aside + 0.15 * sway[:, 1]
    curves.spine[:, 2] += 0.14 * sway[:, 2]
    curves.pelvis[:, 2] += 0.14 * sway[:, 3]
    curves.root[:, 1] -= 0.012 * amount * np.abs(sway[:, 0])
