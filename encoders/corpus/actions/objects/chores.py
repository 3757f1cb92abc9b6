"""Work with tools: sweep, dig, hammer, chop, wipe, write."""

from __future__ import annotations

import numpy as np

from encoders.corpus.actions.objects.everyday import to_and_fro
from encoders.corpus.engine.curves import ARMS, Array
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, SIDED, UPPER, Cue, grip, keyframed, moved, orbit
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "object"


def _pole(across: float, low: float, ahead: float) -> dict[str, Array]:
    """Both hands on a long handle: the leading one below, the other above and nearer."""
    return {
        "lead": np.array([across - 0.3, low, ahead]),
        "off": np.array([-0.5 * across - 0.34, low + 0.38, max(ahead - 0.2, 0.28)]),
    }


def _strokes(
    name: str, low: float, side: tuple[float, float], fore: tuple[float, float], bend: float, lap: tuple[float, float]
) -> None:
    """Push and draw a long handle over the floor, `side` across and `fore` ahead (from, to)."""

    @keyframed(name, group=GROUP, sides=SIDED, counts=(2, 8), amplitudes=AMPLITUDES, weight=1.3)
    def stroke(c: Cue) -> list[KeyPose]:
        size, beat, lean = c.size(0.25), c.r(*lap), bend * c.r(0.6, 1.5)
        keys = [key(0.6, **_pole(side[0], low, fore[0]), spine=(lean, 0, 0), head=(0.2, 0, 0))]
        for _ in range(c.times(3, 6, 2 * beat)):
            turn = 0.35 * size * (side[1] - side[0])
            keys += [
                key(
                    beat,
                    **_pole(side[1] * size, low, fore[1]),
                    spine=(lean + 0.1, 0.05, turn),
                    root=(-0.03, -0.03, 0.03),
                ),
                key(beat, **_pole(side[0] * size, low, fore[0]), spine=(lean, 0, -turn), root=(0.02, -0.02, 0)),
            ]
            if c.chance(0.3):  # shifts along
                shift = c.r(-0.12, 0.12)
                keys += [key(0.25, lead_foot=(shift, 0, 0.1)), key(0.25, off_foot=(-shift, 0, 0.1))]
        return [*keys, back(0.9)]


_strokes("sweep", -0.6, (0.45, -0.25), (0.45, 0.5), 0.3, (0.4, 0.7))
_strokes("mop", -0.65, (0.4, -0.4), (0.3, 0.55), 0.35, (0.3, 0.55))
_strokes("vacuum", -0.65, (0.1, 0.0), (0.3, 0.8), 0.25, (0.6, 1.0))
_strokes("rake", -0.55, (0.15, 0.1), (0.85, 0.3), 0.4, (0.5, 0.8))


@keyframed("dig", group=GROUP, sides=SIDED, counts=(1, 5), weight=1.5)
def dig(c: Cue) -> list[KeyPose]:
    """Drive the spade in, bend, lift it and throw the earth aside."""
    keys: list[KeyPose] = [key(0.6, **_pole(0.1, -0.5, 0.5), lead_foot=(0, 0, -0.1), off_foot=(0, 0, 0.1))]
    for _ in range(c.times(2, 4, 2.2)):
        keys += [
            key(
                c.r(0.4, 0.6),
                0.1,
                **_pole(0.05, -0.85, 0.6),
                spine=(0.6, 0, 0),
                pelvis=(0.4, 0, 0),
                root=(0, -0.15, -0.05),
            ),
            key(c.r(0.4, 0.7), **_pole(0.1, -0.55, 0.6), spine=(0.2, 0, 0), pelvis=(0.1, 0, 0), root=(0, -0.05, 0)),
            key(c.r(0.25, 0.4), 0.1, **_pole(0.7, -0.3, 0.5), spine=(0.1, 0.1, 0.6)),
            key(c.r(0.4, 0.6), **_pole(0.1, -0.5, 0.5), spine=(0.2, 0, 0)),
        ]
    return [*keys, back(0.9)]


@keyframed("chop wood", group=GROUP, sides=SIDED, counts=(1, 5))
def chop_wood(c: Cue) -> list[KeyPose]:
    """An axe in both hands, up over the head and down between the feet."""
    keys = [key(0.6, 0.2, **grip(0.0, -0.6, 0.5, 0.06), feet=(0.08, 0, 0))]
    for _ in range(c.times(2, 4, 1.6)):
        keys += [
            key(c.r(0.5, 0.8), 0.1, **grip(0.05, 0.75, -0.1), spine=(-0.2, 0, 0), head=(-0.1, 0, 0)),
            key(0.16, **grip(0.0, 0.2, 0.75), spine=(0.2, 0, 0), root=(0, -0.08, -0.03)),
            key(
                0.14,
                c.r(0.2, 0.5),
                **grip(0.0, -0.7, 0.55),
                spine=(0.6, 0, 0),
                pelvis=(0.4, 0, 0),
                root=(0, -0.2, -0.1),
            ),
            key(0.4, **grip(0.0, -0.5, 0.5), spine=(0.2, 0, 0), pelvis=(0.1, 0, 0), root=(0, -0.05, 0)),
        ]
    return [*keys, back(0.8)]


@keyframed("hammer", group=GROUP, parts=UPPER, sides=SIDED, heights=("low", "middle", "high"), counts=(2, 8))
def hammer(c: Cue) -> list[KeyPose]:
    up = c.height(-0.55, -0.3, 0.1)
    hit = c.about((-0.25, up, 0.55), 0.04)
    nail = {"off": (-0.35, up - 0.05, 0.5)} if c.chance(0.7) else {}
    rise, beat = c.r(0.25, 0.45), c.r(0.22, 0.4)
    keys = [key(0.6, lead=moved(hit, 0.1, rise, -0.15), **nail, head=(0.2 - 0.3 * up, 0, 0), spine=(0.12, 0, 0))]
    for _ in range(c.times(3, 7, 1.5 * beat)):
        keys += [key(0.5 * beat, lead=hit), key(beat, lead=moved(hit, 0.1, rise * c.r(0.8, 1.2), -0.15))]
    return [*keys, back(0.7)]


@keyframed("saw", group=GROUP, parts=UPPER, sides=SIDED, counts=(3, 10))
def saw(c: Cue) -> list[KeyPose]:
    beat = c.r(0.25, 0.4)
    hold = {"off": (-0.25, -0.55, 0.5), "spine": (0.35, 0, 0), "head": (0.15, 0, 0)}
    there = c.about((-0.1, -0.55, 0.48), 0.04)
    return [*to_and_fro(c, "lead", there, (0.0, -0.08, 0.2), beat, 4, 9, **hold), back(0.8)]


@keyframed("chop food", group=GROUP, parts=ARMS, sides=SIDED, counts=(3, 12), precise=True)
def chop_food(c: Cue) -> list[KeyPose]:
    board = c.about((-0.2, -0.5, 0.5), 0.03)
    hold = {"off": (-0.3, -0.55, 0.5), "head": (0.35, 0, 0)}
    return [*to_and_fro(c, "lead", board, (0.0, 0.07, -0.02), c.r(0.12, 0.2), 5, 12, **hold), back(0.6)]


@keyframed("knead", group=GROUP, parts=UPPER, counts=(2, 8))
def knead(c: Cue) -> list[KeyPose]:
    beat = c.r(0.35, 0.55)
    keys = [key(0.6, hands=(-0.22, -0.45, 0.42), head=(0.3, 0, 0), spine=(0.1, 0, 0))]
    for _ in range(c.times(3, 6, 2 * beat)):
        keys += [
            key(beat, hands=(-0.22, -0.55, 0.65), spine=(0.35, 0, 0)),
            key(beat, hands=(-0.22, -0.42, 0.42), spine=(0.12, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("wipe window", group=GROUP, parts=UPPER, sides=HANDS, counts=(2, 8), amplitudes=AMPLITUDES, weight=1.5)
def wipe_window(c: Cue) -> list[KeyPose]:
    """Circles or strokes of a flat hand on an upright pane."""
    size, lap = c.size(0.25), c.r(0.7, 1.3)
    high = c.r(-0.3, 0.5)
    centre = c.about((0.05, high, 0.7), 0.05)
    across, up = np.array([0.25, 0, 0]) * size, np.array([0, 0.22, 0]) * size
    turns = c.times(3, 5, lap)
    if c.chance(0.6):
        move = orbit("hand", centre, across, up * (1 if c.chance(0.5) else -1), turns, lap)
    else:
        move = [
            k for _ in range(turns) for k in (key(lap / 2, hand=centre - across), key(lap / 2, hand=centre + across))
        ]
    lean = {"spine": (0.1, 0, 0), "head": (-0.1, 0, 0), "root": (0, min(high, 0.0) * c.r(0, 0.8), 0)}
    return [key(0.6, hand=centre + across, **lean), *move, back(0.7)]


@keyframed("wipe table", group=GROUP, parts=UPPER, sides=HANDS, counts=(2, 8), amplitudes=AMPLITUDES, weight=1.3)
def wipe_table(c: Cue) -> list[KeyPose]:
    size, lap = c.size(0.25), c.r(0.7, 1.3)
    centre = c.about((-0.1, -0.55, 0.6), 0.05)
    across, ahead = np.array([0.3, 0, 0]) * size, np.array([0, 0.02, 0.16]) * size
    move = orbit("hand", centre, across, ahead * (1 if c.chance(0.5) else -1), c.times(3, 5, lap), lap)
    lean = {"spine": (c.r(0.2, 0.5), 0, 0), "head": (0.15, 0, 0)}
    return [key(0.6, hand=centre + across, **lean), *move, back(0.7)]


@keyframed("paint wall", group=GROUP, parts=UPPER, sides=SIDED, counts=(2, 8))
def paint_wall(c: Cue) -> list[KeyPose]:
    """Long strokes of brush or roller up and down."""
    beat, x = c.r(0.45, 0.8), c.r(-0.2, 0.2)
    keys = [key(0.6, lead=(x, -0.3, 0.65), spine=(0.08, 0, 0))]
    for _ in range(c.times(2, 5, 2 * beat)):
        x = float(np.clip(x + c.r(-0.15, 0.2), -0.3, 0.35))
        keys += [
            key(beat, lead=(x, c.r(0.4, 0.7), 0.6), head=(-0.3, 0, 0)),
            key(beat, lead=(x, c.r(-0.45, -0.2), 0.65), head=(0.1, 0, 0)),
        ]
    return [*keys, back(0.7)]


def _scribble(name: str, place: tuple[float, float, float], reach: float, flat: bool) -> None:
    @keyframed(name, group=GROUP, parts=ARMS, sides=SIDED, precise=True)
    def scribble(c: Cue) -> list[KeyPose]:
        start = c.about(place, 0.04)
        rise = np.array([0.0, 0.0, 1.0]) if flat else np.array([0.0, 1.0, 0.0])
        pad = {"off": (-0.3, place[1] - 0.05, place[2] - 0.02)} if flat else {}
        keys = [key(0.7, lead=start, **pad, head=(0.35 if flat else -0.05, 0, 0))]
        count = c.times(10, 22, 0.2)
        for index in range(count):
            along = np.array([0.6 * reach * (2 * index / count - 1), 0, 0])
            keys += [key(c.r(0.12, 0.24), lead=start + along + rise * c.r(-0.4, 0.4) * reach)]
        return [*keys, back(0.7)]


_scribble("write", (-0.2, -0.45, 0.48), 0.12, True)
_scribble("write on board", (0.05, 0.2, 0.72), 0.32, False)


@keyframed("type", group=GROUP, parts=ARMS, precise=True)
def type_keys(c: Cue) -> list[KeyPose]:
    place = c.about((-0.22, -0.5, 0.5), 0.04)
    keys = [key(0.7, hands=place, head=(c.r(0.0, 0.3), 0, 0))]
    for index in range(c.times(12, 26, 0.15)):
        name = "lead" if index % 2 else "off"
        keys += [key(c.r(0.09, 0.18), **{name: moved(place, c.r(-0.06, 0.06), c.r(0.0, 0.05), c.r(-0.03, 0.03))})]
    return [*keys, back(0.6)]


@keyframed("fish", group=GROUP, parts=UPPER, sides=SIDED, counts=(1, 3))
def fish(c: Cue) -> list[KeyPose]:
    """Cast the line over the shoulder, wait, wind it in."""
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        keys += [
            key(0.5, **grip(0.05, -0.4, 0.5)),
            key(c.r(0.4, 0.6), 0.1, **grip(0.15, 0.45, 0.0), spine=(-0.15, 0, 0.2)),
            key(0.2, c.r(0.6, 1.5), **grip(0.0, -0.25, 0.75), spine=(0.15, 0, -0.1)),
            *orbit("off", (-0.3, -0.4, 0.5), (0.08, 0, 0), (0, 0.08, 0), int(c.r(3, 6)), 0.5),
            back(0.7),
        ]
    return keys


@keyframed("swat", group=GROUP, parts=UPPER, sides=HANDS, counts=(1, 6))
def swat(c: Cue) -> list[KeyPose]:
    """Strike at flies around the head."""
    keys: list[KeyPose] = []
    for _ in range(c.times(2, 5, 0.6)):
        start = c.about((c.r(-0.3, 0.4), c.r(0.0, 0.5), 0.5), 0.05)
        turn = c.r(-0.4, 0.4)
        keys += [
            key(c.r(0.2, 0.35), hand=moved(start, 0.25, 0.15, -0.1), head=(0, 0, turn)),
            key(c.r(0.1, 0.16), c.r(0.05, 0.3), hand=moved(start, -0.2, -0.15, 0.2), spine=(0.05, 0, 0.4 * turn)),
        ]
    return [*keys, back(0.6)]


@keyframed("use scissors", group=GROUP, parts=ARMS, sides=SIDED, counts=(2, 8), precise=True)
def use_scissors(c: Cue) -> list[KeyPose]:
    place, beat = c.about((-0.25, -0.3, 0.5), 0.04), c.r(0.2, 0.32)
    keys = [key(0.6, lead=place, off=moved(place, -0.1, 0.02, 0.05), head=(0.3, 0, 0))]
    for index in range(c.times(3, 6, 2 * beat)):
        keys += [
            key(beat, lead=moved(place, -0.02 * index, 0.02, 0.02 * index), lead_elbow=0.3),
            key(beat, lead=moved(place, -0.02 * index, -0.01, 0.02 * index), lead_elbow=0.0),
        ]
    return [*keys, back(0.6)]


@keyframed("shovel snow", group=GROUP, sides=SIDED, counts=(1, 4))
def shovel_snow(c: Cue) -> list[KeyPose]:
    """Push the shovel ahead with a step, lift and toss over the shoulder."""
    keys: list[KeyPose] = [key(0.5, **_pole(0.1, -0.6, 0.45))]
    for _ in range(c.times(1, 3)):
        keys += [
            key(
                0.6,
                **_pole(0.1, -0.8, 0.75),
                spine=(0.5, 0, 0),
                pelvis=(0.3, 0, 0),
                off_foot=(0, 0, 0.35),
                root=(0, -0.15, 0.2),
            ),
            key(0.4, **_pole(0.1, -0.5, 0.6), spine=(0.1, 0, 0), pelvis=(0.1, 0, 0), root=(0, -0.08, 0.12)),
            key(0.25, 0.1, **_pole(0.65, 0.15, 0.2), spine=(-0.1, 0.1, 0.6)),
            key(0.6, **_pole(0.1, -0.6, 0.45), spine=(0.1, 0, 0), off_foot=(0, 0, 0), root=(0, 0, 0)),
        ]
    return [*keys, back(0.8)]


@keyframed("iron", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(2, 8))
def iron(c: Cue) -> list[KeyPose]:
    return [
        *to_and_fro(
            c, "lead", c.about((0.0, -0.55, 0.55), 0.04), (0.25, 0.0, 0.05), c.r(0.4, 0.7), 3, 7, head=(0.3, 0, 0)
        ),
        back(0.7),
    ]
