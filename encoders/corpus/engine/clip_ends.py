"""Starts and ends of clips: idle standing, a shift of one foot, or a cut in mid-motion."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, LEFT, Curves, ease
from encoders.corpus.engine.joining import at_rest, pause
from encoders.corpus.scene import Scene

_LONGEST = 50  #: most frames of standing at either end
_CUT = 9  #: most frames that an ordinary cut removes
_MIDST = 0.3  #: most of a clip that is removed at either end where it begins or ends in the midst of an action
_FEW = 24  #: fewest frames of a clip after a cut


def begin_and_end(curves: Curves, scene: Scene, rng: Generator, variation: float) -> Curves:
    """The movement with the idle time, or the cuts, of a real take."""
    before = _idle(curves, 0, rng, variation)
    after = _idle(curves, -1, rng, variation)
    curves = pause(curves, before, after)
    if before > 14 and rng.random() < 0.3:
        _shift_foot(curves, 0, before, rng)
    if after > 14 and rng.random() < 0.3:
        _shift_foot(curves, len(curves) - after, len(curves), rng)
    counted = any(step.count for group in scene.steps for step in group)
    if counted or rng.random() > 0.3 * variation:
        return curves
    deep = len(scene.steps) == 1 and rng.random() < 0.4
    return _cut(curves, rng, max(_CUT, int(_MIDST * len(curves))) if deep else _CUT)


def _idle(curves: Curves, frame: int, rng: Generator, variation: float) -> int:
    if rng.random() >= 0.5 * variation or not at_rest(curves, frame):
        return 0
    return min(int(rng.exponential(12)), _LONGEST)


def _shift_foot(curves: Curves, start: int, stop: int, rng: Generator) -> None:
    """One standing foot is put down again some centimetres away, in place."""
    foot, inside = int(rng.integers(2)), slice(start, stop)
    if np.ptp(curves.feet[inside, :, 1]) > 0.01 or abs(curves.feet[start, foot, 1] - ANKLE) > 0.03:
        return
    share = ease((np.arange(stop - start) - rng.integers(2, 5)) / 9)
    away = 1 - share if start == 0 else share
    place = rng.normal(0.0, 0.05, 2)
    curves.feet[inside, foot, 0] += place[0] * away
    curves.feet[inside, foot, 2] += place[1] * away
    curves.feet[inside, foot, 1] += rng.uniform(0.02, 0.05) * np.sin(np.pi * share)
    curves.root[inside, 0] += 0.02 * np.sin(np.pi * share) * (-1 if foot == LEFT else 1)


def _cut(curves: Curves, rng: Generator, most: int) -> Curves:
    """Remove up to `most` frames of the movement at either end or both."""
    sides = rng.integers(1, 4)
    first, last = (int(rng.integers(1, most + 1)) if sides & bit else 0 for bit in (1, 2))
    frames = len(curves) - first - last
    if frames < _FEW:
        return curves
    spans = [(max(a - first, 0), min(b - first, frames)) for a, b in curves.spans]
    if any(b - a < 6 for a, b in spans):
        return curves
    return Curves(curves.data[first : first + frames], spans, curves.parts)
