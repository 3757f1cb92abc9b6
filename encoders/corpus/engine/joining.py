"""Movements combined: in sequence with aligned joins, or simultaneously by body part."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, PART_CHANNELS, Array, Curves, ease

_MAX_STEP = 3.0  # most metres or radians per second that a join takes over from either end


def place(curves: Curves, at: Array, heading: float) -> Curves:
    """The movement from another position (3,) and heading: rotated about Y, then translated."""
    placed = Curves(curves.data.copy(), curves.spans, curves.parts)
    sin, cos = np.sin(heading), np.cos(heading)
    for points in (placed.root[:, None], placed.feet, placed.reach):
        x, z = points[..., 0].copy(), points[..., 2].copy()
        points[..., 0] = x * cos + z * sin + at[0]
        points[..., 1] += at[1]
        points[..., 2] = z * cos - x * sin + at[2]
    placed.heading[:] += heading
    placed.foot_yaw[:] += heading
    return placed


def _ground(curves: Curves) -> float:
    """Height of the ground under the last frame; 0 if it does not stand."""
    feet = curves.feet[-1, :, 1] - ANKLE
    level = float(feet.min())
    stands = abs(curves.pelvis[-1, 0]) < 0.6 and curves.root[-1, 1] - level > 0.7
    stands &= bool(curves.foot_pitch[-1].min() > -0.6)  # the toes of a body in the air point down
    return level if stands and level > 0.1 and np.ptp(feet) < 0.05 else 0.0


def _seam(before: Curves, after: Curves) -> int:
    """Frames between two movements; more for poses further apart."""
    feet = np.abs(after.feet[0] - after.root[0] - before.feet[-1] + before.root[-1]).max()
    hips = abs(after.root[0, 1] - before.root[-1, 1])
    hands = np.abs(after.hands[0] - before.hands[-1]).max()
    trunk = np.abs(after.pelvis[0] - np.remainder(before.pelvis[-1] + np.pi, 2 * np.pi) + np.pi).max()
    return int(np.clip(4 + 12 * feet + 16 * hips + 5 * hands + 5 * trunk, 4, 26))


def join(before: Curves, after: Curves) -> Curves:
    """One movement after the other: position and heading aligned, 4 to 26 frames interpolated.

    Position and heading align as in TEACH (Athanasiou et al. 2022); between, every channel follows the cubic that keeps
    both ends' velocities, and a foot that has to move is lifted, one after the other.
    """
    turned = np.arctan2(np.sin(before.heading[-1]), np.cos(before.heading[-1]))
    facing = place(after, np.zeros(3), turned - after.heading[0])
    frames = _seam(before, facing)
    start = before.data[-1].copy()
    start[4:7] = np.remainder(start[4:7] + np.pi, 2 * np.pi) - np.pi
    start_speed = np.clip(before.data[-1] - before.data[-2], -_MAX_STEP / 20, _MAX_STEP / 20)
    end_speed = np.clip(facing.data[1] - facing.data[0], -_MAX_STEP / 20, _MAX_STEP / 20)
    drift = (start_speed[:3] + end_speed[:3]) / 2 * (frames + 1)
    origin = before.root[-1] + drift - facing.root[0]
    origin[1] = _ground(before)
    # Headings may differ by whole turns; feet go with them.
    shift = before.heading[-1] - turned
    facing = place(facing, origin, 0.0)
    facing.heading[:] += shift
    facing.foot_yaw[:] += shift
    end = facing.data[0]
    x = (np.arange(1, frames + 1) / (frames + 1))[:, None]
    span = frames + 1
    between = start * (1 + 2 * x) * (1 - x) ** 2 + end * x * x * (3 - 2 * x)
    between += span * (start_speed * x * (1 - x) ** 2 - end_speed * x * x * (1 - x))
    seam = Curves(between, [])
    for side, window in ((0, (0.0, 0.6)), (1, (0.4, 1.0))):
        path = facing.feet[0, side] - before.feet[-1, side]
        far = float(np.hypot(path[0], path[2]))
        if far > 0.03:
            share = np.clip((x[:, 0] - window[0]) / (window[1] - window[0]), 0.0, 1.0)
            seam.feet[:, side] = before.feet[-1, side] + path * ease(share)[:, None]
            seam.feet[:, side, 1] += min(0.1, 0.35 * far) * np.sin(np.pi * share)
    offset = len(before) + frames
    spans = [*before.spans, *((first + offset, last + offset) for first, last in facing.spans)]
    return Curves(np.concatenate([before.data, between, facing.data]), spans, before.parts)


def chain(movements: Sequence[Curves]) -> Curves:
    """All movements in sequence."""
    joined = movements[0]
    for movement in movements[1:]:
        joined = join(joined, movement)
    return joined


def overlay(base: Curves, extra: Curves, start: int, *, eased: bool = True) -> Curves:
    """Body-part overlay from frame `start` (as in SINC): the parts that `extra` occupies follow it, all others `base`.

    Hands that reach for places in the world follow the moving body. `base` holds its last frame until `extra` ends.
    `eased`: `extra` takes over, and lets go, within some frames.
    """
    frames = max(len(base), start + len(extra))
    data = np.concatenate([base.data, np.repeat(base.data[-1:], frames - len(base), axis=0)])
    span = slice(start, start + len(extra))
    moving = Curves(extra.data.copy(), [])
    carrier = Curves(data[span], [])
    sin, cos = np.sin(carrier.heading)[:, None], np.cos(carrier.heading)[:, None]
    x, z = moving.reach[..., 0].copy(), moving.reach[..., 2].copy()
    moving.reach[..., 0] = x * cos + z * sin + carrier.root[:, :1]
    moving.reach[..., 2] = z * cos - x * sin + carrier.root[:, 2:]
    channels = np.concatenate([PART_CHANNELS[part] for part in sorted(extra.parts)])
    inside = np.arange(len(extra))
    weight = ease((inside + 1) / 6) * ease((len(extra) - inside) / 6) if eased else np.ones(len(extra))
    data[span, channels] += (moving.data[:, channels] - data[span][:, channels]) * weight[:, None]
    first, last = base.spans[0][0], base.spans[-1][1]
    return Curves(data, [(min(first, start), max(last, start + len(extra)))], base.parts | extra.parts)


def pause(curves: Curves, before: int, after: int) -> Curves:
    """Stand still for some frames at either end."""
    data = np.concatenate([np.repeat(curves.data[:1], before, 0), curves.data, np.repeat(curves.data[-1:], after, 0)])
    return Curves(data, [(first + before, last + before) for first, last in curves.spans], curves.parts)


def at_rest(curves: Curves, frame: int) -> bool:
    """Whether the body is at rest at a frame (0 or -1)."""
    step = curves.data[1] - curves.data[0] if frame == 0 else curves.data[-1] - curves.data[-2]
    return bool(np.abs(step[:3]).max() < 0.012)


def smooth_noise(frames: int, channels: int, rng: Generator, hertz: float) -> Array:
    """Smooth noise (F, C) with unit variance at `hertz` knots per second."""
    knots = max(int(frames / 20 * hertz) + 2, 4)
    at = np.linspace(0, knots - 1.001, frames)
    low = at.astype(np.int64)
    share = ease(at - low)[:, None]
    values = rng.standard_normal((knots, channels))
    return np.asarray(values[low] * (1 - share) + values[low + 1] * share)
