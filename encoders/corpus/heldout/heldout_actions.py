"""Held-out actions: key-pose programs that no training clip shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import SIDED, UPPER, Cue, keyframed, moved, orbit
from encoders.corpus.engine.keyframes import KeyPose, back, key

_SQUAT: dict[str, ArrayLike] = {
    "root": (0, -0.5, -0.1),
    "pelvis": (0.9, 0, 0),
    "spine": (0.5, 0, 0),
    "reaches": (0.24, 0.04, 0.55),
}
_FACE_DOWN: dict[str, ArrayLike] = {
    "root": (0, -0.42, 0.05), "pelvis": (1.27, 0, 0), "spine": (0, 0, 0), "head": (-0.35, 0, 0),
    "feet": (0, 0.03, -0.75), "lead_toes": -1.2, "off_toes": -1.2, "reaches": (0.24, 0.04, 0.62),
}  # fmt: skip


@keyframed("burpee", group="exercise", styled=False, held_out=True)
def burpee(c: Cue) -> list[KeyPose]:
    """Squat, jump back to hands and toes, forward again, and leap with the arms up."""
    beat, keys = c.r(0.3, 0.45), list[KeyPose]()
    for _ in range(c.times(2, 4)):
        keys += [
            key(beat * 1.4, feet=(0, 0, 0), **_SQUAT),
            key(beat, 0.15, **_FACE_DOWN),
            key(beat, lead_toes=0.0, off_toes=0.0, feet=(0, 0, 0), **_SQUAT),
            key(beat * 0.9, root=(0, 0.18, 0), pelvis=(0, 0, 0), spine=(0, 0, 0), head=(0, 0, 0), feet=(0, 0.2, 0),
                hands=(0.05, 0.9, 0.1)),
            key(beat * 0.7, root=(0, -0.1, 0), feet=(0, 0, 0), hands=(0.1, -0.6, 0.3)),
        ]  # fmt: skip
    return [*keys, back(0.5)]


@keyframed("discus throw", group="sport", sides=SIDED, held_out=True)
def discus_throw(c: Cue) -> list[KeyPose]:
    """Swing a straight arm far back and forth, then once round the body and let go high in front."""
    low, ahead = (0.75, -0.35, -0.5), (-0.35, -0.1, 0.75)
    keys = [key(0.5, feet=(0.12, 0, 0), root=(0, -0.1, 0), lead=(0.5, -0.6, 0.3))]
    for _ in range(int(c.rng.integers(1, 4))):
        keys += [
            key(c.r(0.5, 0.7), lead=low, off=(0.3, -0.3, 0.4), spine=(0.15, 0, 0.7), root=(0.06, -0.12, 0)),
            key(c.r(0.5, 0.7), lead=ahead, off=(0.3, -0.4, 0.1), spine=(0.15, 0, -0.4), root=(-0.06, -0.1, 0)),
        ]
    return [
        *keys,
        key(0.6, 0.1, lead=low, off=(0.3, -0.2, 0.6), spine=(0.2, 0, 0.8), root=(0.08, -0.18, 0)),
        key(c.r(0.5, 0.7), lead=(0.9, -0.1, -0.2), off=(0.6, -0.1, 0.4), heading=-3.2, root=(0, -0.12, 0)),
        key(c.r(0.4, 0.6), 0.3, lead=(0.1, 0.5, 0.8), off=(0.4, -0.5, -0.2), heading=-6.28, spine=(-0.1, 0, -0.5)),
        back(0.9),
    ]


@keyframed("kettlebell swing", group="exercise", styled=False, held_out=True)
def kettlebell_swing(c: Cue) -> list[KeyPose]:
    """Both hands swing from between the knees up to the height of the face, driven by the hips."""
    beat, top = c.r(0.5, 0.75), c.r(0.0, 0.45)
    keys = [key(0.5, feet=(0.12, 0, 0), hands=(-0.3, -0.85, 0.2), spine=(0.2, 0, 0))]
    for _ in range(c.times(4, 8, 2 * beat)):
        keys += [
            key(beat, hands=(-0.32, -0.8, -0.25), pelvis=(0.7, 0, 0), spine=(0.25, 0, 0), root=(0, -0.2, -0.18)),
            key(beat, hands=(-0.32, top, 0.85), pelvis=(-0.05, 0, 0), spine=(-0.05, 0, 0), root=(0, 0, 0.02)),
        ]
    return [*keys, back(0.7)]


@keyframed("sumo stomp", group="sport", styled=False, held_out=True)
def sumo_stomp(c: Cue) -> list[KeyPose]:
    """Legs wide and bent, hands on the knees; one straight leg is raised high to its side and stamped down, in turn."""
    wide: dict[str, ArrayLike] = {
        "feet": (0.28, 0, 0),
        "lead_turn": 0.7,
        "off_turn": 0.7,
        "lead_knee": 0.4,
        "off_knee": 0.4,
    }
    low: dict[str, ArrayLike] = {
        "root": (0, -0.32, -0.03),
        "spine": (0.4, 0, 0),
        "pelvis": (0.15, 0, 0),
        "hands": (0.15, -0.72, 0.35),
    }
    keys = [key(0.8, 0.3, **wide, **low)]
    for i in range(int(c.rng.integers(2, 5))):
        foot, way = ("lead_foot", -1) if i % 2 == 0 else ("off_foot", 1)
        keys += [
            key(c.r(0.7, 1.0), 0.2, root=(0.22 * way, -0.06, 0), spine=(0.25, 0.35 * way, 0), pelvis=(0, 0.3 * way, 0),
                hands=(0.15, -0.75, 0.25), **{foot: (0.62, 0.55, 0.0)}),
            key(c.r(0.3, 0.45), c.r(0.2, 0.5), **wide, **low),
        ]  # fmt: skip
    return [*keys, back(1.0)]


@keyframed("sow seeds", group="object", sides=SIDED, parts=UPPER, held_out=True)
def sow_seeds(c: Cue) -> list[KeyPose]:
    """One hand holds a bag at the hip, the other takes from it and scatters outward in a wide arc."""
    keys = [key(0.6, off=(0.0, -0.55, 0.3))]
    for _ in range(c.times(3, 6, 1.7)):
        keys += [
            key(c.r(0.5, 0.7), 0.1, lead=(-0.6, -0.6, 0.35), spine=(0.12, 0, -0.35), head=(0.3, 0, -0.2)),
            key(c.r(0.25, 0.4), lead=(0.0, -0.15, 0.75), spine=(0.05, 0, 0.0)),
            key(c.r(0.25, 0.4), lead=(0.85, -0.1, 0.1), off=(0.0, -0.55, 0.3), spine=(0, 0, 0.5), head=(0.1, 0, 0.3)),
        ]
    return [*keys, back(0.8)]


@keyframed("turn crank", group="object", held_out=True)
def turn_crank(c: Cue) -> list[KeyPose]:
    """Both hands wind a big handle round before the belly, the trunk bowing with it."""
    lap, centre = c.r(0.9, 1.5), np.array([-0.25, -0.3, 0.6])
    up, fore = np.array([0, c.r(0.25, 0.4), 0]), np.array([0, 0, c.r(0.2, 0.3)])
    turns = orbit("hands", centre, up, fore * (1 if c.chance(0.6) else -1), c.times(3, 6, lap), lap)
    for i, turn in enumerate(turns):
        bow = 0.25 - 0.2 * float(np.cos((i + 1) * np.pi / 4))
        turn.channels.update(spine=(bow, 0, 0), root=(0, -0.08 - 0.15 * bow, 0))
    return [key(0.7, hands=centre + up, spine=(0.05, 0, 0), lead_foot=(0.05, 0, 0.2)), *turns, back(0.8)]


@keyframed("ring bell", group="object", held_out=True)
def ring_bell(c: Cue) -> list[KeyPose]:
    """A hanging rope pulled from high above the head down to the belly with both hands, again and again."""
    keys: list[KeyPose] = []
    for _ in range(c.times(3, 5, 2.2)):
        keys += [
            key(c.r(0.8, 1.1), 0.1, lead=(-0.3, 0.93, 0.2), off=(-0.34, 0.8, 0.2), head=(-0.5, 0, 0),
                spine=(-0.1, 0, 0), root=(0, 0.02, 0)),
            key(c.r(0.5, 0.8), 0.1, lead=(-0.3, -0.4, 0.35), off=(-0.34, -0.55, 0.35), head=(0.1, 0, 0),
                spine=(0.35, 0, 0), root=(0, -0.22, -0.08)),
        ]  # fmt: skip
    return [*keys, back(0.8)]


@keyframed("kayak", group="sport", parts=UPPER, held_out=True)
def kayak(c: Cue) -> list[KeyPose]:
    """A double blade held across dips on one side and on the other in turn."""
    beat = c.r(0.5, 0.8)
    keys = [key(0.6, hands=(0.1, -0.15, 0.6), root=(0, 0, 0))]
    for i in range(2 * c.times(3, 5, 2 * beat)):
        down, up, way = ("lead", "off", 1.0) if i % 2 == 0 else ("off", "lead", -1.0)
        keys += [
            key(beat * 0.5, **{down: (0.25, -0.35, 0.75), up: (0.0, 0.2, 0.45)}, spine=(0.2, 0.1 * way, -0.35 * way)),
            key(beat * 0.5, **{down: (0.45, -0.55, 0.05), up: (-0.3, 0.15, 0.7)}, spine=(0.1, 0.15 * way, 0.4 * way)),
        ]
    return [*keys, back(0.8)]


@keyframed("tie ponytail", group="gesture", parts=UPPER, precise=True, held_out=True)
def tie_ponytail(c: Cue) -> list[KeyPose]:
    """Both hands gather at the back of the head, wind there, and draw outward."""
    behind = np.array([-0.3, 0.42, -0.16])
    keys = [key(0.8, 0.2, hands=(-0.12, 0.5, 0.05), head=(0.15, 0, 0)), key(0.5, 0.3, hands=behind)]
    for _ in range(int(c.rng.integers(2, 5))):
        keys += [
            key(c.r(0.3, 0.5), lead=moved(behind, 0.12, 0.06, -0.04), off=moved(behind, 0.0, -0.05, 0.0)),
            key(c.r(0.3, 0.5), off=moved(behind, 0.12, 0.06, -0.04), lead=moved(behind, 0.0, -0.05, 0.0)),
        ]
    return [*keys, key(0.35, 0.2, hands=moved(behind, 0.22, 0.05, -0.03), head=(0, 0, 0)), back(0.8)]


@keyframed("pump tyre", group="object", styled=False, held_out=True)
def pump_tyre(c: Cue) -> list[KeyPose]:
    """Bent over a foot pump, both hands push its handle down to the shins and draw it up to the belly."""
    beat = c.r(0.35, 0.6)
    keys = [key(0.7, hands=(-0.28, -0.55, 0.4), spine=(0.4, 0, 0), pelvis=(0.3, 0, 0), root=(0, -0.05, -0.08))]
    for _ in range(c.times(4, 9, 2 * beat)):
        keys += [
            key(beat, hands=(-0.28, -0.93, 0.2), spine=(0.65, 0, 0), pelvis=(0.75, 0, 0), root=(0, -0.16, -0.15)),
            key(beat, hands=(-0.28, -0.5, 0.4), spine=(0.4, 0, 0), pelvis=(0.3, 0, 0), root=(0, -0.05, -0.08)),
        ]
    return [*keys, back(0.8)]


@keyframed("play accordion", group="object", parts=ARMS, held_out=True)
def play_accordion(c: Cue) -> list[KeyPose]:
    """Hands before the chest draw apart and press together."""
    beat, height = c.r(0.5, 1.0), c.r(-0.4, -0.25)
    keys = [key(0.7, hands=(-0.12, height, 0.4), elbows=0.4)]
    for _ in range(c.times(3, 7, 2 * beat)):
        keys += [
            key(beat, hands=(0.38, height - 0.02, 0.36), elbows=0.5),
            key(beat, hands=(-0.12, height, 0.4), elbows=0.4),
        ]
    return [*keys, back(0.7)]


@keyframed("milk cow", group="object", styled=False, held_out=True)
def milk_cow(c: Cue) -> list[KeyPose]:
    """Low on the haunches, the hands before the knees pull down in turn."""
    beat, high, low = c.r(0.25, 0.45), np.array([-0.2, -0.1, 0.7]), np.array([-0.2, -0.32, 0.62])
    crouched: dict[str, ArrayLike] = {
        "root": (0, -0.5, -0.15),
        "pelvis": (0.3, 0, 0),
        "spine": (0.35, 0, 0),
        "head": (0.1, 0, 0),
    }
    keys = [key(1.0, hands=high, feet=(0.08, 0, 0), **crouched)]
    for _ in range(c.times(4, 9, 2 * beat)):
        keys += [key(beat, lead=low, off=high), key(beat, lead=high, off=low)]
    return [*keys, key(0.3, **crouched), back(1.0)]
