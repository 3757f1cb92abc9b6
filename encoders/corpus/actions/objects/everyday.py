"""Everyday life: eating and drinking, washing, dressing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, MOUTH, ONE_ARM, SIDED, UPPER, Cue, keyframed, moved
from encoders.corpus.engine.keyframes import KeyPose, back, key

GROUP = "object"


def to_and_fro(
    c: Cue,
    channel: str,
    place: ArrayLike,
    stroke: Sequence[float],
    beat: float,
    low: int,
    high: int,
    **others: ArrayLike,
) -> list[KeyPose]:
    """Move a channel to a place and to and fro by plus and minus `stroke`; `others` are channels of the first pose."""
    place, half = np.asarray(place, np.float64), np.asarray(stroke, np.float64)
    keys = [key(c.r(0.5, 0.8), **{channel: place}, **others)]
    for _ in range(c.times(low, high, 2 * beat)):
        keys += [key(beat, **{channel: place + half}), key(beat, **{channel: place - half})]
    return keys


@keyframed("drink", group=GROUP, parts=ARMS, sides=HANDS, counts=(1, 4), weight=2)
def drink(c: Cue) -> list[KeyPose]:
    """Glass from the belly to the mouth, head and glass tilted back, down again."""
    hold, lips = c.about((-0.2, -0.4, 0.5), 0.05), c.about(MOUTH, 0.02)
    keys = [key(c.r(0.5, 0.8), c.r(0.1, 0.5), hand=hold, elbow=0.0)]
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.5, 0.9), 0.1, hand=lips, elbow=c.r(0.1, 0.4), head=(-0.1, 0, 0)),
            key(c.r(0.3, 0.5), c.r(0.4, 1.3), hand=moved(lips, 0, 0.07, 0), elbow=c.r(0.4, 0.9), head=(-0.4, 0, 0),
                spine=(-0.06, 0, 0)),
            key(c.r(0.5, 0.8), c.r(0.1, 0.5), hand=hold, elbow=0.0, head=(0, 0, 0)),
        ]  # fmt: skip
    return [*keys, back(0.6)]


@keyframed("eat", group=GROUP, parts=ARMS, sides=HANDS, counts=(1, 6), weight=1.5)
def eat(c: Cue) -> list[KeyPose]:
    plate, keys = c.about((-0.22, -0.48, 0.48), 0.04), list[KeyPose]()
    bowl = {"off": (-0.3, -0.38, 0.42)} if not c.both and c.chance(0.4) else {}
    keys = [key(0.6, 0.2, hand=plate, **bowl, head=(0.25, 0, 0))]
    for _ in range(c.times(2, 4, 1.5)):
        keys += [
            key(c.r(0.4, 0.7), c.r(0.1, 0.4), hand=c.about(MOUTH, 0.02), head=(0.1, 0, 0)),
            key(c.r(0.4, 0.7), c.r(0.1, 0.5), hand=c.about(plate, 0.03), head=(0.25, 0, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("pour", group=GROUP, parts=ARMS, sides=SIDED, counts=(1, 3), precise=True)
def pour(c: Cue) -> list[KeyPose]:
    cup, bottle = c.about((-0.32, -0.45, 0.5), 0.03), c.about((-0.05, -0.3, 0.5), 0.03)
    keys = [key(0.6, 0.2, lead=bottle, off=cup, head=(0.3, 0, 0))]
    for _ in range(c.times(1, 2)):
        keys += [
            key(0.5, c.r(0.6, 1.5), lead=moved(bottle, -0.2, 0.18, 0), lead_elbow=c.r(0.6, 1.1)),
            key(0.5, 0.2, lead=bottle, lead_elbow=0.0),
        ]
    return [*keys, back(0.7)]


@keyframed("unscrew cap", group=GROUP, parts=ARMS, sides=SIDED, counts=(2, 6), precise=True)
def unscrew_cap(c: Cue) -> list[KeyPose]:
    bottle, beat = c.about((-0.32, -0.4, 0.42), 0.03), c.r(0.18, 0.28)
    top = moved(bottle, 0.03, 0.12, 0)
    keys = [key(0.6, 0.1, off=bottle, lead=top, head=(0.25, 0, 0))]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [
            key(beat, lead=moved(top, 0.05, 0.01, -0.02), lead_elbow=0.5),
            key(beat, lead=top, lead_elbow=0.0),
        ]
    return [*keys, key(0.3, lead=moved(top, 0.25, 0.05, 0)), back(0.6)]


@keyframed("shake bottle", group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(3, 8))
def shake_bottle(c: Cue) -> list[KeyPose]:
    up = c.r(0.06, 0.15)
    return [
        *to_and_fro(c, "hand", c.about((-0.1, -0.2, 0.5), 0.06), (0, up, 0.4 * up), c.r(0.1, 0.16), 4, 10),
        back(0.6),
    ]


def _rubbed(
    name: str,
    spot: ArrayLike,
    stroke: Sequence[float],
    beat: tuple[float, float],
    *,
    elbow: float = 0.3,
    nod: float = 0.0,
) -> None:
    """Rub or brush a place on the body with one hand or both."""

    @keyframed(name, group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(2, 8), precise=True)
    def rubbed(c: Cue) -> list[KeyPose]:
        size = c.size(0.3)
        moves = [s * size for s in stroke]
        pose: dict[str, ArrayLike] = {"elbow": elbow * c.r(0.5, 1.5), "head": (nod, c.r(-0.1, 0.1), 0)}
        return [*to_and_fro(c, "hand", c.about(spot, 0.02), moves, c.r(*beat), 3, 8, **pose), back(0.6)]


_rubbed("brush teeth", (-0.2, 0.16, 0.33), (0.07, 0.0, -0.02), (0.1, 0.17))
_rubbed("brush hair", (-0.14, 0.38, 0.1), (0.03, 0.16, 0.1), (0.3, 0.5), elbow=0.6, nod=0.1)
_rubbed("wash hair", (-0.15, 0.45, 0.1), (0.05, 0.04, 0.08), (0.12, 0.2), elbow=0.6, nod=0.25)
_rubbed("wash face", (-0.24, 0.2, 0.31), (0.02, 0.08, 0.0), (0.16, 0.28), nod=0.3)
_rubbed("shave", (-0.2, 0.12, 0.28), (0.03, 0.07, 0.02), (0.25, 0.4))
_rubbed("rub belly", (-0.3, -0.55, 0.32), (0.1, 0.05, 0.0), (0.2, 0.35))
_rubbed("rub eyes", (-0.26, 0.25, 0.3), (0.03, 0.02, 0.0), (0.12, 0.2), nod=0.15)
_rubbed("scratch chest", (-0.25, -0.3, 0.28), (0.03, 0.07, 0.0), (0.1, 0.18))
_rubbed("scratch arm", (-0.75, -0.45, 0.35), (0.03, 0.12, 0.05), (0.14, 0.24))
_rubbed("pound chest", (-0.25, -0.22, 0.34), (0.04, 0.02, 0.12), (0.11, 0.18))
_rubbed("fan oneself", (-0.1, 0.0, 0.42), (0.12, 0.02, -0.05), (0.12, 0.2))


@keyframed("wash hands", group=GROUP, parts=ARMS, counts=(3, 8), precise=True)
def wash_hands(c: Cue) -> list[KeyPose]:
    place, beat = c.about((-0.27, -0.5, 0.5), 0.04), c.r(0.15, 0.28)
    keys = [key(0.6, hands=place, spine=(0.2, 0, 0), head=(0.3, 0, 0))]
    for _ in range(c.times(4, 8, 2 * beat)):
        slide = c.r(0.04, 0.09)
        keys += [
            key(beat, lead=moved(place, -0.04, slide, slide), off=moved(place, 0, -slide, -slide)),
            key(beat, lead=moved(place, 0, -slide, -slide), off=moved(place, -0.04, slide, slide)),
        ]
    return [*keys, back(0.7)]


@keyframed("wash body", group=GROUP, parts=UPPER, sides=SIDED, counts=(2, 6), precise=True)
def wash_body(c: Cue) -> list[KeyPose]:
    """The leading hand soaps the other arm, the chest and the neck."""
    spots = ((-0.75, -0.35, 0.4), (-0.7, -0.05, 0.3), (-0.3, -0.3, 0.3), (-0.2, 0.1, 0.2), (-0.3, -0.6, 0.32))
    keys = [key(0.5, off=(-0.1, -0.4, 0.55))]
    for _ in range(c.times(3, 5, 1.4)):
        spot = np.array(spots[int(c.rng.integers(len(spots)))])
        for sign in (1, -1, 1):
            keys += [key(c.r(0.2, 0.35), lead=spot + sign * np.array([0.04, 0.09, 0.03]))]
    return [*keys, back(0.7)]


@keyframed("tie shoe", group=GROUP, sides=SIDED, precise=True)
def tie_shoe(c: Cue) -> list[KeyPose]:
    """Kneel or bend to a foot and work at it with both hands."""
    kneel = {
        "root": (0, -0.45, -0.12), "off_foot": (0.02, 0.04, -0.4), "off_toes": -0.8, "spine": (0.75, 0, 0),
        "pelvis": (0.5, 0, 0.1), "head": (0.2, 0, 0),
    }  # fmt: skip
    fold = {"root": (0, -0.12, -0.16), "pelvis": (1.1, 0, 0), "spine": (0.9, 0, 0.1), "head": (0.1, 0, 0)}
    body = kneel if c.chance(0.6) else fold
    keys = [key(c.r(0.8, 1.1), 0.2, **body, lead_reach=(0.14, 0.16, 0.16), off_reach=(-0.06, 0.16, 0.16))]
    for _ in range(int(c.r(3, 7))):
        a, b = c.r(0.02, 0.08), c.r(0.0, 0.08)
        keys += [
            key(c.r(0.2, 0.35), lead_reach=(0.14 + a, 0.18 + b, 0.16), off_reach=(-0.06 + a, 0.18 + b, 0.16)),
            key(c.r(0.2, 0.35), lead_reach=(0.13, 0.15, 0.17), off_reach=(-0.07, 0.15, 0.17)),
        ]
    return [*keys, back(1.0)]


@keyframed("put on hat", group=GROUP, parts=ONE_ARM, sides=HANDS, precise=True)
def put_on_hat(c: Cue) -> list[KeyPose]:
    return [
        key(0.5, 0.1, hand=(-0.2, -0.3, 0.5)),
        key(c.r(0.6, 0.9), hand=(-0.16, 0.75, 0.2)),
        key(0.3, c.r(0.2, 0.6), hand=(-0.15, 0.5, 0.12), head=(0.12, 0, 0)),
        back(0.7),
    ]


@keyframed("take off hat", group=GROUP, parts=ONE_ARM, sides=HANDS, precise=True)
def take_off_hat(c: Cue) -> list[KeyPose]:
    return [
        key(c.r(0.5, 0.8), 0.15, hand=(-0.15, 0.5, 0.14)),
        key(0.3, hand=(-0.12, 0.75, 0.25)),
        key(
            c.r(0.5, 0.8), c.r(0.3, 0.9), hand=(-0.2, -0.35, 0.45), head=(c.r(0, 0.3), 0, 0), spine=(c.r(0, 0.25), 0, 0)
        ),
        back(0.6),
    ]


@keyframed("put on jacket", group=GROUP, parts=UPPER, sides=SIDED)
def put_on_jacket(c: Cue) -> list[KeyPose]:
    """One arm into its sleeve, then the other, then close it in front."""
    return [
        key(0.6, hands=(-0.2, -0.2, 0.5)),
        key(0.5, lead=(0.45, -0.55, -0.35), off=(-0.6, -0.05, 0.3), spine=(0.05, 0.1, 0.35)),
        key(0.4, lead=(0.55, 0.0, 0.55), off=(-0.75, 0.05, 0.28), spine=(0, 0, 0)),
        key(0.5, lead=(0.05, 0.12, 0.25), off=(0.4, -0.55, -0.4), spine=(0.05, -0.1, -0.4)),
        key(0.4, off=(0.5, -0.05, 0.6), spine=(0, 0, 0)),
        key(0.5, 0.2, hands=(-0.2, -0.15, 0.35)),
        key(0.4, hands=(-0.22, -0.5, 0.32)),
        back(0.6),
    ]


@keyframed("take off jacket", group=GROUP, parts=UPPER, sides=SIDED)
def take_off_jacket(c: Cue) -> list[KeyPose]:
    return [
        key(0.6, hands=(-0.22, -0.15, 0.32)),
        key(0.4, hands=(0.2, -0.05, 0.15), shrugs=0.25),
        key(0.5, lead=(0.3, -0.65, -0.45), off=(0.25, -0.6, -0.42), shrugs=-0.05, spine=(-0.1, 0, 0)),
        key(0.4, lead=(0.05, -0.55, -0.4), off=(-0.3, -0.65, -0.3), spine=(0.05, 0, 0.25)),
        key(0.5, 0.2, lead=(0.2, -0.4, 0.55), off=(0.1, -0.7, 0.1), spine=(0, 0, 0)),
        back(0.6),
    ]


@keyframed("take off shirt", group=GROUP, parts=UPPER)
def take_off_shirt(c: Cue) -> list[KeyPose]:
    return [
        key(0.6, 0.1, lead=(-0.6, -0.65, 0.33), off=(-0.58, -0.68, 0.36), spine=(0.15, 0, 0), head=(0.2, 0, 0)),
        key(0.6, lead=(-0.35, 0.3, 0.35), off=(-0.35, 0.28, 0.38), elbows=0.8, spine=(0.2, 0, 0)),
        key(0.4, 0.1, hands=(0.0, 0.92, 0.15), spine=(-0.1, 0, 0), elbows=0.0),
        key(0.5, hands=(-0.2, -0.3, 0.5)),
        back(0.6),
    ]


@keyframed("zip up", group=GROUP, parts=ARMS, sides=SIDED, precise=True)
def zip_up(c: Cue) -> list[KeyPose]:
    return [
        key(0.6, c.r(0.2, 0.6), lead=(-0.3, -0.72, 0.33), off=(-0.34, -0.76, 0.33), head=(0.35, 0, 0)),
        key(c.r(0.5, 0.9), 0.1, lead=(-0.33, -0.02, 0.3), head=(0, 0, 0)),
        back(0.6),
    ]


@keyframed("smoke", group=GROUP, parts=ARMS, sides=SIDED, counts=(1, 4), precise=True)
def smoke(c: Cue) -> list[KeyPose]:
    rest = c.about((0.0, -0.6, 0.4), 0.08)
    keys = [key(0.5, 0.2, lead=rest)]
    for _ in range(c.times(1, 3)):
        keys += [
            key(c.r(0.5, 0.8), c.r(0.4, 1.0), lead=(-0.24, 0.13, 0.32), lead_elbow=0.2),
            key(c.r(0.5, 0.8), c.r(0.4, 1.2), lead=rest, lead_elbow=0.0, head=(-0.2, 0, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("fold clothes", group=GROUP, parts=UPPER, counts=(1, 4))
def fold_clothes(c: Cue) -> list[KeyPose]:
    """Hold a cloth out, bring the hands together, smooth it down."""
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 3)):
        keys += [
            key(c.r(0.4, 0.7), 0.1, hands=(0.15, -0.2, 0.6)),
            key(c.r(0.4, 0.6), hands=(-0.28, -0.2, 0.55)),
            key(c.r(0.3, 0.5), hands=(-0.2, -0.52, 0.5), spine=(0.15, 0, 0), head=(0.25, 0, 0)),
            key(c.r(0.3, 0.5), lead=(0.15, -0.55, 0.5), spine=(0.2, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("shake off hands", group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(2, 8))
def shake_off_hands(c: Cue) -> list[KeyPose]:
    place = c.about((c.r(-0.1, 0.2), c.r(-0.65, -0.35), 0.45), 0.04)
    return [*to_and_fro(c, "hand", place, (0.03, 0.09, 0.03), c.r(0.09, 0.14), 4, 10), back(0.5)]


@keyframed("water plants", group=GROUP, parts=UPPER, sides=SIDED, precise=True)
def water_plants(c: Cue) -> list[KeyPose]:
    """A can in one hand, tipped and moved along."""
    keys = [key(0.6, 0.2, lead=(-0.05, -0.5, 0.45))]
    for _ in range(c.times(2, 4, 1.6)):
        x = c.r(-0.4, 0.5)
        keys += [
            key(
                0.5,
                c.r(0.4, 0.9),
                lead=(x, -0.25, 0.65),
                lead_elbow=0.6,
                spine=(0.15, 0, 0.3 * x),
                head=(0.3, 0, 0.4 * x),
            ),
            key(0.4, lead=(0.5 * x, -0.38, 0.55), lead_elbow=0.2),
        ]
    return [*keys, back(0.7)]
