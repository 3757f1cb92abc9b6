"""Warm-up drills: elbow to knee, side lunges, hurdle steps, tiptoes, exercises on the back, arms behind the back."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, SIDED, UPPER, Cue, keyframed
from encoders.corpus.engine.keyframes import REST, KeyPose, back, key

GROUP = "exercise"
Pose = dict[str, ArrayLike]


_AKIMBO: Pose = {"hands": (0.0, -0.68, 0.05), "elbows": 0.8}


def _one_of(c: Cue, *poses: Pose) -> Pose:
    return poses[int(c.rng.integers(len(poses)))]


def _turns(c: Cue, low: int, high: int, period: float) -> list[tuple[str, str, float]]:
    """For each repetition the acting limb's prefix, the other's, and 1 or -1: in turn where both sides act."""
    names = (("lead", "off", 1.0), ("off", "lead", -1.0))
    return [names[index % 2 if c.both else 0] for index in range(c.times(low, high, period))]


@keyframed("elbow to knee", group=GROUP, sides=HANDS, counts=(1, 8), weight=1.5)
def elbow_to_knee(c: Cue) -> list[KeyPose]:
    """Stand and bring the knee of the named side up to the other elbow, the trunk twisting; both: in turn."""
    beat, high = c.r(0.4, 0.75), c.r(0.5, 0.6)
    behind = c.chance(0.65)
    ready: Pose = (
        {"hands": (-0.12, 0.42, 0.03), "elbows": 0.7} if behind else {"hands": (0.1, -0.05, 0.3), "elbows": 0.3}
    )
    keys = [key(c.r(0.4, 0.7), c.r(0.0, 0.3), **ready)]
    for knee, elbow, way in _turns(c, 2, 6, 2 * beat):
        crossed: Pose = (
            {elbow: (-0.15, 0.3, 0.2), f"{elbow}_elbow": -0.7}
            if behind
            else {elbow: (-0.2, 0.1, 0.3), knee: (0.15, -0.3, -0.2)}
        )
        keys += [
            key(beat, c.r(0.0, 0.2), **{f"{knee}_foot": (-0.16, high, 0.12)}, root=(-0.08 * way, -0.06, 0.0), **crossed,
                spine=(c.r(0.75, 0.95), -0.15 * way, 0.85 * way), pelvis=(0.25, 0, 0.2 * way), head=(-0.1, 0, 0)),
            key(beat, **{f"{knee}_foot": (0, 0, 0)}, **ready, root=(0, 0, 0), spine=(0, 0, 0), pelvis=(0, 0, 0)),
        ]  # fmt: skip
    return [*keys, back(0.6)]


@keyframed("side lunges", group=GROUP, counts=(2, 8), weight=1.2)
def side_lunges(c: Cue) -> list[KeyPose]:
    """Deep over one bent knee, the other leg long, and over to the other side; legs wide throughout or stepped out."""
    beat, wide, deep = c.r(0.6, 1.1), c.r(0.3, 0.42), c.r(0.22, 0.42)
    ahead: list[Pose] = [{"hands": (-0.25, -0.3, 0.42)}, {"hands": (-0.1, -0.05, 0.9)}, {"hands": (-0.05, -0.8, 0.35)}]
    arms = _one_of(c, _AKIMBO, *ahead)
    stays = c.chance(0.5)
    keys = [key(0.5, feet=(wide, 0, 0), root=(0, -0.08, 0)), key(0.4, **arms)] if stays else []
    for index in range(c.times(2, 6, 2 * beat if not stays else beat)):
        foot, way = ("lead_foot", 1.0) if index % 2 == 0 else ("off_foot", -1.0)
        far = wide if stays else 1.6 * wide
        over = (far * 0.85 if stays else far * 0.75) * way
        low: Pose = {"root": (over, -deep, -0.1), "pelvis": (0.3, 0, 0), "spine": (c.r(0.15, 0.4), 0, 0)}
        feet: Pose = {} if stays else {foot: (far, 0, 0)}
        keys += [key(beat, c.r(0.05, 0.5), **low, **feet, **arms)]
        if not stays:
            keys += [key(0.8 * beat, **{foot: (0, 0, 0)}, root=(0, 0, 0), pelvis=(0, 0, 0), spine=(0, 0, 0))]
    return [*keys, back(1.0)]


@keyframed("hurdle step", group=GROUP, sides=HANDS, directions=("forward", "backward"), counts=(1, 6), weight=1.2)
def hurdle_step(c: Cue) -> list[KeyPose]:
    """On the spot: the knee high, the leg round the outside or straight over an imagined hurdle, down, and back."""
    beat, high, out = c.r(0.4, 0.7), c.r(0.42, 0.58), c.chance(0.6)
    back_first = c.step.direction == "backward"
    arms = _one_of(c, _AKIMBO, {"hands": (0.6, -0.5, 0.15)}, {})
    front, side = (-0.02, high, 0.15), (0.3, high, -0.05) if out else (0.04, high, -0.1)
    keys = [key(0.4, **arms)] if arms else []
    for foot, _, way in _turns(c, 2, 4, 4 * beat):
        places = [(front, 0.0), (side, 0.9 if out else 0.2)]
        first, last, down = (
            {f"{foot}_foot": place, f"{foot}_knee": knee}
            for place, knee in [*(reversed(places) if back_first else places), ((0, 0, 0), 0.0)]
        )
        shift: Pose = {"root": (-0.09 * way, 0, 0)}
        keys += [
            key(beat, **shift, **first, pelvis=(-0.05, -0.08 * way, 0)),
            key(beat, c.r(0.0, 0.2), **shift, **last),
            key(beat, **down, root=(0, 0, 0), pelvis=(0, 0, 0)),
        ]
    return [*keys, back(0.5)]


_TOES: Pose = {"feet": (0, 0.075, 0.02), "lead_toes": -0.45, "off_toes": -0.45}
_SOLES: Pose = {"feet": (0, 0, 0), "lead_toes": 0.0, "off_toes": 0.0}


def _free_arms(c: Cue) -> Pose:
    """Arms that help to balance, or not."""
    away: list[Pose] = [{"hands": (0.8, -0.3, 0.1)}, {"hands": (-0.1, -0.1, 0.9)}, {"hands": (-0.1, 0.92, 0.1)}]
    return _one_of(c, {"hands": REST}, _AKIMBO, *away)


@keyframed("heel raise", group=GROUP, counts=(1, 8), weight=1.2)
def heel_raise(c: Cue) -> list[KeyPose]:
    """Up on the toes with straight knees, held or up and down."""
    arms, beat = _free_arms(c), c.r(0.35, 0.7)
    held = not c.step.count and c.chance(0.5)
    keys = [key(0.4, **arms)]
    for _ in range(1 if held else c.times(2, 5, 2 * beat)):
        keys += [
            key(
                beat,
                c.r(1.0, 3.0) if held else c.r(0.0, 0.3),
                **_TOES,
                **arms,
                root=(0, 0.07, 0.03),
                spine=(-0.04, 0, 0),
            ),
            key(beat, **_SOLES, root=(0, 0, 0), spine=(0, 0, 0)),
        ]
    return [*keys, back(0.5)]


@keyframed("tiptoes with bent knees", group=GROUP, counts=(1, 6))
def tiptoes_with_bent_knees(c: Cue) -> list[KeyPose]:
    """On the toes with bent knees, held with small sways, or sinking and rising on the toes."""
    arms, beat, deep = _free_arms(c), c.r(0.5, 0.9), c.r(0.15, 0.42)
    low: Pose = {"root": (0, 0.07 - deep, 0.02), "pelvis": (0.25 * deep, 0, 0), "spine": (c.r(0.0, 0.25), 0, 0)}
    keys = [key(c.r(0.4, 0.7), **arms, **_TOES, root=(0, 0.06, 0.03))] if c.chance(0.5) else [key(0.3, **arms)]
    if c.step.count or c.chance(0.4):
        for _ in range(c.times(2, 4, 2 * beat)):
            keys += [
                key(beat, c.r(0.0, 0.3), **_TOES, **low),
                key(beat, **_TOES, root=(0, 0.06, 0.03), spine=(0, 0, 0)),
            ]
    else:
        keys += [key(beat, c.r(0.5, 1.2), **_TOES, **low)]
        for _ in range(int(c.rng.integers(1, 4))):
            keys += [
                key(c.r(0.4, 0.8), c.r(0.1, 0.5), root=(c.r(-0.03, 0.03), 0.07 - deep * c.r(0.8, 1.1), c.r(0.0, 0.04)))
            ]
    return [*keys, key(0.5, **_SOLES, root=(0, -0.05, 0)), back(0.6)]


_ON_THE_BACK: Pose = {"root": (0, -0.78, 0.0), "pelvis": (-1.5, 0, 0), "spine": (0, 0, 0), "head": (0.05, 0, 0)}


@keyframed("lying leg raise", group=GROUP, sides=HANDS, counts=(1, 8), styled=False, starts="floor", ends="floor")
def lying_leg_raise(c: Cue) -> list[KeyPose]:
    """On the back, straight legs rise towards the vertical and sink: one, or both together."""
    beat, rise = c.r(0.6, 1.1), c.r(0.9, 1.5)
    flat, half, up = (np.array([0.0, 0.95 * np.sin(a), 0.1 + 0.95 * np.cos(a)]) for a in (0.03, 0.5 * rise, rise))
    arms: Pose = {"hands": (0.25, -0.9, 0.0)} if c.chance(0.6) else {"hands": (-0.1, 0.42, 0.05), "elbows": 0.6}
    foot = "feet" if c.both else "lead_foot"
    toes = ("lead_toes", "off_toes")
    keys = [key(0.0, 0.4, **_ON_THE_BACK, **arms, feet=flat, **dict.fromkeys(toes, 0.9))]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [
            key(beat / 2, **{foot: half}),
            key(beat / 2, c.r(0.0, 0.5), **{foot: up}),
            key(beat / 2, **{foot: half}),
            key(beat / 2, c.r(0.0, 0.3), **{foot: flat}),
        ]
    return keys


@keyframed("bicycle crunch", group=GROUP, counts=(2, 10), styled=False, starts="floor", ends="floor")
def bicycle_crunch(c: Cue) -> list[KeyPose]:
    """On the back with the shoulders raised, knees drawn in by turns to the opposite elbow as if cycling."""
    beat = c.r(0.4, 0.75)
    drawn, long = (-0.06, 0.42, 0.2), (0.0, 0.25, 0.95)
    arms: Pose = {"hands": (-0.12, 0.42, 0.05), "elbows": 0.6}
    ready: Pose = {**_ON_THE_BACK, "spine": (0.7, 0, 0), "head": (0.2, 0, 0)}
    keys = [key(0.0, 0.2, **_ON_THE_BACK, feet=(0.03, 0.0, 0.55), **arms), key(0.6, **ready, feet=(0, 0.2, 0.4))]
    for index in range(c.times(3, 8, beat)):
        near, far, way = ("lead_foot", "off_foot", 1.0) if index % 2 == 0 else ("off_foot", "lead_foot", -1.0)
        keys += [key(beat, c.r(0.0, 0.1), **{near: drawn, far: long}, spine=(0.85, 0, 0.6 * way))]
    return [*keys, key(0.7, **_ON_THE_BACK, feet=(0.03, 0.0, 0.55))]


@keyframed("arms behind back", group=GROUP, parts=UPPER, counts=(1, 6), weight=1.2)
def arms_behind_back(c: Cue) -> list[KeyPose]:
    """Swing or draw both arms behind the body; hands clasped there may be pulled up and away, the chest opened."""
    keys: list[KeyPose] = []
    if c.chance(0.5):
        beat, far = c.r(0.35, 0.7), c.r(0.55, 0.75)
        for _ in range(c.times(2, 5, 2 * beat)):
            front = (c.r(-0.1, 0.4), -0.2, 0.85) if c.chance(0.5) else (0.9, -0.1, 0.1)
            keys += [key(beat, hands=front), key(beat, 0.05, hands=(0.2, -0.7, -far), spine=(-0.08, 0, 0))]
        return [*keys, back(0.5)]
    for _ in range(c.times(1, 2)):
        up = c.r(-0.75, -0.45)
        keys += [
            key(0.4, hands=(0.15, -0.85, -0.3)),
            key(c.r(0.4, 0.7), 0.1, hands=(-0.28, -0.78, -0.38)),
            key(
                c.r(0.5, 0.9),
                c.r(0.6, 2.0),
                hands=(-0.28, up, -0.68),
                spine=(c.r(-0.15, 0.3), 0, 0),
                head=(-0.15, 0, 0),
            ),
            key(0.5, hands=(0.12, -0.85, -0.25), spine=(0, 0, 0), head=(0, 0, 0)),
        ]
    return [*keys, back(0.5)]


@keyframed("reach behind back", group=GROUP, parts=ARMS, sides=SIDED, precise=True)
def reach_behind_back(c: Cue) -> list[KeyPose]:
    """The named hand over its shoulder and down the spine, the other up the back from below to meet it."""
    over: Pose = {"lead": (-0.3, 0.08, -0.26), "lead_elbow": 0.5}
    under: Pose = {"off": (-0.28, -0.3, -0.34)} if c.chance(0.75) else {}
    return [
        key(c.r(0.4, 0.6), lead=(0.15, 0.75, 0.05), off=(0.15, -0.85, -0.25) if under else REST),
        key(c.r(0.4, 0.7), c.r(0.8, 2.5), **over, **under),
        key(c.r(0.4, 0.6), lead=(0.15, 0.7, 0.1), lead_elbow=0.0, off=(0.15, -0.85, -0.2) if under else REST),
        back(0.6),
    ]


@keyframed("touch elbow", group="gesture", parts=ARMS, sides=SIDED, counts=(1, 4), precise=True)
def touch_elbow(c: Cue) -> list[KeyPose]:
    """The named hand across the body to the other elbow, which hangs or is bent."""
    bent = c.chance(0.5)
    other: Pose = {"off": (-0.05, -0.45, 0.45)} if bent else {}
    spot = (-0.72, -0.5, 0.2) if bent else (-0.7, -0.5, 0.17)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.5, 0.8), c.r(0.3, 1.2), lead=c.about(spot, 0.02), **other), back(c.r(0.5, 0.7))]
    return keys


@keyframed("touch heel", group=GROUP, sides=HANDS, directions=("forward", "backward"), counts=(1, 8))
def touch_heel(c: Cue) -> list[KeyPose]:
    """The foot of the named side raised inward before or behind the body, where the other hand touches it."""
    beat = c.r(0.35, 0.6)
    ahead = c.step.direction != "backward" if c.step.direction else c.chance(0.5)
    keys: list[KeyPose] = []
    for foot, hand, way in _turns(c, 2, 6, 2 * beat):
        if ahead:
            place, knee, reach = (-0.2, c.r(0.48, 0.58), 0.24), 0.9, (0.12, 0.6, 0.26)
            trunk = (c.r(0.35, 0.55), 0.0, 0.2 * way)
        else:
            place, knee, reach = (-0.14, c.r(0.42, 0.52), -0.34), 0.2, (0.1, 0.55, -0.34)
            trunk = (c.r(0.05, 0.2), -0.3 * way, -0.4 * way)
        up: Pose = {f"{foot}_foot": place, f"{foot}_knee": knee, f"{hand}_reach": reach, foot: (0.5, -0.4, 0.1)}
        down: Pose = {f"{foot}_foot": (0, 0, 0), f"{foot}_knee": 0.0, "hands": (0.2, -0.85, 0.15)}
        keys += [
            key(beat, c.r(0.0, 0.2), **up, spine=trunk, root=(-0.08 * way, -0.04, 0)),
            key(beat, **down, spine=(0, 0, 0), root=(0, 0, 0)),
        ]
    return [*keys, back(0.5)]


@keyframed("touch opposite knee", group="gesture", sides=SIDED, counts=(1, 6))
def touch_opposite_knee(c: Cue) -> list[KeyPose]:
    """The named hand to the knee of the other leg: bent down to it, or with the knee raised."""
    raised, beat = c.chance(0.5), c.r(0.45, 0.8)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 3, 2 * beat)):
        low: Pose = (
            {
                "off_foot": (-0.04, 0.42, 0.1),
                "root": (0.08, -0.02, 0),
                "lead_reach": (-0.15, 0.88, 0.36),
                "spine": (0.3, 0, -0.3),
            }
            if raised
            else {
                "lead_reach": (-0.12, 0.5, 0.14),
                "spine": (0.55, 0, -0.3),
                "pelvis": (0.4, 0, 0),
                "root": (0, -0.08, -0.1),
            }
        )
        keys += [key(beat, c.r(0.1, 0.7), **low), back(beat)]
    return keys
