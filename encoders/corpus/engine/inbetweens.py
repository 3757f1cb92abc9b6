"""In-betweens: interpolation of limbs between key poses, and accompanying movements of the body."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import LEFT, RIGHT, Array, Curves, ease

_TURN = np.pi / 3  #: rotation of a foot in one step on the spot


def through(now: Array, times: Array, values: Array) -> Array:
    """Monotone cubic interpolation of key values, (F, C): no overshoot, zero slope at extrema.

    The piecewise cubic of Fritsch and Carlson (1980) with harmonic-mean slopes and zero slope at either end.
    """
    if len(times) == 1:
        return np.repeat(values, len(now), axis=0)
    step = np.maximum(times[1:] - times[:-1], 1e-6)[:, None]
    secant = (values[1:] - values[:-1]) / step
    slope = np.zeros_like(values)
    before, after = secant[:-1], secant[1:]
    agree = before * after > 0
    heavy, light = 2 * step[1:] + step[:-1], step[1:] + 2 * step[:-1]
    mean = (heavy + light) / np.where(agree, heavy / np.where(agree, before, 1) + light / np.where(agree, after, 1), 1)
    slope[1:-1] = np.where(agree, mean, 0.0)
    at = np.minimum(np.maximum(np.searchsorted(times, now, side="right") - 1, 0), len(times) - 2)
    width = step[at]
    x = np.minimum(np.maximum((now - times[at])[:, None] / width, 0.0), 1.0)
    return np.asarray(
        values[at] * (1 + 2 * x) * (1 - x) ** 2
        + values[at + 1] * x * x * (3 - 2 * x)
        + width * (slope[at] * x * (1 - x) ** 2 + slope[at + 1] * x * x * (x - 1))
    )


def with_arcs(times: Array, values: Array, rng: Generator) -> tuple[Array, Array]:
    """Insert a middle pose, out to the side or in front, into arm swings over 100 degrees; values (K, 4)."""
    radius = np.linalg.norm(values[:, :3], axis=1, keepdims=True)
    aim = values[:, :3] / np.maximum(radius, 1e-6)
    long = np.flatnonzero((aim[:-1] * aim[1:]).sum(1) < -0.17)
    if not len(long):
        return times, values
    share = rng.uniform(0.0, 1.0)
    middle = aim[long] + aim[long + 1] + np.array([1.3 * share, 0.0, 1.3 * (1.0 - share)])
    middle *= (radius[long] + radius[long + 1]) / 2 / np.linalg.norm(middle, axis=1, keepdims=True)
    rows = np.concatenate([middle, (values[long, 3:] + values[long + 1, 3:]) / 2], axis=1)
    at = (times[long] + times[long + 1]) / 2
    return np.insert(times, long + 1, at), np.insert(values, long + 1, rows, axis=0)


def swung(now: Array, times: Array, rows: Array, share: float) -> tuple[Array, Array]:
    """Wrists (F, 3) through key places: a blend, by `share`, of arcs about the shoulder and straight lines.

    `rows` (K, 4) has a fourth channel, which is interpolated and returned too, (F,).
    """
    radius = np.sqrt((rows[:, :3] ** 2).sum(1, keepdims=True))
    path = through(now, times, np.concatenate([rows, radius], axis=1))
    straight = path[:, :3]
    length = np.maximum(np.sqrt((straight**2).sum(1)), 0.1)
    return straight * (1.0 + share * (path[:, 4] / length - 1.0))[:, None], path[:, 3]


def clear_of_body(hands: Array) -> Array:
    """Wrists (F, 3) pushed out of the trunk, an elliptic cylinder below the shoulders."""
    out = hands.copy()
    sideways, ahead = hands[:, 0] + 0.34, hands[:, 2]
    depth = np.sqrt((sideways / 0.36) ** 2 + (ahead / 0.27) ** 2)
    inside = np.clip((0.2 - hands[:, 1]) / 0.15, 0.0, 1.0) * (hands[:, 1] > -1.05)
    grow = 1.0 + inside * (np.maximum(1.0 / np.maximum(depth, 0.05), 1.0) - 1.0)
    out[:, 0], out[:, 2] = sideways * grow - 0.34, ahead * grow
    return np.asarray(out)


def elbow_room(hands: Array) -> Array:
    """Outward elbow swing (F,) that keeps the upper arm off the ribs while the hand is in front of the body."""
    crossing = np.clip(-0.05 - hands[:, 0], 0.0, 0.6) * np.clip(hands[:, 2] / 0.2, 0.0, 1.0)
    return 1.2 * crossing * np.clip((0.25 - hands[:, 1]) / 0.3, 0.0, 1.0)


def accompany(curves: Curves, rng: Generator) -> None:
    """The trunk accompanies the arms, in place: it turns with a hand held out and leans away from a raised one."""
    ahead = curves.hands[:, RIGHT, 2] - curves.hands[:, LEFT, 2]
    above = curves.hands[:, RIGHT, 1] - curves.hands[:, LEFT, 1]
    curves.spine[:, 2] += rng.uniform(0.0, 0.25) * ahead
    curves.pelvis[:, 2] += rng.uniform(0.0, 0.1) * ahead
    curves.spine[:, 1] += rng.uniform(0.0, 0.08) * above
    curves.head[:, 2] -= rng.uniform(0.0, 0.2) * ahead


def take_stance(curves: Curves, rng: Generator) -> None:
    """A natural stance, in place: feet apart, one ahead, and a slowly shifting weight."""
    apart, stagger = rng.uniform(0.0, 0.1), rng.normal(0.0, 0.04)
    curves.feet[:, :, 0] += [apart, -apart]
    curves.feet[:, :, 2] += [stagger, -stagger]
    curves.foot_yaw[:] += rng.normal(0.0, 0.12, 2)
    knots = max(len(curves) // 30, 1) + 1
    wander = rng.normal(0.0, 1.0, (knots, 4)) * [0.015, 0.012, 0.03, 0.04]
    shift = through(np.linspace(0.0, 1.0, len(curves)), np.linspace(0.0, 1.0, knots), wander)
    curves.root[:, 0] += shift[:, 0]
    curves.root[:, 2] += shift[:, 1]
    curves.spine[:, 1] -= 1.5 * shift[:, 0]
    curves.spine[:, 0] += shift[:, 2]
    curves.spine[:, 2] += shift[:, 3]


def step_round(curves: Curves) -> None:
    """Rotate root and feet with the heading about the origin, in place.

    With both feet near the ground the turn is stepped: each foot lifts and turns in its own steps. With one foot raised
    it is a pivot, and both feet follow.
    """
    pivots = bool((curves.feet[..., 1] > 0.3).any())
    turned = np.stack([curves.heading] * 2, axis=1)
    if not pivots:
        count = turned / _TURN + np.array([0.0, 0.5])
        share = np.clip((count - np.floor(count) - 0.25) * 2, 0.0, 1.0)
        turned = (np.floor(count) + ease(share) - np.array([0.0, 0.5])) * _TURN
        curves.feet[..., 1] += 0.06 * np.sin(np.pi * share)
    curves.foot_yaw[:] += turned
    for side in (LEFT, RIGHT):
        curves.feet[:, side] = _about(curves.feet[:, side], turned[:, side])
    curves.root[:] = _about(curves.root, curves.heading)


def _about(points: Array, angle: Array) -> Array:
    """Points (F, 3) rotated to the left about the vertical through the origin."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, z = points[:, 0], points[:, 2]
    return np.stack([cos * x + sin * z, points[:, 1], cos * z - sin * x], axis=1)
