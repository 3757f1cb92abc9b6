"""Bows: deep or slight, held or quick, with various hand positions, sometimes after a step."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import TORSO, Array, Curves, ease, hold, standing
from encoders.corpus.engine.program import AMPLITUDES, program
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.engine.whole_body_poses import repeated
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

_DEPTH = {"small": (0.24, 0.55), "": (0.28, 1.4), "large": (1.05, 1.6)}  #: radians
_BELLY, _BACK, _ASIDE, _CHEST = (-0.42, -0.42, 0.4), (-0.15, -0.7, -0.22), (0.7, -0.3, 0.15), (-0.3, -0.12, 0.36)
_THIGHS, _CLASPED, _HIPS = (-0.12, -0.82, 0.26), (-0.32, -0.7, 0.3), (0.3, -0.6, 0.02)


@program("bow", group="posture", parts=TORSO, amplitudes=AMPLITUDES, counts=(1, 3), weight=3)
def bow(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend at the waist and come up again, once or more."""
    count = step.count or 1
    once = rng.uniform(1.3, 2.2) if rng.random() < 0.4 else rng.uniform(2.0, 3.8)
    frames = duration(once * count, step, manner, rng, frames)
    curves = standing(frames, TORSO)
    depth = rng.uniform(*_DEPTH[step.amplitude])
    share = rng.uniform(0.2, 0.42)
    near = repeated(frames, count, rng, down=share, up=rng.uniform(0.2, min(0.5, 0.75 - share)))
    down, hips = depth * near, rng.uniform(0.3, 0.85)
    curves.pelvis[:, 0] += hips * down
    curves.root[:, 2] -= 0.2 * hips * down
    curves.root[:, 1] -= rng.uniform(0.0, 0.08) * down
    curves.spine[:, 0] += (1 - hips) * down
    _nod(curves, down, rng)
    curves.feet[..., 0] *= rng.uniform(0.3, 1.5)
    curves.feet[:, int(rng.integers(2)), 2] += rng.uniform(-0.12, 0.12)
    _hold_hands(curves, near, rng)
    curves.hands[:] += rng.normal(0.0, 0.03, (2, 3))
    if rng.random() < 0.12:
        _step_before(curves, rng)
    return curves


def _nod(curves: Curves, down: Array, rng: Generator) -> None:
    """The head follows the trunk, leads it, or keeps looking ahead."""
    earlier = int(rng.integers(0, 6))
    nod = np.concatenate([down[earlier:], np.repeat(down[-1:], earlier)])
    curves.head[:, 0] += rng.uniform(-0.35, 0.6) * nod


def _hold_hands(curves: Curves, near: Array, rng: Generator) -> None:
    """Move the hands to one of the usual places of a bow, on the way down or throughout."""
    kind, arm = rng.random(), int(rng.integers(2))
    weight = near if rng.random() < 0.6 else hold(len(near), rng.uniform(0.05, 0.2), rng.uniform(0.05, 0.2))
    if kind < 0.2:  # hands stay at the sides of the thighs
        curves.hang[:] = 0.8 - 0.75 * near[:, None]
    elif kind < 0.28:  # arms hang down loosely
        curves.hang[:] = 1.0
    elif kind < 0.45:  # hands slide down before the thighs, further the deeper
        _carry(curves, (0, 1), np.array(_THIGHS) - [0.0, 0.08, 0.0], near)
    elif kind < 0.62:
        _carry(curves, (0, 1), _CLASPED, weight)
    elif kind < 0.68:  # both behind the back
        _carry(curves, (0, 1), _BACK, weight)
    elif kind < 0.86:  # one arm across the belly, the other behind the back, swept aside or hanging
        _carry(curves, (arm,), _BELLY, weight)
        other = (_BACK, _ASIDE, _HIPS, None)[int(rng.integers(4))]
        if other is not None:
            _carry(curves, (1 - arm,), other, weight)
    elif kind < 0.92:  # a hand on the heart
        _carry(curves, (arm,), _CHEST, weight)
    else:  # arms opened to the sides, as on a stage
        _carry(curves, (0, 1), np.array(_ASIDE) + rng.normal(0.0, 0.12, 3), near)


def _carry(curves: Curves, arms: tuple[int, ...], place: ArrayLike, weight: Array) -> None:
    """Blend hands towards a place by `weight` (F,)."""
    for arm in arms:
        curves.hands[:, arm] += (np.asarray(place) - curves.hands[:, arm]) * weight[:, None]
        curves.hang[:, arm] *= 1 - weight


def _step_before(curves: Curves, rng: Generator) -> None:
    """A step forward or back as the bow starts, the other foot closing."""
    way = rng.uniform(0.15, 0.4) * (1.0 if rng.random() < 0.7 else -1.0)
    now, first = np.arange(len(curves)) / FPS, int(rng.integers(2))
    for foot, begin in ((first, 0.0), (1 - first, 0.4)):
        share = ease((now - begin) / 0.4)
        curves.feet[:, foot, 2] += way * share
        curves.feet[:, foot, 1] += 0.07 * np.sin(np.pi * share)
    curves.root[:, 2] += way * ease(now / 0.75)
