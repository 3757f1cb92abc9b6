"""Whole-body key poses: rows of curves, and smooth movement through them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine import inbetweens
from encoders.corpus.engine.curves import ANKLE, BODY, Array, Curves, ease, standing
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

_FIELDS = ("root", "pelvis", "spine", "head")
_BOTH = {"hands": 1.0, "feet": -1.0, "reach": -1.0}


def pose(**channels: ArrayLike) -> Array:
    """One row of curves (45,): standing, except for the named channels.

    `root`, `pelvis`, `spine`, `head`, `heading` as in `Curves`. For `hands`, `feet`, `reach`, `elbow`, `knee`,
    `foot_pitch`, `foot_yaw`, `hang`, `shrug`: the left side's value, the right side mirrors it; with a "left_" or
    "right_" before the name, one side's. Naming `reach` gives it full weight.
    """
    curves = standing(1)
    for name, value in channels.items():
        side = name.partition("_")[0]
        if side in ("left", "right"):
            _set(curves, name[len(side) + 1 :], 0 if side == "left" else 1, value)
        elif name in (*_FIELDS, "heading"):
            getattr(curves, name)[:] = value
        else:
            _set(curves, name, 0, value)
            _set(curves, name, 1, _mirrored(name, value))
    return np.asarray(curves.data[0])


def _set(curves: Curves, name: str, side: int, value: ArrayLike) -> None:
    getattr(curves, name)[:, side] = value
    if name == "reach":
        curves.reach_weight[:, side] = 1.0


def _mirrored(name: str, value: ArrayLike) -> ArrayLike:
    if name in ("feet", "reach"):
        return np.asarray(value, np.float64) * [-1.0, 1.0, 1.0]
    return -np.asarray(value, np.float64) if name in ("knee", "foot_yaw") else value


def through(frames: int, poses: Sequence[tuple[float, Array]]) -> Array:
    """Interpolate key poses: (F, 45) from pairs of (share of the duration, row).

    At rest at the first, the last and at extrema of a channel; a repeated row is held.
    """
    times = np.array([time for time, _ in poses])
    rows = np.stack([row for _, row in poses])
    moving = (rows != rows[0]).any(axis=0)
    out = np.repeat(rows[:1], frames, axis=0)
    out[:, moving] = inbetweens.through(np.linspace(0.0, 1.0, frames), times, rows[:, moving])
    return out


def perform(frames: int, poses: Sequence[tuple[float, Array]], parts: frozenset[str] = BODY) -> Curves:
    """Curves through key poses; feet that move near the ground are lifted."""
    curves = Curves(through(frames, poses), [(0, frames)], parts)
    speed = np.sqrt((np.gradient(curves.feet[..., [0, 2]], axis=0) ** 2).sum(-1)) * FPS
    low = np.clip(2.0 - curves.feet[..., 1] / ANKLE, 0.0, 1.0)
    curves.feet[..., 1] += 0.07 * low * ease(speed / 0.6)
    return curves


STANDING = pose()


def irregular_wave(frames: int, rng: Generator, hertz: tuple[float, float]) -> Array:
    """A slow irregular wave (F,) of about unit amplitude."""
    time = np.arange(frames) / FPS
    waves = [np.sin(2 * np.pi * (rng.uniform(*hertz) * time + rng.random())) for _ in range(2)]
    return np.asarray(sum(waves)) / 1.4


def repeated(frames: int, count: int, rng: Generator, *, down: float = 0.35, up: float = 0.35) -> Array:
    """0 to 1 and back `count` times, (F,)."""
    local = (np.arange(frames) * count / frames) % 1.0
    return ease(local / (down * rng.uniform(0.8, 1.2))) * ease((1 - local) / (up * rng.uniform(0.8, 1.2)))


def down_and_up(
    step: ActionStep, manner: Manner, rng: Generator, frames: int, low: Array, *, seconds: float, stay: float = 0.2
) -> Curves:
    """Into a pose and out of it, `step.count` times; a single pose is sometimes kept."""
    count = step.count or 1
    frames = duration(seconds * count, step, manner, rng, frames)
    if count == 1 and rng.random() < stay:
        return perform(frames, [(0.05, STANDING), (rng.uniform(0.4, 0.7), low), (1.0, low)])
    keys = [(0.02, STANDING)]
    for i in range(count):
        half = rng.uniform(0.05, 0.3) / 2
        keys += [((i + 0.5 - half) / count, low), ((i + 0.5 + half) / count, low), ((i + 0.98) / count, STANDING)]
    return perform(frames, keys)
