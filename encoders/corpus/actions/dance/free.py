"""Free dancing: steps and arm movements to a beat."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from encoders.corpus.engine.keyframed_actions import SIDED, UPPER, Cue, keyframed
from encoders.corpus.engine.keyframes import REST, Channels, KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "dance"


def sway(c: Cue, side: float, size: float) -> Channels:
    """Hips to one side, trunk against them."""
    return {
        "root": (0.06 * side * size, -c.r(0.01, 0.06), 0.0),
        "pelvis": (0.0, 0.1 * side * size, 0.12 * side * size),
        "spine": (0.05, -0.14 * side * size, -0.1 * side * size),
    }


def _loose_arms(c: Cue, size: float) -> Channels:
    """A random place in front of or beside the body."""
    low = np.array([0.1, -0.45, 0.45])
    return {hand: low + c.rng.normal(0.0, 1.0, 3) * [0.2, 0.25, 0.12] * size for hand in ("lead", "off")}


def _groove(
    c: Cue, beat: float, count: int, arms: Callable[[int], Channels], size: float, travel: float
) -> list[KeyPose]:
    """Side to side on the beat; now and then a foot steps out and closes."""
    keys: list[KeyPose] = []
    for index in range(count):
        side = 1.0 if index % 2 == 0 else -1.0
        foot = "lead_foot" if side > 0 else "off_foot"
        out: Channels = {foot: (travel * c.r(0.6, 1.2), 0, c.r(-0.1, 0.15) * (travel > 0))} if c.chance(0.7) else {}
        keys += [key(beat, **sway(c, side, size), **arms(index), head=(c.r(-0.1, 0.15), 0.1 * side, 0), **out)]
        keys += [key(beat, root=(0, 0, 0), **({foot: (0, 0, 0)} if out else {}))]
    return keys


def _dancing_arms(kind: int, index: int, c: Cue, size: float) -> Channels:
    """Arm positions of one beat, in one of several patterns."""
    first, second = ("lead", "off") if index % 2 else ("off", "lead")
    if kind < 2:
        return _loose_arms(c, size)
    if kind == 2:
        return {first: (0.2, 0.6 * size, 0.35), second: (0.2, -0.4, 0.4)}
    if kind == 3:
        return {"hands": (c.r(0.0, 0.5), 0.75 + c.r(-0.15, 0.1), 0.2)}
    if kind == 4:
        return {first: (0.1, -0.35, 0.55), second: (0.25, -0.6, -0.15)}
    return {first: (0.75, -0.1, 0.3), second: (-0.45, -0.2, 0.5)}


@keyframed("dance", group=GROUP, amplitudes=AMPLITUDES, weight=4)
def dance(c: Cue) -> list[KeyPose]:
    """Free dancing: an arm pattern over a groove, sometimes with a turn at the end."""
    size, beat, keys = c.size(0.25), c.r(0.22, 0.42), list[KeyPose]()
    for _ in range(c.times(2, 3, 8 * beat)):
        kind = int(c.rng.integers(6))
        keys += _groove(c, beat, int(c.r(3, 6)), partial(_dancing_arms, kind, c=c, size=size), size, c.r(0.0, 0.25))
    if c.chance(0.3):
        turn = 2 * np.pi if c.chance(0.5) else -2 * np.pi
        keys += [key(c.r(1.0, 1.6), heading=turn, hands=(0.5, -0.3, 0.3))]
        return [*keys, key(0.6, hands=REST, spine=(0, 0, 0), pelvis=(0, 0, 0), head=(0, 0, 0))]
    return [*keys, back(0.6)]


@keyframed("hip hop", group=GROUP, amplitudes=AMPLITUDES, weight=1.5)
def hip_hop(c: Cue) -> list[KeyPose]:
    """Bounce deep on the beat with hard arm hits and steps out."""
    size, beat = c.size(0.2), c.r(0.2, 0.3)
    keys: list[KeyPose] = []
    for index in range(c.times(5, 10, 2 * beat)):
        side = 1.0 if index % 2 else -1.0
        foot = "lead_foot" if side > 0 else "off_foot"
        hits: tuple[Channels, ...] = (
            {"lead": (-0.3, 0.0, 0.55), "off": (0.5, -0.35, 0.3)},
            {"hands": (0.3, -0.2, 0.55)},
            {"off": (-0.5, -0.1, 0.5), "lead": (0.75, 0.0, 0.35)},
            {"lead": (0.1, 0.5, 0.5), "off": (0.2, -0.7, 0.2)},
        )
        arms = hits[int(c.rng.integers(4))]
        keys += [
            key(beat, **arms, **{foot: (0.18 * size, 0, 0.1)}, root=(0.05 * side, -0.14 * size, 0.03),
                spine=(0.25, 0.1 * side, 0.25 * side), head=(0.2, 0, 0)),
            key(beat, **{foot: (0.05, 0, 0)}, root=(0, -0.03, 0), spine=(0.08, 0, 0), head=(-0.05, 0, 0)),
        ]  # fmt: skip
    return [*keys, back(0.5)]


@keyframed("twist dance", group=GROUP, amplitudes=AMPLITUDES, counts=(3, 12))
def twist_dance(c: Cue) -> list[KeyPose]:
    """Hips and toes turn one way, chest and bent arms the other, going down and up."""
    size, beat = c.size(0.2), c.r(0.22, 0.34)
    count = c.times(5, 10, 2 * beat)
    keys: list[KeyPose] = []
    for index in range(count):
        deep = -0.05 - 0.2 * np.sin(np.pi * index / count) * size
        for way in (1.0, -1.0):
            turn = 0.5 * way * size
            keys += [
                key(beat, pelvis=(0.1, 0, turn), spine=(0.1, 0, -1.5 * turn), root=(0.02 * way, deep, -0.03),
                    lead_turn=0.6 * turn, off_turn=-0.6 * turn, lead=(0.25, -0.45, 0.45 - 0.2 * way),
                    off=(0.25, -0.45, 0.45 + 0.2 * way)),
            ]  # fmt: skip
    return [*keys, back(0.5)]


@keyframed("robot dance", group=GROUP)
def robot_dance(c: Cue) -> list[KeyPose]:
    """Abrupt changes between angular poses, with stops."""
    keys: list[KeyPose] = []
    forearms = ((0.1, -0.5, 0.48), (0.25, 0.0, 0.45), (0.6, -0.45, 0.05), (0.5, 0.35, 0.1), (0.05, -0.5, 0.5))
    for _ in range(c.times(5, 10, 0.6)):
        arms: Channels = {hand: forearms[int(c.rng.integers(5))] for hand in ("lead", "off") if c.chance(0.75)}
        turn = c.r(-0.6, 0.6)
        keys += [
            key(0.16, c.r(0.15, 0.5), **arms, spine=(0, c.r(-0.2, 0.2), turn), head=(0, 0, c.r(-0.6, 0.6)), elbows=0.3)
        ]
    return [*keys, back(0.4)]


@keyframed("macarena", group=GROUP, counts=(1, 2))
def macarena(c: Cue) -> list[KeyPose]:
    """Hands forward, turned, to the shoulders, the head, the hips, one after the other; then the hips roll."""
    beat = c.r(0.32, 0.48)
    spots = (
        (-0.05, 0.0, 0.95),
        (-0.02, 0.06, 0.93),
        (-0.68, 0.0, 0.28),
        (-0.15, 0.4, 0.0),
        (-0.55, -0.7, 0.25),
        (0.0, -0.68, -0.1),
    )
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        for spot in spots:
            for hand in ("lead", "off"):
                keys += [key(beat * 0.7, beat * 0.3, **{hand: spot}, spine=(0, 0.08 if hand == "lead" else -0.08, 0))]
        for side in (1.0, -1.0, 1.0):
            keys += [key(beat, root=(0.07 * side, -0.04, 0), pelvis=(0, 0.15 * side, 0))]
        keys += [key(0.2, feet=(0, 0.1, 0), root=(0, 0.1, 0)), key(0.2, feet=(0, 0, 0), root=(0, -0.03, 0))]
    return [*keys, back(0.5)]


@keyframed("disco", group=GROUP, sides=SIDED, counts=(2, 8))
def disco(c: Cue) -> list[KeyPose]:
    """One arm points up and out, then down across, the other hand on the hip."""
    beat = c.r(0.28, 0.42)
    keys = [key(0.5, off=(0.0, -0.68, 0.05), off_elbow=0.9, feet=(0.06, 0, 0))]
    for _ in range(c.times(3, 6, 2 * beat)):
        keys += [
            key(beat, lead=(0.5, 0.78, 0.15), spine=(-0.05, -0.1, 0.1), root=(-0.04, -0.02, 0), head=(-0.2, 0, 0.3)),
            key(beat, lead=(-0.6, -0.6, 0.35), spine=(0.1, 0.1, -0.2), root=(0.04, -0.06, 0), head=(0.1, 0, -0.2)),
        ]
    return [*keys, back(0.6)]


@keyframed("sway dance", group=GROUP, counts=(2, 8))
def sway_dance(c: Cue) -> list[KeyPose]:
    """Slow dance: weight from foot to foot, arms hanging, held round a partner, or waved overhead."""
    beat, size, kind = c.r(0.6, 1.1), c.size(0.2), c.rng.random()
    arms: Channels = (
        {} if kind < 0.25 else {"hands": (-0.2, -0.1, 0.55)} if kind < 0.7 else {"hands": (0.1, 0.85, 0.15)}
    )
    keys = [key(0.6, **arms)]
    for _ in range(c.times(2, 4, 2 * beat)):
        for side in (1.0, -1.0):
            wave: Channels = (
                {"lead": (0.1 + 0.3 * side, 0.8, 0.15), "off": (0.1 - 0.3 * side, 0.8, 0.15)} if kind >= 0.7 else {}
            )
            keys += [key(beat, **sway(c, side, 1.1 * size), **wave)]
    return [*keys, back(0.7)]


@keyframed("headbang", group=GROUP, parts=UPPER, counts=(3, 12))
def headbang(c: Cue) -> list[KeyPose]:
    beat, deep = c.r(0.16, 0.26), c.r(0.3, 0.7)
    arms: Channels = (
        {"lead": (0.1, 0.5, 0.4)} if c.chance(0.3) else {"hands": (0.1, -0.6, 0.35)} if c.chance(0.5) else {}
    )
    keys = [key(0.4, **arms, spine=(0.15, 0, 0), head=(-0.2, 0, 0))]
    for _ in range(c.times(5, 12, 2 * beat)):
        keys += [
            key(beat, spine=(0.2 + deep, 0, 0), head=(0.6, 0, 0)),
            key(beat, spine=(0.1, 0, 0), head=(-0.35, 0, 0)),
        ]
    return [*keys, back(0.5)]


@keyframed("spin dance", group=GROUP, directions=("clockwise", "counterclockwise"), counts=(1, 4), weight=1.5)
def spin_dance(c: Cue) -> list[KeyPose]:
    """Turn round and round on the spot with small steps, arms held out or up."""
    right = {"clockwise": True, "counterclockwise": False}.get(c.step.direction, c.chance(0.5))
    way = 1.0 if right == (c.lead == "right") else -1.0
    turns = c.times(1, 3)
    arms = {"hands": c.about(((0.9, 0.0, 0.1), (0.4, 0.75, 0.1), (0.2, -0.45, 0.4))[int(c.rng.integers(3))], 0.05)}
    full = way * 2 * np.pi * turns
    keys = [key(0.3, **arms, heading=0.06 * full)]
    keys += [key(turns * c.r(1.0, 1.8), **arms, heading=full)]
    return [*keys, key(0.6, hands=REST)]
