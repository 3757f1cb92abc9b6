"""Standing stretches of the legs: thigh, hamstring, calf, groin, hip."""

from __future__ import annotations

from numpy.typing import ArrayLike

from encoders.corpus.engine.keyframed_actions import SIDED, Cue, keyframed
from encoders.corpus.engine.keyframes import KeyPose, back, key


def _thigh(c: Cue) -> list[KeyPose]:
    """The heel drawn up behind to the seat by the hand."""
    arm: dict[str, ArrayLike] = {"off": (0.75, -0.2, 0.3)} if c.chance(0.5) else {}
    up: dict[str, ArrayLike] = {"lead_foot": (-0.02, c.r(0.45, 0.6), -0.36), "lead_toes": -0.8, "root": (-0.09, 0, 0)}
    return [
        key(c.r(0.5, 0.9), c.r(1.0, 3.0), lead=(0.02, -0.7, -0.33), spine=(c.r(-0.05, 0.15), 0, 0), **up, **arm),
        key(c.r(0.4, 0.7), lead_foot=(0, 0, 0), lead_toes=0.0, root=(0, 0, 0)),
    ]


def _back_of_leg(c: Cue) -> list[KeyPose]:
    """The heel put out ahead, toes up, the trunk bent over it and the hands on the thigh or at the toes."""
    far, bent = c.r(0.3, 0.5), c.r(0.5, 1.1)
    hands = (-0.1, -0.8, 0.4) if c.chance(0.5) else (-0.15, -0.9, 0.2)
    down = {"root": (-0.05, -0.12, -0.12), "pelvis": (0.55 * bent, 0, 0), "spine": (0.45 * bent, 0, 0), "hands": hands}
    foot = (0.0, 0.0, far)
    return [
        key(c.r(0.4, 0.7), lead_foot=foot, lead_toes=0.35, root=(-0.04, -0.02, -0.02)),
        key(c.r(0.5, 0.9), c.r(0.8, 2.5), lead_foot=foot, lead_toes=0.35, **down),
        key(c.r(0.5, 0.8), root=(-0.03, -0.02, 0), pelvis=(0, 0, 0), spine=(0, 0, 0)),
        key(0.5, lead_foot=(0, 0, 0), lead_toes=0.0, root=(0, 0, 0)),
    ]


def _calf(c: Cue) -> list[KeyPose]:
    """The leg put far behind with the heel down, the other knee bent, hands on hips, on the thigh or against a wall."""
    hands = ((0.3, -0.6, 0.02), (-0.05, -0.55, 0.5), (-0.05, 0.0, 0.85))[int(c.rng.integers(3))]
    far = c.r(0.4, 0.6)
    held = {"lead_foot": (0, 0, -far), "root": (0.0, -0.13, 0.02), "spine": (c.r(0.1, 0.3), 0, 0), "hands": hands}
    keys = [key(c.r(0.5, 0.8), lead_foot=(0, 0, -far), root=(0, -0.05, -0.1))]
    for _ in range(int(c.rng.integers(1, 4))):  # sinks deeper, sometimes bouncing
        keys += [key(c.r(0.4, 0.7), c.r(0.2, 1.2), **held), key(0.35, root=(0, -0.08, -0.02))]
    return [*keys, key(0.6, lead_foot=(0, 0, 0), root=(0, 0, 0), spine=(0, 0, 0))]


def _groin(c: Cue) -> list[KeyPose]:
    """Legs wide, the body sunk over the other knee so that this leg is long; hands on the knee or before the chest."""
    wide, deep = c.r(0.35, 0.5), c.r(0.15, 0.35)
    hands = (-0.05, -0.75, 0.35) if c.chance(0.6) else (-0.25, -0.3, 0.4)
    feet = {"lead_foot": (wide, 0, 0), "off_foot": (0.25, 0, 0)}
    low = {"root": (-0.26, -deep, -0.05), "pelvis": (0.25, 0, 0), "spine": (c.r(0.1, 0.4), 0, 0), "hands": hands}
    return [
        key(c.r(0.5, 0.8), root=(0.05, -0.05, 0), lead_foot=(wide, 0, 0)),
        key(c.r(0.5, 0.9), c.r(0.8, 2.5), **feet, **low, off_knee=0.3),
        key(0.6, root=(0.05, -0.06, 0), pelvis=(0, 0, 0), spine=(0, 0, 0), off_knee=0.0),
    ]


def _hip(c: Cue) -> list[KeyPose]:
    """The knee hugged up to the chest with both hands."""
    up = {"lead_foot": (-0.02, c.r(0.42, 0.55), 0.12), "root": (-0.09, 0, 0), "spine": (c.r(0.0, 0.2), 0, 0)}
    return [
        key(c.r(0.5, 0.8), c.r(0.8, 2.5), lead=(-0.15, -0.55, 0.5), off=(-0.4, -0.55, 0.5), **up),
        key(0.5, lead_foot=(0, 0, 0), root=(0, 0, 0), spine=(0, 0, 0)),
    ]


@keyframed("stretch leg", group="exercise", sides=SIDED, counts=(1, 3), weight=1.5)
def stretch_leg(c: Cue) -> list[KeyPose]:
    """One of the usual stretches of a leg, held, sometimes repeated."""
    stretch = (_thigh, _back_of_leg, _calf, _groin, _hip)[int(c.rng.choice(5, p=[0.25, 0.25, 0.2, 0.15, 0.15]))]
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        keys += [*stretch(c), back(c.r(0.4, 0.7))]
    return keys
