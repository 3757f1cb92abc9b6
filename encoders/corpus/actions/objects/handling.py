"""Handling of imaginary objects: pick up, put down, carry, push, pull, reach."""

from __future__ import annotations

from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, SIDED, UPPER, Cue, keyframed
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import HEIGHTS

GROUP = "object"


HELD = (-0.22, -0.42, 0.45)  #: both hands on a box before the belly


def _down(c: Cue) -> dict[str, ArrayLike]:
    """The body when reaching to the floor: bent, squatting, or on a knee."""
    kind = c.rng.random()
    if kind < 0.45:
        return {
            "root": (0, -0.1, -0.13),
            "pelvis": (c.r(0.7, 1.0), 0, 0),
            "spine": (c.r(0.5, 0.9), 0, 0),
            "head": (0.1, 0, 0),
        }
    if kind < 0.8:
        deep = -c.r(0.42, 0.55)
        return {"root": (0, deep, -0.12), "pelvis": (0.6, 0, 0), "spine": (c.r(0.6, 0.9), 0, 0), "head": (-0.1, 0, 0)}
    return {
        "root": (0, -0.45, -0.1), "lead_foot": (0.02, 0.04, -0.35), "lead_toes": -0.8, "spine": (0.8, 0, 0),
        "pelvis": (0.5, 0, 0), "head": (0.05, 0, 0),
    }  # fmt: skip


def _at(c: Cue, level: str) -> tuple[dict[str, ArrayLike], dict[str, ArrayLike]]:
    """Body and hands for reaching something at a level; one hand or both by the step's side, both by default."""
    two = c.both or (not c.step.side and c.chance(0.5))
    ahead, out = c.r(0.35, 0.55), c.r(0.08, 0.17) if two else c.r(-0.05, 0.2)
    height = {"low": c.r(0.08, 0.25), "middle": c.r(0.75, 0.95), "high": c.r(1.6, 1.8)}[level]
    if level == "low":
        body = _down(c)
    elif level == "middle":
        body = {"spine": (c.r(0.15, 0.4), 0, 0), "pelvis": (0.15, 0, 0), "head": (0.2, 0, 0), "root": (0, -0.01, 0.0)}
    else:
        body = {"spine": (-0.1, 0, 0), "head": (-0.4, 0, 0), "root": (0, 0.02, 0.03)}
    name = "reaches" if two else "lead_reach"
    return body, {name: (out, height, ahead if level != "high" else c.r(0.2, 0.4))}


def _level(c: Cue) -> str:
    return c.step.height or ("low", "low", "middle")[int(c.rng.integers(3))]


@keyframed("pick up", group=GROUP, sides=HANDS, heights=HEIGHTS, counts=(1, 3), weight=3)
def pick_up(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        body, hands = _at(c, _level(c))
        hand = "hands" if "reaches" in hands else "lead"
        keys += [
            key(c.r(0.7, 1.1), c.r(0.15, 0.5), **body, **hands),
            key(c.r(0.6, 1.0), c.r(0.1, 0.8), **{hand: c.about(HELD, 0.05)}, root=(0, 0, 0), spine=(-0.03, 0, 0),
                pelvis=(0, 0, 0), head=(0.1, 0, 0), lead_foot=(0, 0, 0), lead_toes=0.0),
        ]  # fmt: skip
        keys += [back(c.r(0.5, 0.8))]
    return keys if c.chance(0.5) else keys[:-1]


@keyframed("put down", group=GROUP, sides=HANDS, heights=HEIGHTS, weight=2)
def put_down(c: Cue) -> list[KeyPose]:
    body, hands = _at(c, _level(c))
    hand = "hands" if "reaches" in hands else "lead"
    return [
        key(0.0, c.r(0.2, 0.8), **{hand: c.about(HELD, 0.05)}),
        key(c.r(0.7, 1.1), c.r(0.15, 0.5), **body, **hands),
        back(c.r(0.7, 1.1)),
    ]


@keyframed("move object", group=GROUP, sides=HANDS, directions=SIDED, heights=HEIGHTS, counts=(1, 3), weight=2)
def move_object(c: Cue) -> list[KeyPose]:
    """Take something on one side and put it down on the other; the direction is that of the target."""
    way = c.toward or 1.0
    two = c.both or not c.step.side
    up = {"low": -0.6, "middle": -0.4, "high": 0.1}.get(c.step.height, -0.4)
    out, ahead = c.r(0.4, 0.65), c.r(0.5, 0.65)

    def hold(x: float, y: float) -> dict[str, ArrayLike]:
        one: dict[str, ArrayLike] = {"lead": (x - 0.25, y, ahead)}
        return one | {"off": (-x - 0.25, y, ahead)} if two else one

    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        keys += [
            key(c.r(0.6, 0.9), 0.2, **hold(-way * out, up), spine=(0.2, 0, -0.5 * way), head=(0.2, 0, -0.4 * way)),
            key(c.r(0.4, 0.6), **hold(0.0, up + 0.2), spine=(0.05, 0, 0)),
            key(c.r(0.4, 0.6), 0.2, **hold(way * out, up), spine=(0.2, 0, 0.5 * way), head=(0.2, 0, 0.4 * way)),
        ]
        keys += [back(0.7)]
    return keys


@keyframed("lift", group=GROUP, heights=("middle", "high"), counts=(1, 3), weight=1.5)
def lift(c: Cue) -> list[KeyPose]:
    """Something heavy, from the floor to the waist or over the head."""
    high = c.step.height == "high" or (not c.step.height and c.chance(0.4))
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        squat = {
            "root": (0, -c.r(0.3, 0.45), -0.12),
            "pelvis": (0.6, 0, 0),
            "spine": (0.35, 0, 0),
            "head": (-0.2, 0, 0),
        }
        up = {"root": (0, 0, 0), "pelvis": (0, 0, 0), "spine": (-0.1, 0, 0), "head": (0, 0, 0)}
        keys += [
            key(c.r(0.7, 1.0), 0.3, **squat, reaches=(c.r(0.1, 0.25), 0.25, 0.35)),
            key(c.r(0.8, 1.3), 0.2, **up, hands=(-0.2, -0.5, 0.4)),
        ]
        if high:
            keys += [
                key(0.5, 0.1, hands=(-0.15, 0.05, 0.3), root=(0, -0.05, 0)),
                key(c.r(0.5, 0.9), c.r(0.5, 1.2), hands=(0.0, 0.95, 0.1), root=(0, 0.01, 0)),
                key(0.6, hands=(-0.15, 0.0, 0.3)),
            ]
        keys += [key(c.r(0.8, 1.1), 0.1, **squat, reaches=(0.15, 0.25, 0.35)), back(0.8)]
    return keys if c.chance(0.4) else keys[:-2]


def _held(name: str, places: dict[str, ArrayLike], sides: tuple[str, ...] = (), weight: float = 1.0) -> None:
    """Hold something, compatible with standing or walking."""
    parts = ONE_ARM if sides else ARMS

    @keyframed(name, group=GROUP, parts=parts, sides=sides, weight=weight)
    def held(c: Cue) -> list[KeyPose]:
        shaken = {part: c.about(place, 0.07) for part, place in places.items()}
        keys = [key(c.r(0.5, 0.9), c.r(1.2, 3.0), **shaken, spine=(c.r(-0.12, 0.02), 0, 0))]
        return [*keys, back(0.7)] if c.chance(0.6) else keys


_held("carry", {"hands": (-0.2, -0.4, 0.48)}, weight=3)
_held("carry on shoulder", {"hand": (-0.12, 0.12, 0.15)}, SIDED)
_held("carry on head", {"hand": (-0.1, 0.58, 0.08)}, HANDS)
_held("push cart", {"hands": (-0.1, -0.32, 0.72)})
_held("drag behind", {"hand": (0.05, -0.75, -0.5)}, HANDS)
_held("hold umbrella", {"hand": (-0.15, -0.1, 0.4)}, SIDED)
_held("read book", {"hands": (-0.22, -0.15, 0.48)})
_held("hold handrail", {"hand": (0.3, -0.4, 0.55)}, HANDS)
_held("use binoculars", {"hands": (-0.25, 0.24, 0.3), "elbows": 0.8})
_held("take photo", {"hands": (-0.2, 0.2, 0.45), "elbows": 0.2})


@keyframed("push", group=GROUP, sides=HANDS, heights=HEIGHTS, counts=(1, 3), weight=2)
def push(c: Cue) -> list[KeyPose]:
    up, deep = c.height(-0.45, -0.15, 0.15), c.r(0.2, 0.5)
    hand, keys = "hand" if c.step.side else "hands", list[KeyPose]()
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.4, 0.6), c.r(0.1, 0.3), **{hand: (-0.12, up - 0.05, 0.42)}, off_foot=(0, 0, deep),
                root=(0, -0.05, 0.1)),
            key(c.r(0.5, 1.1), c.r(0.2, 0.8), **{hand: (-0.15, up, 0.93)}, root=(0, -0.08 - 0.15 * deep, deep * 0.8),
                spine=(c.r(0.1, 0.3), 0, 0), pelvis=(0.2, 0, 0), head=(-0.2, 0, 0)),
            key(0.5, **{hand: (-0.1, up - 0.05, 0.5)}, spine=(0, 0, 0), pelvis=(0, 0, 0), root=(0, -0.03, 0.1)),
        ]  # fmt: skip
    return [*keys, back(c.r(0.6, 0.9))]


@keyframed("pull", group=GROUP, sides=HANDS, heights=HEIGHTS, counts=(1, 4), weight=2)
def pull(c: Cue) -> list[KeyPose]:
    up, deep = c.height(-0.55, -0.25, 0.1), c.r(0.15, 0.4)
    hand, keys = "hand" if c.step.side else "hands", list[KeyPose]()
    for _ in range(c.times(1, 3)):
        keys += [
            key(c.r(0.4, 0.6), c.r(0.1, 0.2), **{hand: (-0.2, up, 0.92)}, spine=(0.2, 0, 0), root=(0, -0.03, 0.05)),
            key(c.r(0.4, 0.8), c.r(0.1, 0.4), **{hand: (-0.05, up, 0.25)}, spine=(-0.2, 0, 0), root=(0,
                -0.08, -0.5 * deep),
                lead_foot=(0.02, 0, -deep)),
        ]  # fmt: skip
    return [*keys, back(c.r(0.6, 0.9))]


@keyframed("reach", group=GROUP, parts=UPPER, sides=HANDS, directions=("up", "forward", "left", "right"), counts=(1, 4))
def reach(c: Cue) -> list[KeyPose]:
    """Stretch out for something, up by default, often on the toes."""
    direction = c.step.direction or "up"
    place = {"up": (-0.05, 0.97, 0.2), "forward": (-0.15, 0.0, 0.98)}.get(direction, (0.95, 0.15, 0.2))
    lean = {"up": (-0.05, -0.1, 0), "forward": (0.3, 0, -0.3)}.get(direction, (0.05, 0.25, 0.2))
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.5, 0.9), c.r(0.3, 1.0), hand=c.about(place, 0.04), spine=lean, shrugs=0.1,
                head=(-0.45 if direction == "up" else 0.0, 0, 0)),
            back(c.r(0.6, 0.9)),
        ]  # fmt: skip
    return keys
