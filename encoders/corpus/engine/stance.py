"""Stances: how performers stand while their arms move, with feet apart, soft knees, and shifting hips and trunk.

The amounts were fitted to the stationary CMU takes of the training split.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, Array, Curves
from encoders.corpus.engine.joining import smooth_noise

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
