"""Expressions of feelings and reflexes: laugh, cry, shiver, sneeze."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.keyframed_actions import HANDS, MOUTH, SIDED, UPPER, Cue, keyframed
from encoders.corpus.engine.keyframes import Channels, KeyPose, back, key

GROUP = "gesture"


@keyframed("yawn", group=GROUP, parts=UPPER, sides=HANDS)
def yawn(c: Cue) -> list[KeyPose]:
    """A hand before the mouth while the head falls back, or both arms stretched out and up."""
    if c.both or (not c.step.side and c.chance(0.5)):
        stretch = {"hands": c.about((c.r(0.25, 0.6), c.r(0.5, 0.8), 0.0), 0.05)}
        return [
            key(c.r(0.8, 1.2), c.r(0.5, 1.2), **stretch, spine=(-0.2, c.r(-0.1, 0.1), 0), head=(-0.3, 0, 0)),
            back(0.9),
        ]
    cover = key(c.r(0.5, 0.8), c.r(0.8, 1.6), lead=MOUTH, head=(-0.3, 0, 0), spine=(-0.1, 0, 0), shrugs=0.15)
    return [cover, back(0.7)]


def _fit(c: Cue, hand: bool, beat: float, deep: float, low: int, high: int) -> list[KeyPose]:
    """Jerks of the trunk with a hand before the mouth, as when coughing."""
    cover = {"lead": MOUTH} if hand else {}
    keys = [key(c.r(0.3, 0.5), **cover, spine=(-0.06, 0, 0), shrugs=0.1)]
    for _ in range(c.times(low, high, 2.5 * beat)):
        keys += [
            key(beat, spine=(deep * c.r(0.7, 1.3), 0, 0), head=(deep * 0.6, 0, 0), shrugs=0.2),
            key(1.5 * beat, spine=(deep * 0.2, 0, 0), head=(0, 0, 0), shrugs=0.05),
        ]
    return keys


@keyframed("cough", group=GROUP, parts=UPPER, sides=SIDED, counts=(1, 5))
def cough(c: Cue) -> list[KeyPose]:
    return [*_fit(c, bool(c.step.side) or c.chance(0.85), c.r(0.12, 0.2), c.r(0.2, 0.4), 2, 4), back(0.7)]


@keyframed("sneeze", group=GROUP, parts=UPPER, sides=SIDED, counts=(1, 3))
def sneeze(c: Cue) -> list[KeyPose]:
    cover = {"lead": MOUTH} if c.step.side or c.chance(0.8) else {}
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.4, 0.7), 0.15, spine=(-0.2, 0, 0), head=(-0.35, 0, 0), lead=(-0.1, -0.05, 0.45)),
            key(c.r(0.12, 0.2), 0.2, **cover, spine=(c.r(0.35, 0.7), 0, 0), head=(0.4, 0, 0), root=(0, -0.05, -0.03)),
            back(c.r(0.5, 0.8)),
        ]
    return keys


@keyframed("laugh", group=GROUP, parts=UPPER, counts=(3, 10), amplitudes=("small", "large"), weight=1.5)
def laugh(c: Cue) -> list[KeyPose]:
    """The chest shakes; hands hold the belly, cover the mouth, slap a thigh or hang."""
    size, beat = c.size(0.3), c.r(0.1, 0.17)
    kind = c.rng.random()
    hands: dict[str, ArrayLike] = {}
    if kind < 0.3:
        hands = {"hands": (-0.28, -0.55, 0.33)}
    elif kind < 0.5:
        hands = {"lead": MOUTH}
    lean = c.r(-0.25, 0.5)
    keys = [key(0.5, **hands, spine=(lean, 0, 0), head=(-0.3 if lean < 0.1 else 0.1, 0, 0))]
    for _ in range(c.times(5, 12, 2 * beat)):
        if kind > 0.7 and c.chance(0.25):  # throws the arms about, slaps a thigh, bends over
            lean = c.r(-0.3, 0.8)
            free = ((c.r(0.2, 0.7), c.r(-0.2, 0.5), 0.4), (-0.05, -0.75, 0.4))[int(c.chance(0.4))]
            keys += [
                key(c.r(0.25, 0.4), lead=free, off=free if c.chance(0.5) else (0.1, -0.6, 0.4), spine=(lean, 0, 0))
            ]
        keys += [
            key(beat, spine=(lean + 0.1 * size, 0, 0), shrugs=0.15 * size),
            key(beat, spine=(lean - 0.04 * size, c.r(-0.04, 0.04), 0), shrugs=0.0),
        ]
    return [*keys, back(0.8)]


@keyframed("cry", group=GROUP, parts=UPPER, counts=(3, 10), weight=1.5)
def cry(c: Cue) -> list[KeyPose]:
    """Head down in the hands or a wiping hand, shoulders heaving."""
    hands: dict[str, ArrayLike] = {"hands": (-0.24, 0.18, 0.3)} if c.chance(0.65) else {"lead": (-0.25, 0.24, 0.3)}
    bend, beat = c.r(0.15, 0.45), c.r(0.2, 0.35)
    keys = [key(0.8, 0.2, **hands, spine=(bend, 0, 0), head=(0.4, 0, 0))]
    for _ in range(c.times(4, 8, 2 * beat)):
        keys += [
            key(beat, shrugs=c.r(0.12, 0.25), spine=(bend - 0.08, 0, 0)),
            key(beat, shrugs=0.0, spine=(bend + 0.04, 0, 0)),
        ]
    return [*keys, back(0.9)]


def _shiver(name: str, beat: tuple[float, float], size: float, low: int, high: int, hug: float) -> None:
    @keyframed(name, group=GROUP, parts=UPPER)
    def shiver(c: Cue) -> list[KeyPose]:
        arms = (
            {"lead": (-0.58, -0.3, 0.32), "off": (-0.56, -0.36, 0.36)} if c.chance(hug) else {"hands": (0.1, -0.6, 0.4)}
        )
        base = {name: np.asarray(place) for name, place in arms.items()}
        pace, keys = c.r(*beat), [key(0.5, **arms, spine=(0.15, 0, 0), shrugs=0.15)]
        for _ in range(c.times(low, high, pace)):
            jolt = c.rng.normal(0.0, 1.0, 3) * size
            moves = {name: place + c.rng.normal(0.0, 1.0, 3) * size for name, place in base.items()}
            keys += [key(pace, **moves, spine=(0.15 + jolt[0], jolt[1], jolt[2]), head=(jolt[1], jolt[2], jolt[0]))]
        return [*keys, back(0.7)]


_shiver("tremble", (0.08, 0.12), 0.04, 14, 30, 0.7)
_shiver("shake body", (0.12, 0.2), 0.14, 10, 22, 0.0)


@keyframed("rock baby", group=GROUP, parts=UPPER, counts=(2, 8), precise=True)
def rock_baby(c: Cue) -> list[KeyPose]:
    beat, wide = c.r(0.6, 1.0), c.r(0.08, 0.2)
    lead, off = np.array([-0.55, -0.38, 0.4]), np.array([-0.4, -0.45, 0.42])
    keys = [key(0.8, lead=lead, off=off, head=(0.3, 0.15, 0))]
    for _ in range(c.times(2, 5, 2 * beat)):
        for side in (1, -1):
            swing = np.array([side * wide * 0.4, 0.02, 0.0])
            keys += [key(beat, lead=lead + swing, off=off - swing, spine=(0, 0.5 * side * wide, side * wide))]
    return [*keys, back(0.8)]


def _clutch(name: str, hands: Channels, bend: tuple[float, float], nod: float) -> None:
    @keyframed(name, group=GROUP, parts=UPPER, precise=True)
    def clutch(c: Cue) -> list[KeyPose]:
        lean, keys = c.r(*bend), list[KeyPose]()
        keys = [key(c.r(0.5, 0.9), 0.2, **hands, spine=(lean, 0, 0), head=(nod, 0, 0), root=(0, -0.04, 0))]
        for _ in range(c.times(2, 4, 1.0)):
            keys += [key(c.r(0.35, 0.6), c.r(0.0, 0.3), spine=(lean * c.r(0.7, 1.3), c.r(-0.15, 0.15), c.r(-0.1, 0.1)))]
        return [*keys, back(0.9)]


_clutch("clutch belly", {"lead": (-0.32, -0.58, 0.32), "off": (-0.36, -0.52, 0.34)}, (0.25, 0.8), 0.2)
_clutch("clutch head", {"hands": (-0.14, 0.34, 0.14), "elbows": 0.5}, (0.05, 0.5), 0.35)


@keyframed("vomit", group=GROUP, parts=UPPER, counts=(1, 4))
def vomit(c: Cue) -> list[KeyPose]:
    """Double up with a hand on the belly and retch."""
    keys = [
        key(
            0.6,
            lead=(-0.32, -0.55, 0.32),
            off=(0.0, -0.6, 0.45),
            spine=(0.5, 0, 0),
            pelvis=(0.3, 0, 0),
            head=(0.1, 0, 0),
        )
    ]
    for _ in range(c.times(1, 3)):
        keys += [
            key(0.2, 0.15, spine=(c.r(0.8, 1.1), 0, 0), head=(0.35, 0, 0), shrugs=0.2),
            key(c.r(0.4, 0.7), 0.1, spine=(0.5, 0, 0), head=(0.1, 0, 0), shrugs=0.0),
        ]
    return [*keys, back(1.0)]
