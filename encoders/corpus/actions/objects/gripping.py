"""Hands on doors, wheels, ropes and walls."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import ONE_ARM, SIDED, UPPER, Cue, keyframed, moved, orbit
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "object"


@keyframed("pull rope", group=GROUP, directions=("down",), counts=(2, 8), weight=1.5)
def pull_rope(c: Cue) -> list[KeyPose]:
    """Hand over hand, towards the body, or down from above."""
    down = c.step.direction == "down" or (not c.step.direction and c.chance(0.3))
    far, near = ((-0.3, 0.85, 0.3), (-0.3, -0.15, 0.4)) if down else ((-0.3, -0.15, 0.9), (-0.2, -0.35, 0.3))
    beat, keys = c.r(0.3, 0.5), [key(0.5, lead=far, off=near, root=(0, -0.05, 0), off_foot=(0, 0, 0.15))]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [
            key(beat, lead=near, off=far, spine=(-0.1, 0, -0.25), root=(0, -0.08, -0.04)),
            key(beat, lead=far, off=near, spine=(0.0, 0, 0.25), root=(0, -0.05, 0.0)),
        ]
    return [*keys, back(0.7)]


@keyframed("tug", group=GROUP, counts=(1, 5))
def tug(c: Cue) -> list[KeyPose]:
    """Lean back on a rope with both hands, jerk by jerk."""
    keys = [
        key(0.6, lead=(-0.3, -0.3, 0.75), off=(-0.25, -0.35, 0.55), lead_foot=(0.03, 0, -0.3), root=(0, -0.1, -0.1))
    ]
    for _ in range(c.times(2, 4, 0.8)):
        keys += [
            key(c.r(0.2, 0.4), c.r(0.1, 0.3), spine=(-0.3, 0, 0), root=(0, -0.2, -0.25), hands=(-0.25, -0.35, 0.5)),
            key(0.35, spine=(-0.05, 0, 0), root=(0, -0.12, -0.12), hands=(-0.28, -0.3, 0.75)),
        ]
    return [*keys, back(0.8)]


@keyframed("climb rope", group=GROUP, parts=UPPER, counts=(2, 8))
def climb_rope(c: Cue) -> list[KeyPose]:
    beat, keys = c.r(0.35, 0.6), [key(0.6, lead=(-0.28, 0.9, 0.25), off=(-0.28, 0.1, 0.35), head=(-0.4, 0, 0))]
    for _ in range(c.times(2, 4, 2 * beat)):
        keys += [
            key(beat, lead=(-0.28, 0.1, 0.35), off=(-0.28, 0.9, 0.25), spine=(0, 0.1, 0)),
            key(beat, lead=(-0.28, 0.9, 0.25), off=(-0.28, 0.1, 0.35), spine=(0, -0.1, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("open door", group=GROUP, parts=UPPER, sides=SIDED, weight=1.5)
def open_door(c: Cue) -> list[KeyPose]:
    """Take the handle, turn it, pull or push the door."""
    handle = c.about((-0.1, -0.42, 0.7), 0.04)
    swung = (0.45, -0.45, 0.3) if c.chance(0.5) else (0.3, -0.4, 0.88)
    return [
        key(c.r(0.5, 0.8), 0.1, lead=handle, head=(0.2, 0, 0)),
        key(0.25, 0.1, lead=moved(handle, 0.02, -0.06, 0)),
        key(c.r(0.6, 1.0), c.r(0.1, 0.4), lead=swung, spine=(0.05, 0, c.r(0.0, 0.3)), head=(0, 0, 0)),
        back(0.7),
    ]


@keyframed("close door", group=GROUP, parts=UPPER, sides=SIDED)
def close_door(c: Cue) -> list[KeyPose]:
    return [
        key(c.r(0.5, 0.7), 0.1, lead=(0.5, -0.42, 0.3), head=(0, 0, 0.3)),
        key(c.r(0.5, 0.9), c.r(0.1, 0.4), lead=(-0.2, -0.4, 0.85), spine=(0.1, 0, -0.2), head=(0, 0, 0)),
        back(0.7),
    ]


@keyframed("knock", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(2, 6))
def knock(c: Cue) -> list[KeyPose]:
    place, beat = c.about((-0.15, 0.05, 0.6), 0.04), c.r(0.1, 0.17)
    keys = [key(0.5, lead=place)]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [key(beat, lead=moved(place, 0, 0.02, 0.13)), key(beat, lead=place)]
    return [*keys, back(0.6)]


@keyframed("press button", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(1, 5))
def press_button(c: Cue) -> list[KeyPose]:
    place = c.about((-0.15, c.r(-0.3, 0.1), 0.65), 0.05)
    keys = [key(0.5, lead=place)]
    for _ in range(c.times(1, 3)):
        keys += [key(0.2, 0.1, lead=moved(place, 0, 0, 0.2)), key(0.25, lead=c.about(place, 0.05))]
    return [*keys, back(0.6)]


@keyframed("turn knob", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(1, 5))
def turn_knob(c: Cue) -> list[KeyPose]:
    place, keys = c.about((-0.15, -0.3, 0.6), 0.05), list[KeyPose]()
    keys = [key(0.6, 0.1, lead=place, lead_elbow=0.0)]
    for _ in range(c.times(1, 3)):
        keys += [key(0.3, 0.1, lead=moved(place, 0.06, 0.02, 0), lead_elbow=0.7), key(0.3, lead=place, lead_elbow=-0.1)]
    return [*keys, back(0.6)]


@keyframed("drive", group=GROUP, parts=UPPER, directions=SIDED, counts=(1, 5), weight=1.2)
def drive(c: Cue) -> list[KeyPose]:
    """Both hands on a wheel that turns one way and the other."""
    centre, wheel = np.array([0.0, -0.25, 0.62]), c.r(0.3, 0.42)

    def at(angle: float) -> dict[str, ArrayLike]:
        x, y = wheel * np.cos(angle), wheel * np.sin(angle)
        return {"lead": moved(centre, x - 0.34, -y, 0), "off": moved(centre, x - 0.34, y, 0)}

    way = c.toward or (1.0 if c.chance(0.5) else -1.0)
    keys = [key(0.6, c.r(0.2, 0.6), **at(0.0))]
    for index in range(c.times(1, 4, 1.5)):
        turn = way * c.r(0.5, 1.2) * (1 if c.step.direction or index % 2 == 0 else -1)
        keys += [
            key(c.r(0.4, 0.8), c.r(0.1, 0.5), **at(turn), spine=(0, 0.08 * turn, 0), head=(0, 0, 0.3 * turn)),
            key(c.r(0.4, 0.8), c.r(0.0, 0.3), **at(0.0), spine=(0, 0, 0), head=(0, 0, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("feel wall", group=GROUP, parts=UPPER, counts=(2, 6))
def feel_wall(c: Cue) -> list[KeyPose]:
    """Mime a wall: flat hands set against it, here and there."""
    keys: list[KeyPose] = []
    for _ in range(c.times(3, 6, 0.8)):
        spots = [(c.r(-0.3, 0.25), c.r(-0.3, 0.45), 0.68) for _ in range(2)]
        keys += [key(c.r(0.25, 0.45), c.r(0.1, 0.4), lead=spots[0]), key(c.r(0.25, 0.45), c.r(0.1, 0.4), off=spots[1])]
    return [*keys, back(0.7)]


@keyframed("pet animal", group=GROUP, sides=SIDED, counts=(2, 6))
def pet_animal(c: Cue) -> list[KeyPose]:
    squat = {"root": (0, -c.r(0.2, 0.42), -0.1), "pelvis": (0.35, 0, 0), "spine": (0.4, 0, 0), "head": (0.1, 0, 0)}
    beat = c.r(0.35, 0.55)
    keys = [key(0.8, 0.1, **squat, lead_reach=(0.05, 0.55, 0.35))]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [key(beat, lead_reach=(0.08, 0.5, 0.55)), key(beat, lead_reach=(0.05, 0.58, 0.35))]
    return [*keys, back(0.9)]


@keyframed("stir", group=GROUP, parts=ARMS, sides=SIDED, counts=(2, 8), amplitudes=AMPLITUDES, weight=1.5)
def stir(c: Cue) -> list[KeyPose]:
    """Round and round in a pot that the other hand may hold."""
    lap, radius = c.r(0.7, 1.3), 0.12 * c.size(0.3)
    centre = c.about((-0.2, -0.45, 0.5), 0.04)
    other = {"off": (-0.3, -0.5, 0.45)} if c.chance(0.5) else {}
    turns = c.times(3, 6, lap)
    keys = [key(0.6, lead=moved(centre, radius, 0, 0), **other, head=(0.3, 0, 0), spine=(0.1, 0, 0))]
    return [*keys, *orbit("lead", centre, (radius, 0, 0), (0, 0, radius), turns, lap), back(0.6)]
