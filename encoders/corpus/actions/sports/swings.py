"""Swings of clubs, bats and rackets; strokes of swimmers and rowers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.keyframed_actions import SIDED, UPPER, Cue, grip, keyframed
from encoders.corpus.engine.keyframes import KeyPose, back, key

GROUP = "sport"


def _club(
    c: Cue, address: ArrayLike, top: ArrayLike, finish: ArrayLike, wind: float, bend: float, fast: float
) -> list[KeyPose]:
    """A club or bat in both hands: address, wind up away, swing through to the other side."""
    where = [np.asarray(p) for p in (address, top, finish)]
    low = (where[0] + [0.05, -0.05, 0.0]).tolist()
    keys = [key(c.r(0.5, 0.8), c.r(0.3, 1.0), **grip(*where[0]), spine=(bend, 0, 0), root=(0, -0.05, -0.04))]
    for _ in range(c.times(1, 1)):
        keys += [
            key(c.r(0.5, 0.9), c.r(0.05, 0.3), **grip(*where[1]), spine=(bend, 0, wind), pelvis=(0.05, 0, 0.3 * wind),
                head=(0.1, 0, -wind * 0.8), root=(0.05, -0.05, -0.03)),
            key(fast, **grip(*low), spine=(bend, 0, -0.2 * wind), pelvis=(0.05, 0, -0.2 * wind),
                root=(-0.04, -0.06, 0)),
            key(fast * 1.1, c.r(0.3, 0.9), **grip(*where[2]), spine=(bend * 0.2, 0, -wind), pelvis=(0, 0, -0.6 * wind),
                head=(0, 0, -0.2 * wind), root=(-0.07, -0.01, 0)),
        ]  # fmt: skip
    return [*keys, back(c.r(0.8, 1.1))]


@keyframed("golf swing", group=GROUP, sides=SIDED, counts=(1, 3), weight=1.5)
def golf_swing(c: Cue) -> list[KeyPose]:
    """The leading side is the side of the backswing."""
    top = (c.r(0.55, 0.75), c.r(0.35, 0.55), 0.2)
    finish = (-c.r(0.55, 0.75), c.r(0.35, 0.6), 0.1)
    return _club(c, (0.0, -0.72, 0.5), top, finish, c.r(0.6, 0.9), c.r(0.25, 0.45), c.r(0.18, 0.27))


@keyframed("swing bat", group=GROUP, sides=SIDED, counts=(1, 3), weight=1.5)
def swing_bat(c: Cue) -> list[KeyPose]:
    finish = (-0.7, c.r(-0.1, 0.3), 0.3)
    return _club(c, (0.45, c.r(0.0, 0.2), 0.2), (0.65, 0.12, -0.05), finish, c.r(0.5, 0.8), 0.1, c.r(0.14, 0.22))


@keyframed("tennis swing", group=GROUP, sides=SIDED, counts=(1, 5), weight=1.5)
def tennis_swing(c: Cue) -> list[KeyPose]:
    """Forehand or backhand, low to high across the body."""
    keys = [key(0.4, 0.2, hands=(-0.1, -0.4, 0.5), root=(0, -0.06, 0), spine=(0.15, 0, 0))]
    for _ in range(c.times(1, 3)):
        way = 1 if c.chance(0.65) else -1
        start = (0.65, -0.25, -0.35) if way > 0 else (-0.8, -0.3, 0.25)
        hit, end = ((0.35, -0.2, 0.7), (-0.6, 0.3, 0.45)) if way > 0 else ((0.1, -0.2, 0.8), (0.75, 0.3, 0.25))
        turn = way * c.r(0.4, 0.7)
        keys += [
            key(c.r(0.3, 0.5), lead=c.about(start, 0.05), spine=(0.1, 0, turn), root=(0.06 * way, -0.08, 0)),
            key(c.r(0.13, 0.2), lead=hit, spine=(0.12, 0, -0.2 * turn), off_foot=(0, 0, c.r(0.0, 0.3))),
            key(c.r(0.14, 0.22), 0.1, lead=c.about(end, 0.05), spine=(0.05, 0, -turn), root=(-0.04 * way, -0.03, 0.05)),
            key(0.45, hands=(-0.1, -0.4, 0.5), spine=(0.15, 0, 0), root=(0, -0.05, 0), off_foot=(0, 0, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("serve", group=GROUP, sides=SIDED, counts=(1, 3))
def serve(c: Cue) -> list[KeyPose]:
    """Toss with one hand, strike overhead with the other: tennis or volleyball."""
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        keys += [
            key(0.5, 0.2, off=(-0.2, -0.35, 0.6), lead=(-0.1, -0.45, 0.5), spine=(0.1, 0, 0)),
            key(c.r(0.45, 0.65), off=(0.0, 0.85, 0.35), lead=(0.4, 0.2, -0.35), spine=(-0.25, 0.05,
                0.4), head=(-0.4, 0, 0),
                root=(0.02, -0.06, 0)),
            key(0.15, off=(-0.1, 0.0, 0.4), lead=(0.0, 0.95, 0.2), spine=(0.0, -0.15, -0.1), root=(0, 0.02, 0.06)),
            key(0.18, 0.2, lead=(-0.45, -0.5, 0.55), spine=(0.4, 0, -0.4), head=(0, 0, 0), off_foot=(0, 0, 0.1)),
            back(0.8),
        ]  # fmt: skip
    return keys


@keyframed("swim crawl", group=GROUP, parts=UPPER, counts=(2, 8), directions=("forward", "backward"))
def swim_crawl(c: Cue) -> list[KeyPose]:
    """The arms wheel in turn; backward is the backstroke."""
    lap, way = c.r(1.1, 1.9), -1 if c.step.direction == "backward" else 1
    lean = c.r(0.0, 0.6) * way if way > 0 else 0.0
    centre, high, far = np.array([0.2, 0.0, 0.05]), np.array([0.0, 0.85, 0.0]), np.array([-0.3, 0.0, 0.75]) * way
    keys = [key(0.6, lead=centre + high, off=centre - high, spine=(lean, 0, 0), head=(-0.5 * lean, 0, 0))]
    angle = np.arange(1, 8 * c.times(3, 6, lap) + 1) * np.pi / 4
    for a in angle:
        arm = np.cos(a) * high + np.sin(a) * far
        roll = 0.3 * float(np.cos(a))
        keys += [key(lap / 8, lead=centre + arm, off=centre - arm, spine=(lean, 0.1 * roll, -roll))]
    return [*keys, back(0.8)]


@keyframed("swim breaststroke", group=GROUP, parts=UPPER, counts=(2, 8))
def swim_breaststroke(c: Cue) -> list[KeyPose]:
    lap, lean = c.r(1.2, 1.9), c.r(0.0, 0.5)
    keys = [key(0.5, hands=(-0.28, -0.1, 0.4), spine=(lean, 0, 0), head=(-lean * 0.6, 0, 0))]
    for _ in range(c.times(2, 5, lap)):
        keys += [
            key(lap * 0.35, hands=(-0.25, 0.05, 0.93), spine=(lean, 0, 0)),
            key(lap * 0.35, hands=(0.6, -0.05, 0.6), spine=(lean - 0.1, 0, 0)),
            key(lap * 0.3, hands=(-0.25, -0.25, 0.38), spine=(lean - 0.2, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("row", group=GROUP, parts=UPPER, counts=(2, 8))
def row(c: Cue) -> list[KeyPose]:
    lap, keys = c.r(1.0, 1.8), [key(0.5, hands=(-0.15, -0.25, 0.6))]
    for _ in range(c.times(2, 6, lap)):
        keys += [
            key(lap * 0.25, hands=(-0.1, -0.15, 0.8), spine=(0.25, 0, 0)),
            key(lap * 0.25, hands=(-0.15, -0.3, 0.9), spine=(0.35, 0, 0)),
            key(lap * 0.25, hands=(-0.1, -0.3, 0.55), spine=(0.0, 0, 0)),
            key(lap * 0.25, hands=(0.0, -0.3, 0.28), spine=(-0.15, 0, 0)),
        ]
    return [*keys, back(0.7)]
