"""Dances with fixed steps: salsa, waltz, ballet, cancan."""

from __future__ import annotations

import numpy as np

from encoders.corpus.actions.dance.free import GROUP, sway
from encoders.corpus.engine.keyframed_actions import UPPER, Cue, keyframed, orbit
from encoders.corpus.engine.keyframes import REST, Channels, KeyPose, back, key


@keyframed("salsa", group=GROUP, counts=(1, 6), weight=1.5)
def salsa(c: Cue) -> list[KeyPose]:
    """One foot forward, replace, close; the other back, replace, close; hips over each step, elbows bent."""
    beat, long, size = c.r(0.22, 0.34), c.r(0.15, 0.3), c.size(0.2)
    arms = {"lead": (0.15, -0.5, 0.42), "off": (0.15, -0.45, 0.42)}
    keys = [key(0.3, **arms)]
    for _ in range(c.times(2, 4, 6 * beat)):
        if c.chance(0.35):  # an arm is led up or out, as under a partner's
            keys += [key(beat, lead=c.about((c.r(-0.2, 0.7), c.r(-0.2, 0.6), 0.45), 0.05))]
        for foot, way, side in (("lead_foot", 1, 1.0), ("off_foot", -1, -1.0)):
            keys += [
                key(beat, **{foot: (0, 0, way * long)}, **sway(c, side, 1.2 * size) | {"root": (0,
                -0.03, way * long / 2)},
                    lead=(0.2, -0.5, 0.3), off=(0.1, -0.45, 0.5)),
                key(beat, **sway(c, -side, 1.2 * size), lead=(0.1, -0.45, 0.5), off=(0.2, -0.5, 0.3)),
                key(beat * c.r(1.0, 1.8), **{foot: (0, 0, 0)}, **sway(c, side, size)),
            ]  # fmt: skip
    return [*keys, back(0.5)]


@keyframed("waltz", group=GROUP, counts=(1, 4), weight=1.5)
def waltz(c: Cue) -> list[KeyPose]:
    """Box steps in dance hold: forward, side, close, backward, side, close, rising and falling."""
    beat, long = c.r(0.35, 0.55), c.r(0.2, 0.35)
    hold = {"lead": (-0.2, c.r(-0.25, 0.0), 0.55), "off": (0.7, c.r(-0.1, 0.15), 0.4)}
    keys = [key(0.7, **hold, spine=(-0.08, 0, 0), head=(0, 0, -0.3))]
    for _ in range(c.times(1, 3, 6 * beat)):
        turn = c.r(-0.15, 0.15)
        keys += [
            key(beat, off_foot=(0, 0, long), root=(0, -0.05, long * 0.9), spine=(-0.08, 0, turn)),
            key(beat, lead_foot=(long, 0, long), root=(long * 0.6, 0.02, long), spine=(-0.08, -0.08, 0)),
            key(beat, off_foot=(-long, 0, long), root=(long, 0.03, long)),
            key(beat, lead_foot=(long, 0, 0), root=(long, -0.05, 0.1 * long), spine=(-0.08, 0, -turn)),
            key(beat, off_foot=(0, 0, 0), root=(0.4 * long, 0.02, 0), spine=(-0.08, 0.08, 0)),
            key(beat, lead_foot=(0, 0, 0), root=(0, 0.03, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("ballet", group=GROUP, weight=1.5)
def ballet(c: Cue) -> list[KeyPose]:
    """Round arms through the positions, knee bends, a leg extended, perhaps a turn on one foot."""
    places = {
        "low": (-0.15, -0.75, 0.35), "first": (-0.2, -0.25, 0.6), "second": (0.8, -0.1, 0.3),
        "fifth": (-0.15, 0.88, 0.2),
    }  # fmt: skip
    keys = [key(0.6, hands=places["low"], elbows=0.5, lead_turn=0.6, off_turn=0.6, spine=(-0.06, 0, 0))]
    for _ in range(c.times(3, 6, 1.2)):
        move = c.rng.random()
        names = list(places)
        a, b = (places[names[int(c.rng.integers(1, 4))]] for _ in range(2))
        if move < 0.35:
            keys += [
                key(c.r(0.6, 1.0), hands=places["second"], root=(0, -c.r(0.12, 0.25), 0), lead_knee=0.7, off_knee=0.7),
                key(c.r(0.6, 1.0), hands=a, root=(0, 0.03, 0), lead_knee=0.0, off_knee=0.0, feet=(0, 0.03, 0)),
                key(0.4, feet=(0, 0, 0)),
            ]
        elif move < 0.7:
            leg = ((0.0, 0.35, 0.6), (0.0, 0.45, -0.6), (0.6, 0.4, 0.0))[int(c.rng.integers(3))]
            tip = (0.35 if leg[2] < 0 else 0.0, -0.15 if leg[0] else 0.0, 0)
            keys += [
                key(c.r(0.7, 1.1), c.r(0.2, 0.8), lead_foot=leg, lead_toes=-0.8, root=(-0.08, 0.01, 0), pelvis=tip,
                    lead=a, off=b),
                key(c.r(0.5, 0.8), lead_foot=(0, 0, 0), lead_toes=0.0, root=(0, 0, 0), pelvis=(0, 0, 0),
                hands=places["low"]),
            ]  # fmt: skip
        else:
            keys += [key(c.r(0.5, 0.9), 0.1, lead=a, off=b, head=(0, -0.1, 0.4 * c.r(-1, 1)))]
    return [*keys, back(0.8)]


@keyframed("pirouette", group=GROUP, directions=("clockwise", "counterclockwise"), counts=(1, 3))
def pirouette(c: Cue) -> list[KeyPose]:
    """Wind up, then turn on one foot with the other at the knee and round arms."""
    right = {"clockwise": True, "counterclockwise": False}.get(c.step.direction, c.chance(0.5))
    way = 1.0 if right == (c.lead == "right") else -1.0  # clockwise from above is to the right
    full = way * 2 * np.pi * c.times(1, 2)
    retire: Channels = {
        "lead_foot": (-0.1, 0.42, 0.05),
        "lead_toes": -0.8,
        "lead_knee": 0.9,
        "root": (-0.09, 0.02, 0),
    }
    time = c.r(0.7, 1.0) * abs(full) / (2 * np.pi)
    return [
        key(0.6, lead=(0.75, -0.1, 0.3), off=(-0.2, -0.2, 0.6), spine=(0, 0, -0.3 * way), root=(0, -0.12, 0)),
        key(0.25, **retire, hands=(-0.2, -0.15, 0.55), elbows=0.4, spine=(0, 0, 0), heading=0.2 * full),
        key(time * 0.75, 0.05, **retire, heading=full),
        key(
            0.35,
            lead_foot=(0.05, 0, -0.1),
            lead_toes=0.0,
            lead_knee=0.0,
            root=(0, -0.06, -0.02),
            hands=(0.75, -0.1, 0.3),
        ),
        key(0.6, hands=REST, elbows=0.0, root=(0, 0, 0), lead_foot=(0, 0, 0)),
    ]


@keyframed("cancan", group=GROUP, counts=(2, 8))
def cancan(c: Cue) -> list[KeyPose]:
    """High kicks in turn with a hop between, hands on the hips."""
    beat, high = c.r(0.28, 0.4), c.r(0.5, 1.0)
    keys = [key(0.5, hands=(0.0, -0.68, 0.05), elbows=0.9)]
    for index in range(c.times(3, 6, 2 * beat)):
        foot, other, side = ("lead_foot", "off_foot", -1) if index % 2 == 0 else ("off_foot", "lead_foot", 1)
        keys += [
            key(beat, **{foot: (0, high, 0.62)}, pelvis=(-0.25, 0, 0), root=(0.07 * side, 0.02, 0), spine=(0.1, 0, 0)),
            key(beat, **{foot: (0, 0, 0), other: (0, 0.03, 0)}, pelvis=(0, 0, 0), root=(0, -0.04, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("belly dance", group=GROUP, parts=frozenset({"legs", *UPPER}), counts=(2, 8))
def belly_dance(c: Cue) -> list[KeyPose]:
    """Hips circle and drop while the arms wave at the sides."""
    lap, wide = c.r(0.8, 1.4), c.r(0.05, 0.1)
    keys = [key(0.6, hands=(0.7, 0.0, 0.2), root=(wide, -0.05, 0))]
    for _ in range(c.times(2, 5, lap)):
        circle = orbit("root", (0, -0.05, 0), (wide, 0, 0), (0, 0, wide), 1, lap)
        for index, k in enumerate(circle):
            wave = 0.25 * np.sin(index * np.pi / 4)
            arms: Channels = {"lead": (0.7, wave, 0.2), "off": (0.7, -wave, 0.2)} if index % 2 else {}
            keys += [
                KeyPose(
                    k.seconds, 0.0, {**k.channels, **arms, "pelvis": (0, 2.0 * np.cos(index * np.pi / 4) * wide, 0)}
                )
            ]
    return [*keys, back(0.7)]


@keyframed("step touch", group=GROUP, counts=(2, 8), weight=1.5)
def step_touch(c: Cue) -> list[KeyPose]:
    """Step to one side, close with a clap or snap, and back the other way."""
    beat, wide, claps = c.r(0.3, 0.48), c.r(0.2, 0.4), c.chance(0.5)
    meet: Channels = {"hands": (-0.28, -0.2, 0.45)} if claps else {"hands": (0.25, -0.35, 0.4)}
    part: Channels = {"hands": (0.3, -0.4, 0.3)} if claps else {"hands": (0.1, -0.6, 0.3)}
    keys: list[KeyPose] = []
    for index in range(c.times(2, 6, 2 * beat)):
        go, close = ("lead_foot", "off_foot") if index % 2 == 0 else ("off_foot", "lead_foot")
        side = 1.0 if index % 2 == 0 else -1.0
        there = wide if index % 2 == 0 else 0.0
        keys += [
            key(beat, **{go: (wide if side > 0 else 0.0, 0, 0)}, root=(wide / 2, -0.04, 0), **part),
            key(beat, **{close: (-wide if side > 0 else 0.0, 0, 0)}, root=(there, 0.0, 0), **meet),
        ]
    return [*keys, back(0.6)]
