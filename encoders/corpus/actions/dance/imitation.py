"""Imitation of animals and things: chicken, monkey, elephant, aeroplane, teapot."""

from __future__ import annotations

import numpy as np

from encoders.corpus.engine.keyframed_actions import SIDED, Cue, keyframed
from encoders.corpus.engine.keyframes import Channels, KeyPose, back, key

GROUP = "dance"


@keyframed("chicken", group=GROUP, counts=(2, 10), weight=1.5)
def chicken(c: Cue) -> list[KeyPose]:
    """Hands at the armpits, elbows flap; the head pecks, perhaps with little steps."""
    beat = c.r(0.17, 0.3)
    keys = [key(0.5, hands=(-0.08, -0.25, 0.22), elbows=0.6, spine=(0.2, 0, 0), root=(0, -0.08, 0))]
    for index in range(c.times(4, 9, 2 * beat)):
        steps: Channels = {}
        if index % 2 and c.chance(0.5):
            steps = {"lead_foot" if index % 4 == 1 else "off_foot": (0.02, 0.12, 0.08)}
        rest: Channels = dict.fromkeys(steps, (0, 0, 0))
        keys += [
            key(beat, hands=(0.0, -0.12, 0.16), elbows=1.3, head=(0.25, 0, 0), **steps),
            key(beat, hands=(-0.05, -0.32, 0.2), elbows=0.3, head=(-0.15, 0, 0), **rest),
        ]
    return [*keys, back(0.6)]


@keyframed("monkey", group=GROUP, counts=(2, 8), weight=1.2)
def monkey(c: Cue) -> list[KeyPose]:
    """Crouched, swaying on bowed legs, arms loose, scratching the ribs and the head."""
    beat = c.r(0.25, 0.42)
    low: Channels = {"root": (0, -0.2, -0.03), "spine": (0.5, 0, 0), "head": (-0.4, 0, 0), "feet": (0.1, 0, 0)}
    keys = [key(0.6, **low, hands=(0.25, -0.75, 0.3), lead_knee=0.5, off_knee=0.5)]
    for index in range(c.times(4, 8, 2 * beat)):
        side = 1.0 if index % 2 else -1.0
        move = c.rng.random()
        arms: Channels = {"lead": (0.2, -0.6, 0.4), "off": (0.2, -0.6, 0.4)}
        if move < 0.35:
            arms = {"lead": (0.0, -0.3, 0.18), "off": (0.0, -0.35, 0.15), "elbows": 1.0}
        elif move < 0.55:
            arms = {"lead": (-0.1, 0.5, 0.1), "elbows": 0.6}
        sway = (0.07 * side, -0.2, -0.03)
        keys += [
            key(beat, **arms, root=sway, spine=(0.5, 0.2 * side, 0)),
            key(beat, lead=(0.25, -0.5, 0.35), off=(0.25, -0.55, 0.3), root=(-0.07 * side, -0.16, -0.03), elbows=0.4),
        ]
    return [*keys, back(0.8)]


@keyframed("elephant", group=GROUP, counts=(1, 5))
def elephant(c: Cue) -> list[KeyPose]:
    """One arm hangs from the face like a trunk and swings, or is raised up."""
    keys = [key(0.7, lead=(-0.3, -0.7, 0.55), off=(-0.35, 0.1, 0.32), spine=(0.5, 0, 0), head=(0, 0, 0))]
    for _ in range(c.times(2, 4, 1.4)):
        if c.chance(0.3):
            keys += [
                key(0.6, 0.4, lead=(-0.1, 0.75, 0.55), spine=(-0.1, 0, 0)),
                key(0.6, lead=(-0.3, -0.7, 0.55), spine=(0.5, 0, 0)),
            ]
        else:
            keys += [
                key(0.5, lead=(0.1, -0.65, 0.6), spine=(0.5, 0.1, 0.15)),
                key(0.5, lead=(-0.6, -0.65, 0.5), spine=(0.5, -0.1, -0.15)),
            ]
    return [*keys, back(0.8)]


@keyframed("bird", group=GROUP, counts=(2, 8), weight=1.2)
def bird(c: Cue) -> list[KeyPose]:
    """Fly: wide slow wing beats, leaning forward, sometimes gliding from side to side."""
    beat, lean = c.r(0.3, 0.55), c.r(0.0, 0.6)
    keys = [key(0.6, hands=(0.92, 0.15, 0.0), spine=(lean, 0, 0), head=(-0.5 * lean, 0, 0))]
    for _ in range(c.times(3, 7, 2 * beat)):
        tilt = c.r(-0.25, 0.25) if c.chance(0.4) else 0.0
        keys += [
            key(beat, hands=(0.8, -0.45, 0.15), root=(0, 0.0, 0), spine=(lean, tilt, 0)),
            key(beat, hands=(0.82, 0.4, -0.05), root=(0, -0.05, 0), spine=(lean, tilt, 0), elbows=0.3),
        ]
    return [*keys, back(0.7)]


@keyframed("airplane", group=GROUP)
def airplane(c: Cue) -> list[KeyPose]:
    """Stiff arms out to the sides, banking."""
    keys = [key(0.6, hands=(0.98, 0.0, 0.0), spine=(c.r(0.0, 0.4), 0, 0))]
    for _ in range(c.times(2, 5, 1.6)):
        tilt = c.r(0.2, 0.45)
        keys += [
            key(c.r(0.5, 0.9), c.r(0, 0.3), spine=(0.2, tilt, 0)),
            key(c.r(0.5, 0.9), c.r(0, 0.3), spine=(0.2, -tilt, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("beast", group=GROUP, counts=(1, 5))
def beast(c: Cue) -> list[KeyPose]:
    """Threaten like a bear or a monster: claws up, leaning in, swiping."""
    claws = c.about((0.2, 0.35, 0.5), 0.05)
    keys = [key(0.5, 0.3, hands=claws, spine=(0.15, 0, 0), head=(-0.1, 0, 0), root=(0, -0.08, 0), feet=(0.08, 0, 0))]
    for index in range(c.times(1, 4, 0.9)):
        hand, side = ("lead", 1) if index % 2 == 0 else ("off", -1)
        keys += [
            key(0.3, **{hand: (0.35, 0.6, 0.2)}, spine=(0.0, 0, 0.25 * side)),
            key(0.2, 0.1, **{hand: (-0.5, -0.2, 0.65)}, spine=(0.35, 0, -0.35 * side)),
            key(0.35, **{hand: claws}, spine=(0.15, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("dog", group=GROUP)
def dog(c: Cue) -> list[KeyPose]:
    """Beg: paws before the chest, panting and hopping a little, looking about."""
    keys = [
        key(0.5, hands=(-0.15, -0.2, 0.35), elbows=-0.2, spine=(0.15, 0, 0), root=(0, -0.12, 0), head=(-0.15, 0, 0))
    ]
    for _ in range(c.times(4, 9, 0.5)):
        keys += [
            key(0.16, hands=(-0.15, -0.28, 0.38), root=(0, -0.16, 0), head=(0.0, c.r(-0.3, 0.3), 0)),
            key(0.16, hands=(-0.15, -0.18, 0.35), root=(0, -0.1, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("teapot", group=GROUP, sides=SIDED, counts=(1, 4))
def teapot(c: Cue) -> list[KeyPose]:
    """One hand on the hip as the handle, the other arm bent out as the spout, tipping over to its side."""
    pose: Channels = {"off": (0.0, -0.68, 0.05), "off_elbow": 0.9, "lead": (0.5, 0.1, 0.25), "lead_elbow": -0.3}
    keys = [key(0.7, c.r(0.2, 0.8), **pose)]
    for _ in range(c.times(1, 3)):
        keys += [
            key(c.r(0.5, 0.9), c.r(0.1, 0.6), spine=(0.05, c.r(0.35, 0.6), 0), root=(-0.04, 0, 0), head=(0, 0.2, 0)),
            key(0.6, spine=(0, 0, 0), root=(0, 0, 0), head=(0, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("ride horse", group=GROUP, counts=(3, 12))
def ride_horse(c: Cue) -> list[KeyPose]:
    """Bounce in the saddle with the reins in both hands, or one hand swung like a lasso."""
    beat, lasso = c.r(0.2, 0.3), c.chance(0.4)
    keys = [key(0.5, hands=(-0.25, -0.35, 0.5), root=(0, -0.15, 0), feet=(0.15, 0, 0), lead_knee=0.4, off_knee=0.4)]
    for index in range(c.times(5, 12, 2 * beat)):
        angle = index * np.pi / 2
        swing: Channels = {"lead": (0.15 + 0.25 * np.cos(angle), 0.75, 0.1 + 0.25 * np.sin(angle))} if lasso else {}
        keys += [
            key(beat, root=(0, -0.2, 0), spine=(0.15, 0, 0), off=(-0.25, -0.4, 0.52), **swing),
            key(beat, root=(0, -0.08, 0), spine=(0.05, 0, 0), off=(-0.25, -0.3, 0.45)),
        ]
    return [*keys, back(0.7)]


@keyframed("puppet", group=GROUP)
def puppet(c: Cue) -> list[KeyPose]:
    """Limbs jerked up as if by strings and dropped again."""
    keys: list[KeyPose] = []
    for _ in range(c.times(4, 9, 0.9)):
        hand = "lead" if c.chance(0.5) else "off"
        up = c.about((0.45, 0.1, 0.25), 0.15)
        foot: Channels = {f"{hand}_foot": (0.05, 0.25, 0.15)} if c.chance(0.35) else {}
        down: Channels = dict.fromkeys(foot, (0, 0, 0))
        keys += [
            key(0.22, 0.1, **{hand: up}, **foot, spine=(0.1, c.r(-0.2, 0.2), 0), head=(0.2, c.r(-0.3, 0.3), 0)),
            key(0.3, **{hand: (0.3, -0.75, 0.25)}, **down),
        ]
    return [*keys, back(0.6)]
