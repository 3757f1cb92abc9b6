"""Greetings and other gestures towards people: salute, clap, hug, cheer."""

from __future__ import annotations

import numpy as np

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, SIDED, UPPER, Cue, keyframed, moved
from encoders.corpus.engine.keyframes import REST, KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "gesture"


@keyframed("salute", group=GROUP, parts=ONE_ARM, sides=SIDED, precise=True, counts=(1, 3))
def salute(c: Cue) -> list[KeyPose]:
    brow = c.about((c.r(-0.12, 0.02), c.r(0.26, 0.36), 0.22), 0.02)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        keys += [key(c.r(0.3, 0.6), c.r(0.5, 1.8), lead=brow, lead_elbow=c.r(0.6, 1.1), spine=(-0.06, 0, 0))]
        keys += [back(c.r(0.35, 0.7))]
    return keys


@keyframed("clap", group=GROUP, parts=ARMS, heights=("middle", "high"), amplitudes=AMPLITUDES, counts=(1, 8), weight=2)
def clap(c: Cue) -> list[KeyPose]:
    up = {"high": c.r(0.7, 0.92), "middle": c.r(-0.35, 0.1)}.get(c.step.height, c.r(-0.45, 0.15))
    ahead = c.r(0.3, 0.55) if up < 0.5 else c.r(0.05, 0.25)
    apart, beat = 0.16 * c.size(0.35), c.r(0.11, 0.26)
    together = np.array([-0.28, up, ahead])
    opened = together + np.array([apart, c.r(-0.06, 0.02), c.r(-0.05, 0.03)])
    keys = [key(c.r(0.4, 0.7), hands=opened)]
    for _ in range(c.times(3, 9, 2 * beat)):
        keys += [key(beat * 0.8, hands=together), key(beat * 1.2, hands=opened)]
    return [*keys, back(0.6)]


@keyframed("shake hands", group=GROUP, parts=ARMS, sides=SIDED, counts=(1, 5))
def shake_hands(c: Cue) -> list[KeyPose]:
    place, beat, depth = c.about((-0.15, -0.38, 0.68), 0.05), c.r(0.14, 0.24), c.r(0.06, 0.14)
    lean = (c.r(0.05, 0.2), 0, 0)
    keys = [key(c.r(0.5, 0.8), 0.15, lead=place, spine=lean)]
    for _ in range(c.times(2, 4, 2 * beat)):
        keys += [key(beat, lead=moved(place, 0, depth, 0)), key(beat, lead=moved(place, 0, -depth, 0))]
    return [*keys, back(0.7)]


@keyframed("hug", group=GROUP, parts=ARMS)
def hug(c: Cue) -> list[KeyPose]:
    up = c.r(-0.2, 0.0)
    return [
        key(c.r(0.5, 0.8), c.r(0.0, 0.3), hands=(0.35, up, 0.75)),
        key(0.5, c.r(0.8, 2.0), lead=(-0.5, up, 0.42), off=(-0.55, up - 0.12, 0.46), elbows=0.5, spine=(0.1, 0.06, 0),
            head=(0.1, -0.2, 0.2)),
        key(0.4, hands=(0.2, up - 0.1, 0.65)),
        back(0.7),
    ]  # fmt: skip


@keyframed("blow kiss", group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(1, 3))
def blow_kiss(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.4, 0.7), 0.2, hand=(-0.27, 0.15, 0.3), head=(0.1, 0, 0)),
            key(c.r(0.3, 0.5), c.r(0.2, 0.6), hand=c.about((0.15, 0.1, 0.85), 0.05), head=(-0.1, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("raise hand", group=GROUP, parts=ONE_ARM, sides=HANDS, heights=("middle", "high"), counts=(1, 3), weight=2)
def raise_hand(c: Cue) -> list[KeyPose]:
    """A raised hand, as to greet or to ask: at the shoulder with a bent elbow, or stretched up."""
    high = c.step.height == "high" or (not c.step.height and c.chance(0.5))
    place = c.about((0.1, c.r(0.8, 0.95), 0.15) if high else (c.r(0.05, 0.3), c.r(0.1, 0.4), 0.4), 0.05)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        keys += [key(c.r(0.25, 0.6), c.r(0.3, 1.6), hand=place, head=(c.r(-0.1, 0.1), 0, 0)), back(c.r(0.4, 0.8))]
    return keys


def _held(
    name: str, place: tuple[float, float, float], elbow: float = 0.0, most: int = 3, spread: float = 0.05
) -> None:
    """Register a gesture that consists of one held arm pose."""

    @keyframed(name, group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(1, most))
    def held(c: Cue) -> list[KeyPose]:
        keys: list[KeyPose] = []
        for _ in range(c.times(1, 1)):
            keys += [key(c.r(0.3, 0.6), c.r(0.5, 1.6), hand=c.about(place, spread), elbow=elbow), back(c.r(0.4, 0.7))]
        return keys


_held("thumbs up", (-0.05, -0.25, 0.65))
_held("stop gesture", (-0.1, 0.05, 0.82))
_held("flex biceps", (0.42, 0.28, 0.12), 0.5)
_held("offer", (-0.1, -0.35, 0.75))
_held("high five", (0.05, 0.4, 0.68))
_held("raise fist", (0.1, 0.8, 0.2))


@keyframed("cheer", group=GROUP, parts=UPPER, sides=HANDS, amplitudes=AMPLITUDES, counts=(1, 6), weight=2)
def cheer(c: Cue) -> list[KeyPose]:
    """Fists thrown up repeatedly, with springing knees."""
    size, beat = c.size(0.2), c.r(0.22, 0.35)
    top = c.about((c.r(0.05, 0.4), 0.9, 0.15), 0.04)
    down = top + np.array([0.05, -0.45 * size, 0.15])
    hand = "hand" if c.step.side else "hands"
    keys = [key(0.4, **{hand: top}, head=(-0.25, 0, 0), spine=(-0.1, 0, 0))]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [key(beat, **{hand: down}, root=(0, -0.05 * size, 0)), key(beat, **{hand: top}, root=(0, 0.015, 0))]
    return [*keys, back(0.7)]


@keyframed("surrender", group=GROUP, parts=ARMS)
def surrender(c: Cue) -> list[KeyPose]:
    return [key(c.r(0.4, 0.9), c.r(0.8, 2.2), hands=c.about((c.r(0.15, 0.4), c.r(0.3, 0.75), 0.2), 0.05)), back(0.8)]


@keyframed("welcome", group=GROUP, parts=ARMS)
def welcome(c: Cue) -> list[KeyPose]:
    """Arms opened wide."""
    wide = c.about((c.r(0.5, 0.8), c.r(-0.35, 0.05), c.r(0.35, 0.6)), 0.05)
    return [
        key(0.45, hands=(-0.15, -0.4, 0.42)),
        key(c.r(0.5, 0.8), c.r(0.5, 1.6), hands=wide, spine=(-0.08, 0, 0), head=(-0.05, 0, 0)),
        back(0.7),
    ]


@keyframed("plead", group=GROUP, parts=ARMS, counts=(2, 5))
def plead(c: Cue) -> list[KeyPose]:
    up, beat = c.r(-0.3, -0.05), c.r(0.2, 0.32)
    keys = [key(0.6, hands=(-0.29, up, 0.5), spine=(0.15, 0, 0), head=(-0.1, 0, 0))]
    for _ in range(c.times(2, 4, 2 * beat)):
        keys += [key(beat, hands=(-0.29, up - 0.1, 0.56)), key(beat, hands=(-0.29, up + 0.04, 0.46))]
    return [*keys, back(0.7)]


@keyframed("fold and nod", group=GROUP, parts=UPPER)
def fold_and_nod(c: Cue) -> list[KeyPose]:
    """Greet with palms together before the chest and a small bow."""
    return [
        key(0.6, hands=(-0.29, -0.15, 0.38)),
        key(0.5, c.r(0.2, 0.6), spine=(c.r(0.15, 0.4), 0, 0), head=(0.25, 0, 0)),
        key(0.5, spine=(0, 0, 0), head=(0, 0, 0)),
        key(0.6, hands=REST),
    ]
