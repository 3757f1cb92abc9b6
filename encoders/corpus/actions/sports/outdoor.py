"""Martial arts forms, weights, and sports on boards and skis."""

from __future__ import annotations

import numpy as np

from encoders.corpus.engine.keyframed_actions import HANDS, SIDED, Cue, keyframed
from encoders.corpus.engine.keyframes import REST, Channels, KeyPose, back, key

GROUP = "sport"


@keyframed("lift weights", group=GROUP, sides=HANDS, heights=("middle", "high"), counts=(1, 8), weight=1.3)
def lift_weights(c: Cue) -> list[KeyPose]:
    """Curl dumb-bells to the shoulders, or press them over the head."""
    press = c.step.height == "high" or (not c.step.height and c.chance(0.45))
    hand = "hand" if c.step.side else "hands"
    low, high = ((0.05, 0.05, 0.2), (0.05, 0.92, 0.08)) if press else ((0.05, -0.85, 0.25), (-0.02, -0.08, 0.3))
    beat = c.r(0.5, 0.9)
    keys = [key(0.7, 0.2, **{hand: low})]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [
            key(beat, c.r(0.0, 0.3), **{hand: high}, spine=(-0.06, 0, 0)),
            key(beat, c.r(0.0, 0.2), **{hand: low}, spine=(0.02, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("slap", group=GROUP, sides=SIDED, counts=(1, 4))
def slap(c: Cue) -> list[KeyPose]:
    up, keys = c.r(0.0, 0.3), list[KeyPose]()
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.3, 0.45), lead=(0.65, up, 0.2), spine=(0, 0, 0.4)),
            key(c.r(0.15, 0.22), lead=(0.0, up, 0.75), spine=(0.1, 0, -0.1)),
            key(c.r(0.12, 0.18), 0.05, lead=(-0.65, up - 0.05, 0.5), spine=(0.1, 0, -0.45)),
            key(0.4, lead=(-0.1, -0.5, 0.4), spine=(0, 0, 0)),
        ]
    return [*keys, back(0.5)]


@keyframed("karate", group=GROUP, counts=(2, 8), weight=1.5)
def karate(c: Cue) -> list[KeyPose]:
    """A form: deep stances, fists drawn to the hip, blocks, punches and a kick, each held."""
    hip = (-0.05, -0.5, 0.05)
    keys = [key(0.6, 0.2, hands=hip, feet=(0.08, 0, 0), root=(0, -0.08, 0))]
    for index in range(c.times(3, 6, 1.0)):
        front, rear, side = ("lead", "off", 1) if index % 2 == 0 else ("off", "lead", -1)
        deep: Channels = {
            f"{front}_foot": (0.05, 0, 0.4), f"{rear}_foot": (0.08, 0, -0.25), "root": (0, -0.2, 0.1),
            "pelvis": (0.05, 0, -0.2 * side),
        }  # fmt: skip
        blows: tuple[Channels, ...] = (
            {front: (-0.3, -0.1, 0.95), rear: hip},
            {rear: (-0.3, -0.15, 0.93), front: hip},
            {front: (0.1, -0.65, 0.5), rear: hip},
            {front: (0.05, 0.4, 0.4), rear: hip},
            {front: (0.35, 0.05, 0.5), rear: (-0.35, -0.3, 0.35)},
        )
        if c.chance(0.2):
            kick = {f"{rear}_foot": (-0.05, c.r(0.6, 1.0), 0.65)}
            keys += [
                key(0.25, **{f"{rear}_foot": (0, 0.45, 0.1)}, root=(0.07 * side, -0.05, 0)),
                key(0.18, 0.1, **kick),
            ]
        keys += [key(c.r(0.3, 0.45), **deep), key(c.r(0.14, 0.22), c.r(0.3, 0.8), **blows[int(c.rng.integers(5))])]
    return [*keys, back(0.9)]


@keyframed("tai chi", group=GROUP, speeds=(), weight=1.2)
def tai_chi(c: Cue) -> list[KeyPose]:
    """Slow round pushes and partings of the hands over bent, shifting legs."""
    keys = [key(1.2, hands=(-0.1, -0.1, 0.7), feet=(0.1, 0, 0), root=(0, -0.08, 0))]
    for index in range(c.times(3, 5, 2.4)):
        front, rear, side = ("lead", "off", 1) if index % 2 == 0 else ("off", "lead", -1)
        turn = c.r(0.1, 0.5) * side
        keys += [
            key(c.r(1.0, 1.5), **{front: (-0.3, -0.5, 0.4), rear: (-0.25, 0.0, 0.5)}, root=(-0.08 * side, -0.16, 0),
                spine=(0.03, 0, -turn)),
            key(c.r(1.0, 1.6), 0.1, **{front: c.about((0.1, 0.1, 0.75), 0.1), rear: c.about((0.15, -0.65, 0.25), 0.08)},
                root=(0.1 * side, -0.2, 0.05), spine=(0.03, 0, turn), head=(0, 0, 0.4 * turn)),
        ]  # fmt: skip
    return [*keys, key(0.8, hands=(-0.25, -0.4, 0.5), root=(0, -0.05, 0), spine=(0, 0, 0)), back(1.2)]


@keyframed("ski", group=GROUP, counts=(2, 8))
def ski(c: Cue) -> list[KeyPose]:
    """Crouched, swaying from edge to edge, poles planted in turn or pushed together."""
    beat, together = c.r(0.5, 0.9), c.chance(0.35)
    keys = [key(0.7, hands=(0.15, -0.35, 0.5), root=(0, -0.2, 0), spine=(0.35, 0, 0), head=(-0.2, 0, 0))]
    for _ in range(c.times(3, 6, 2 * beat)):
        if together:
            keys += [
                key(beat, hands=(0.05, -0.2, 0.75), root=(0, -0.1, 0), spine=(0.15, 0, 0)),
                key(beat * 0.7, hands=(0.2, -0.75, -0.45), root=(0, -0.28, 0), spine=(0.7, 0, 0)),
            ]
            continue
        for hand, side in (("lead", 1), ("off", -1)):
            rest = "off" if hand == "lead" else "lead"
            sway = {"root": (0.12 * side, -0.25, 0), "spine": (0.4, -0.15 * side, 0.15 * side)}
            keys += [key(beat, **{hand: (0.2, -0.55, 0.6), rest: (0.2, -0.35, 0.4)}, **sway)]
    return [*keys, back(0.9)]


@keyframed("surf", group=GROUP, sides=SIDED)
def surf(c: Cue) -> list[KeyPose]:
    """Sideways on a board, knees bent, arms out for balance; also skateboards and snowboards."""
    stand: Channels = {
        "lead_foot": (0.0, 0, 0.28), "off_foot": (0.0, 0, -0.28), "lead_turn": 0.9, "off_turn": -0.7,
        "pelvis": (0.1, 0, -0.9),
    }  # fmt: skip
    keys = [key(0.8, **stand, root=(0, -0.22, 0), hands=(0.75, -0.2, 0.25), head=(0, 0, 0.7), spine=(0.2, 0, 0))]
    for _ in range(c.times(3, 7, 0.8)):
        arms = {"lead": c.about((0.75, 0.0, 0.35), 0.15), "off": c.about((0.7, 0.0, 0.0), 0.15)}
        keys += [
            key(c.r(0.4, 0.8), c.r(0, 0.3), **arms, root=(0, -c.r(0.12, 0.35), c.r(-0.08, 0.08)),
                spine=(c.r(0.05, 0.4), c.r(-0.25, 0.25), c.r(-0.2, 0.2))),
        ]  # fmt: skip
    return [*keys, key(0.3, hands=REST), back(0.8)]


@keyframed("lasso", group=GROUP, sides=SIDED, counts=(2, 8))
def lasso(c: Cue) -> list[KeyPose]:
    """Whirl a rope over the head and throw it."""
    lap, keys = c.r(0.5, 0.8), list[KeyPose]()
    for index in range(8 * c.times(2, 4, lap)):
        angle = index * np.pi / 4
        keys += [key(lap / 8 if index else 0.6, lead=(0.1 + 0.25 * np.cos(angle), 0.75, 0.1 + 0.28 * np.sin(angle)))]
    return [*keys, key(0.22, 0.2, lead=(-0.1, 0.1, 0.93), spine=(0.15, 0, -0.3)), back(0.8)]
