"""How people stand while their arms act: feet apart or one ahead, knees soft, hips that shift and a trunk that follows.

Sizes were set beside the CMU takes of the training split in which nobody goes anywhere: made gestures stood with their
feet side by side and their hips still, people do neither.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import ANKLE, Array, Curves
from encoders.corpus.engine.joining import roam

#: Who stands: hips this high and not carried anywhere, feet that stay where they are.
_HIPS, _STAYS = 0.78, 0.02


@dataclass(frozen=True)
class Stance:
    """One performer's way to stand.

    Attributes
    ----------
    apart, ahead : feet further apart each, the left ahead of the right; metres
    toes : turned out further, radians
    soft : hips lower, metres
    lean, aside : trunk forward, and to the left; radians
    onto : hips over the left foot rather than between the feet, metres
    restless : how much hips and trunk move, 1 as most people's do
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
    """Most stand nearly even; some wide, some with a foot well ahead, some with their weight on one leg."""
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
    """The movement by somebody who stands like this, in place; where a foot moves or nobody stands, as it was."""
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
    # A wider stance has the hips lower, as legs do not grow.
    curves.root[:, 1] -= stance.soft + 0.5 * (max(stance.apart, 0.0) ** 2 + stance.ahead**2)
    curves.pelvis[:, 0] += 0.5 * stance.lean
    curves.spine[:, 0] += 0.5 * stance.lean
    # The hip over the foot that bears the weight stands higher; the trunk stays upright over both.
    curves.root[:] += stance.onto * aside
    curves.pelvis[:, 1] -= 1.1 * stance.onto
    curves.spine[:, 1] += 1.1 * stance.onto + stance.aside
    _sway(curves, stance.restless, aside, along, rng)
    return curves


def _sway(curves: Curves, restless: float, aside: Array, along: Array, rng: Generator) -> None:
    """Weight shifts from foot to foot and from heel to toe; the trunk turns and leans with busy arms."""
    drift = restless * roam(len(curves), 6, rng, 1.0)
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
