"""Waving: from small wrist movements at the belly to wide swings overhead, one-handed or two-handed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import Array
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, Cue, keyframed
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

#: Kinds of waves (name, share): the forearm swings, the wrist alone, the whole arm, or the palm flaps up and down.
_WAYS = (("forearm", 0.42), ("wrist", 0.2), ("arm", 0.2), ("flap", 0.18))
#: Height of the hand over its shoulder, arm lengths, and share: belly, chest, face, overhead.
_LEVELS = (((-0.6, -0.35), 0.14), ((-0.35, 0.0), 0.32), ((0.0, 0.4), 0.3), ((0.45, 0.95), 0.24))
#: Places of the hand that does not wave: on the hip, behind the back, in a pocket, at the belly, on the thigh.
_IDLE = ((0.3, -0.6, 0.02), (-0.15, -0.7, -0.25), (0.08, -0.82, 0.12), (-0.3, -0.62, 0.32), (0.02, -0.92, 0.15))


@dataclass(frozen=True)
class _Swing:
    """A hand's swing about a place: half its extent, the sag at its ends, and the seconds from end to end."""

    centre: Array
    half: Array
    sag: float
    beat: float

    def at(self, phase: float) -> Array:
        return np.asarray(self.centre + phase * self.half - [0.0, abs(phase) * self.sag, 0.0])


def _level(c: Cue) -> float:
    if c.step.height == "high":
        return c.r(0.35, 0.95)
    if c.step.height == "middle":
        return c.r(-0.3, 0.15)
    return c.r(*_LEVELS[int(c.rng.choice(len(_LEVELS), p=[share for _, share in _LEVELS]))][0])


def _swing(c: Cue) -> _Swing:
    way = _WAYS[int(c.rng.choice(len(_WAYS), p=[share for _, share in _WAYS]))][0]
    up, size = _level(c), c.size(0.35)
    ahead = c.r(0.05, 0.45) if up > 0.4 else c.r(0.2, 0.55) if up > 0.0 else c.r(0.35, 0.65)
    centre = c.about((c.r(-0.1, 0.4), up, ahead), 0.03)
    if way == "flap":
        half = size * c.r(0.05, 0.13)
        return _Swing(centre, half * np.array([0.1, 1.0, c.r(0.0, 0.9)]), 0.0, c.r(0.13, 0.26))
    if way == "wrist":
        half = size * c.r(0.04, 0.09)
        return _Swing(centre, half * np.array([1.0, c.r(-0.3, 0.1), 0.0]), 0.0, c.r(0.1, 0.19))
    if way == "arm":
        half = size * c.r(0.2, 0.4)
        centre = centre * (0.88 / float(np.linalg.norm(centre)))
        return _Swing(centre, half * np.array([1.0, -0.2, 0.0]), 0.3 * half, c.r(0.24, 0.45))
    half = size * c.r(0.1, 0.26)
    sideways = half * np.array([1.0, -0.35, c.r(-0.3, 0.3)])
    return _Swing(centre, sideways, 0.3 * half, c.r(0.16, 0.3) * (1.0 + 1.5 * max(half - 0.2, 0.0)))


def _second_hand(c: Cue, swing: _Swing) -> _Swing:
    """The second of two waving hands: parallel, mirrored, alternating, or crossing in front of the face."""
    kind = c.rng.random()
    if kind < 0.5:
        return swing
    if kind < 0.75:  # both to the same side
        return _Swing(swing.centre, -swing.half * [1.0, -1.0, -1.0], swing.sag, swing.beat)
    return _Swing(swing.centre, -swing.half, swing.sag, swing.beat)


def _crossing(c: Cue, swing: _Swing) -> _Swing:
    """Hands that cross in the middle, overhead or in front of the face."""
    wide = max(abs(float(swing.half[0])), 0.15)
    return _Swing(swing.centre * [0, 1, 1] - [0.12, 0.0, 0.0], wide * np.array([1.4, 0.0, 0.0]), 0.2 * wide, 0.3)


def _body(c: Cue) -> tuple[dict[str, ArrayLike], dict[str, ArrayLike]]:
    """The body at either end of a swing: still, swaying, springing or hopping."""
    kind, size = c.rng.random(), c.r(0.3, 1.0)
    if kind < 0.55:
        held = c.r(-0.15, 0.08) * c.chance(0.4)
        return {"spine": (0.0, held + c.r(-0.05, 0.05), 0.0)}, {"spine": (0.0, held, 0.0)}
    if kind < 0.8:
        aside = 0.045 * size
        return (
            {"root": (aside, -0.008, 0.0), "spine": (0.0, -0.16 * size, 0.0)},
            {"root": (-aside, -0.008, 0.0), "spine": (0.0, 0.1 * size, 0.0)},
        )
    if kind < 0.94:
        return {"root": (0.0, -0.05 * size, 0.0)}, {"root": (0.0, 0.0, 0.0)}
    air = 0.08 * size
    return {"root": (0.0, -0.06, 0.0)}, {"root": (0.0, air, 0.0), "feet": (0.0, air, 0.0)}


@keyframed(
    "wave",
    group="gesture",
    parts=ONE_ARM,
    sides=HANDS,
    heights=("middle", "high"),
    amplitudes=AMPLITUDES,
    counts=(2, 8),
    weight=5,
)
def wave(c: Cue) -> list[KeyPose]:
    """Raise the hand, swing it, lower it; the other hand rests somewhere, the body moves along more or less."""
    swing = _swing(c)
    if c.both and c.chance(0.2):
        swing = _crossing(c, swing)
    other = _second_hand(c, swing)

    def pose(phase: float) -> dict[str, ArrayLike]:
        hands: dict[str, ArrayLike] = {"lead": swing.at(phase)}
        if c.both:
            hands["off"] = other.at(phase)
        return hands

    idle: dict[str, ArrayLike] = {}
    if not c.both and c.chance(0.25):
        idle["off"] = c.about(_IDLE[int(c.rng.integers(len(_IDLE)))], 0.03)
    here, there = _body(c)
    head = (c.r(-0.12, 0.12), c.r(-0.15, 0.15), c.r(-0.1, 0.1))
    keys = [key(0.0, **idle)] if idle else []
    if c.chance(0.07):  # a step in between
        way = c.r(0.15, 0.35) * (1.0 if c.chance(0.7) else -1.0)
        keys += [key(0.4, lead_foot=(0, 0, way), root=(0, -0.01, 0.5 * way)), key(0.4, off_foot=(0, 0, way))]
        here, there = {"root": (0.0, 0.0, way)}, {"root": (0.0, 0.0, way)}
    keys += [
        key(c.r(0.3, 0.9), c.r(0.0, 0.25) * c.chance(0.4), **pose(c.r(-0.2, 0.8)), elbow=c.r(-0.2, 0.5), head=head)
    ]
    for _ in range(c.times(2, 8 if c.chance(0.3) else 5, 2 * swing.beat)):
        keys += [key(swing.beat, **pose(-1.0), **here), key(swing.beat, **pose(1.0), **there)]
    if not c.frames and c.chance(0.15):  # the clip ends while the hand is up
        return keys
    last = back(c.r(0.4, 0.9))
    return [*keys, KeyPose(last.seconds, c.r(0.0, 0.3), {**last.channels, **idle})]
