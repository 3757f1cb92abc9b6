"""Exercises: arm swings and circles, bends, stretches, jumping jacks, push-ups, sit-ups, yoga."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, SIDED, UPPER, Cue, keyframed, moved, orbit
from encoders.corpus.engine.keyframes import REST, KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "exercise"


@keyframed("jumping jacks", group=GROUP, counts=(2, 10), amplitudes=AMPLITUDES, weight=3)
def jumping_jacks(c: Cue) -> list[KeyPose]:
    """Feet apart and arms up in one hop, together and down in the next; half of them only half as high."""
    size, beat = c.size(0.12), c.r(0.38, 0.62)
    wide, hop = 0.22 * min(size, 1.3), c.r(0.05, 0.12)
    top: ArrayLike = (
        c.about((c.r(-0.2, 0.45), c.r(0.7, 0.93), 0.08), 0.04) if c.chance(0.8) else c.about((0.9, 0.15, 0.1), 0.04)
    )
    low = c.about((0.12, -0.93, 0.1), 0.02)
    side = (0.97, -0.05, 0.08)
    keys: list[KeyPose] = []
    for _ in range(c.times(4, 9, 2 * beat)):
        keys += [
            key(beat * 0.5, feet=(wide / 2, hop, 0), root=(0, hop - 0.02, 0), hands=side),
            key(beat * 0.5, feet=(wide, 0, 0), root=(0, -0.05, 0), hands=top),
            key(beat * 0.5, feet=(wide / 2, hop, 0), root=(0, hop - 0.02, 0), hands=side),
            key(beat * 0.5, feet=(-0.02, 0, 0), root=(0, -0.04, 0), hands=low),
        ]
    return [*keys, back(0.4)]


@keyframed(
    "arm circles", group=GROUP, parts=ONE_ARM, sides=HANDS, amplitudes=AMPLITUDES, directions=("forward", "backward"),
    counts=(2, 8), weight=2,
)  # fmt: skip
def arm_circles(c: Cue) -> list[KeyPose]:
    """Small circles of outstretched arms, or whole wheels of straight arms."""
    way = -1 if c.step.direction == "backward" or (not c.step.direction and c.chance(0.4)) else 1
    hand = "hand" if c.step.side else "hands"
    if c.step.amplitude == "large" or (not c.step.amplitude and c.chance(0.45)):
        lap = c.r(0.9, 1.7)
        centre, up = np.array([0.3, 0.0, 0.0]), np.array([0, 0.9, 0])
        behind = np.array([0.45, 0.0, -0.75])  # behind the body the arm has to go outward
        turns = orbit(hand, centre, -up, behind * way, c.times(2, 5, lap), lap)
        return [key(0.2, **{hand: centre - up}), *turns, back(0.5)]
    lap, radius = c.r(0.5, 0.9), c.r(0.12, 0.26)
    centre = np.array([0.9, 0.0, 0.05])
    first, second = np.array([0, radius, 0]), np.array([0, 0, radius * way])
    turns = orbit(hand, centre, first, second, c.times(3, 8, lap), lap)
    return [key(0.7, **{hand: centre + first}), *turns, back(0.8)]


@keyframed("swing arms", group=GROUP, parts=ARMS, directions=SIDED, amplitudes=AMPLITUDES, counts=(2, 8), weight=1.5)
def swing_arms(c: Cue) -> list[KeyPose]:
    """Loose arms swung to and fro, opposed or together, or across the body and open."""
    size, beat, kind = c.size(0.25), c.r(0.35, 0.6), c.rng.random()
    front, rear = (0.08, -0.9 + 0.45 * size, 0.45 * size + 0.3), (0.12, -0.85, -0.38 * size)
    if c.step.direction or kind < 0.3:
        a: dict[str, ArrayLike] = {"lead": (0.75, -0.3, 0.35), "off": (-0.7, -0.35, 0.45), "spine": (0, 0, 0.5 * size)}
        b: dict[str, ArrayLike] = {"off": (0.75, -0.3, 0.35), "lead": (-0.7, -0.35, 0.45), "spine": (0, 0, -0.5 * size)}
    elif kind < 0.55:
        a, b = {"lead": front, "off": rear, "spine": (0, 0, -0.1)}, {"lead": rear, "off": front, "spine": (0, 0, 0.1)}
    elif kind < 0.8:
        a, b = {"hands": front, "root": (0, 0, 0)}, {"hands": rear, "root": (0, -0.05, 0)}
    else:
        a, b = {"hands": (0.95, -0.1, 0.1)}, {"lead": (-0.65, -0.05, 0.5), "off": (-0.65, -0.12, 0.55)}
    keys: list[KeyPose] = []
    for _ in range(c.times(3, 7, 2 * beat)):
        keys += [key(beat, **a), key(beat, **b)]
    return [*keys, back(0.6)]


@keyframed("flap arms", group=GROUP, parts=ARMS, amplitudes=AMPLITUDES, counts=(2, 10), weight=1.5)
def flap_arms(c: Cue) -> list[KeyPose]:
    """Like a bird's wings."""
    size, beat = c.size(0.25), c.r(0.2, 0.45)
    rise = 0.45 * size
    keys = [key(0.5, hands=(0.85, 0.2, 0.05))]
    for _ in range(c.times(4, 9, 2 * beat)):
        keys += [
            key(beat, hands=(0.75, -rise, 0.1), elbows=0.2, root=(0, 0.0, 0)),
            key(beat, hands=(0.8, rise, 0.0), elbows=0.5, root=(0, -0.03, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("side bend", group=GROUP, parts=UPPER, directions=SIDED, counts=(1, 6), weight=1.5)
def side_bend(c: Cue) -> list[KeyPose]:
    """Bend to a side with the other arm over the head; without a direction to both in turn."""
    deep, hips = c.r(0.35, 0.7), c.chance(0.3)
    side, keys = c.toward or 1.0, list[KeyPose]()
    for index in range(c.times(1, 3) if c.step.direction else c.times(2, 5)):
        way = side if c.step.direction or index % 2 == 0 else -side
        upper, lower = ("off", "lead") if way > 0 else ("lead", "off")
        arms: dict[str, ArrayLike] = {upper: (-0.25, 0.9, 0.1), lower: (0.05, -0.85, 0.1)}
        arms = {"hands": (0.0, -0.68, 0.05), "elbows": 0.9} if hips else arms
        keys += [
            key(c.r(0.6, 1.0), c.r(0.1, 0.9), **arms, spine=(0, deep * way, 0), root=(-0.05 * way, 0, 0)),
            key(c.r(0.4, 0.7), spine=(0, 0, 0), root=(0, 0, 0)),
        ]
    return [*keys, back(0.6)]


@keyframed("toe touch", group=GROUP, sides=SIDED, counts=(1, 8), weight=2)
def toe_touch(c: Cue) -> list[KeyPose]:
    """Bend with straight legs and reach for the feet with both hands, or with one for the other foot (windmill)."""
    wind, beat = bool(c.step.side) or c.chance(0.3), c.r(0.5, 0.9)
    fold = {"pelvis": (1.1, 0, 0), "root": (0, -0.06, -0.17), "head": (0.1, 0, 0)}
    apart = 0.15 if wind else c.r(0.0, 0.1)
    keys = [key(0.4, feet=(apart, 0, 0), hands=(0.95, 0.05, 0.05) if wind else (0.0, 0.93, 0.1), root=(0, -0.03, 0))]
    for index in range(c.times(1, 4, 2 * beat)):
        lead = bool(c.step.side) or index % 2 == 0
        low = (-0.2, 0.12, 0.14)
        if wind:
            down: dict[str, ArrayLike] = {("lead_reach" if lead else "off_reach"): low}
            down |= {("off" if lead else "lead"): (0.6, 0.1, -0.6), "spine": (0.9, 0, -0.6 if lead else 0.6)}
            rise: dict[str, ArrayLike] = {"hands": (0.95, 0.05, 0.05)}
        else:
            down = {"reaches": (0.1 + apart, 0.14, 0.2), "spine": (1.0, 0, 0)}
            rise = {"hands": (0.0, 0.93, 0.1)} if c.chance(0.5) else {"hands": REST}
        keys += [
            key(beat, c.r(0.1, 0.6), **fold, **down),
            key(beat, **rise, pelvis=(0, 0, 0), spine=(0, 0, 0), root=(0, -0.02, 0), head=(0, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed(
    "stretch arms", group=GROUP, parts=UPPER, sides=HANDS, directions=("up", "left", "right"), counts=(1, 4), weight=2
)
def stretch_arms(c: Cue) -> list[KeyPose]:
    """Overhead with both, one overhead, or one drawn across the chest by the other."""
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        if c.both or (c.step.direction == "up" and not c.step.side) or (not c.step.side and c.chance(0.4)):
            lean = c.r(-0.15, 0.0)
            up: dict[str, ArrayLike] = {
                "hands": c.about((-0.25, 0.95, 0.05), 0.03),
                "spine": (lean, 0, 0),
                "shrugs": 0.2,
                "head": (-0.2, 0, 0),
            }
            keys += [key(c.r(0.8, 1.2), c.r(0.6, 1.8), **up)]
        elif c.step.direction == "up" or (not c.step.direction and c.chance(0.35)):
            keys += [key(c.r(0.7, 1.1), c.r(0.5, 1.5), lead=(-0.2, 0.93, 0.05), spine=(0, -0.2, 0), shrugs=0.1)]
        else:
            pull: dict[str, ArrayLike] = {
                "lead": (-0.78, -0.02, 0.5),
                "off": (-0.35, -0.05, 0.42),
                "spine": (0, 0, -0.25),
                "off_elbow": 0.3,
            }
            keys += [key(c.r(0.7, 1.1), c.r(0.8, 2.0), **pull)]
        keys += [back(c.r(0.6, 0.9))]
    return keys


@keyframed(
    "leg swing", group=GROUP, sides=SIDED, directions=("forward", "left", "right"), amplitudes=AMPLITUDES, counts=(2, 8)
)
def leg_swing(c: Cue) -> list[KeyPose]:
    """One leg like a pendulum, forward and back or across."""
    size, beat, sideways = c.size(0.2), c.r(0.35, 0.55), c.step.direction in SIDED
    a, b = ((0.5 * size, 0.2 * size, 0.0), (-0.25, 0.08, 0.1)) if sideways else (
        (0.0, 0.3 * size, 0.6 * size), (0.0, 0.15 * size, -0.45 * size))  # fmt: skip
    arms = {"hands": c.about((0.5, -0.3, 0.2), 0.1)} if c.chance(0.5) else {"hands": (0.0, -0.68, 0.05), "elbows": 0.9}
    keys = [key(0.4, **arms, root=(-0.08, -0.01, 0))]
    for _ in range(c.times(3, 6, 2 * beat)):
        keys += [
            key(beat, lead_foot=a, pelvis=(-0.15 * size, 0, 0), spine=(0.05, 0, 0)),
            key(beat, lead_foot=b, pelvis=(0.15 * size, 0, 0), spine=(0.0, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("raise knee", group=GROUP, sides=("left", "right", "both"), amplitudes=AMPLITUDES, counts=(1, 8), weight=1.5)
def raise_knee(c: Cue) -> list[KeyPose]:
    """Lift a knee before the body and set it down; with both, in turn."""
    high, keys = 0.42 * c.size(0.2), list[KeyPose]()
    hug = c.chance(0.25)
    for index in range(c.times(1, 3)):
        foot, hand, side = ("off", "lead", 1) if c.both and index % 2 else ("lead", "off", -1)
        arms = {"hands": (-0.15, -0.6, 0.5)} if hug else {hand: (0.05, -0.5, 0.45)}
        knee: dict[str, ArrayLike] = {f"{foot}_foot": (-0.02, high, 0.08), "root": (0.08 * side, 0, 0), **arms}
        keys += [
            key(c.r(0.35, 0.6), c.r(0.1, 0.8), **knee),
            key(c.r(0.3, 0.5), **{f"{foot}_foot": (0, 0, 0)}, root=(0, 0, 0), hands=REST),
        ]
    return [*keys, back(0.4)]


@keyframed("raise leg", group=GROUP, sides=SIDED, directions=("forward", "backward", "left", "right"), counts=(1, 6))
def raise_leg(c: Cue) -> list[KeyPose]:
    """A straight leg lifted and held; towards the other side it crosses before the standing leg."""
    direction = c.step.direction or ("forward", "side", "backward")[int(c.rng.integers(3))]
    size, keys = c.r(0.7, 1.2), list[KeyPose]()
    place, tip = {
        "forward": ((0.0, 0.28 * size, 0.6 * size), (-0.2, 0.0, 0.0)),
        "backward": ((0.0, 0.25 * size, -0.6 * size), (0.4 * size, 0.0, 0.0)),
    }.get(direction, ((0.5 * size, 0.25 * size, 0.0), (0.0, -0.2 * size, 0.0)))
    if c.toward < 0:
        place, tip = (-0.5 * size, 0.2 * size, 0.22), (0.0, 0.1 * size, 0.2)
    for _ in range(c.times(1, 2)):
        arms = {"hands": c.about((0.7, -0.35, 0.15), 0.1)} if c.chance(0.6) else {}
        keys += [key(c.r(0.5, 0.9), c.r(0.2, 1.4), lead_foot=place, root=(-0.09, 0, 0), pelvis=tip, **arms)]
        keys += [key(c.r(0.4, 0.7), lead_foot=(0, 0, 0), pelvis=(0, 0, 0)), back(0.4)]
    return keys


def _plank(height: float) -> dict[str, ArrayLike]:
    """Face down on hands and toes with the shoulders at about `height`, the trunk straight."""
    slope = np.arctan2(height - 0.22, 1.25)
    return {
        "root": (0, 0.16 + 0.85 * np.sin(slope) - 0.9, 0.05), "pelvis": (np.pi / 2 - slope, 0, 0), "spine": (0.0, 0, 0),
        "head": (-0.35, 0, 0), "feet": (0.0, 0.03, -0.75), "lead_toes": -1.2, "off_toes": -1.2,
        "reaches": (0.24, 0.04, 0.62),
    }  # fmt: skip


@keyframed("push-up", group=GROUP, counts=(1, 8), styled=False, weight=2)
def push_up(c: Cue) -> list[KeyPose]:
    """Down to hands and toes, arms bent and stretched, and up to standing."""
    squat = {"root": (0, -0.5, -0.1), "pelvis": (0.9, 0, 0), "spine": (0.5, 0, 0), "reaches": (0.24, 0.04, 0.6)}
    beat, up = c.r(0.45, 0.8), _plank(0.62)
    keys = [key(0.9, **squat, feet=(0, 0, 0)), key(0.5, 0.2, **up)]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [key(beat, c.r(0.0, 0.2), **_plank(0.3)), key(beat, c.r(0.0, 0.2), **up)]
    return [*keys, key(0.6, **squat, feet=(0, 0, 0), lead_toes=0.0, off_toes=0.0), back(0.9)]


@keyframed("plank", group=GROUP, styled=False)
def plank(c: Cue) -> list[KeyPose]:
    squat = {"root": (0, -0.5, -0.1), "pelvis": (0.9, 0, 0), "spine": (0.5, 0, 0), "reaches": (0.24, 0.04, 0.6)}
    hold = key(0.6, c.r(2.0, 4.0), **_plank(0.6))
    return [
        key(0.9, **squat, feet=(0, 0, 0)),
        hold,
        key(0.6, **squat, feet=(0, 0, 0), lead_toes=0.0, off_toes=0.0),
        back(0.9),
    ]


@keyframed("sit-up", group=GROUP, counts=(1, 8), styled=False, starts="floor", ends="floor", weight=1.5)
def sit_up(c: Cue) -> list[KeyPose]:
    """On the back with knees drawn up, the trunk rises to the knees and lies down again."""
    beat, kind = c.r(0.6, 1.0), c.chance(0.5)
    arms = {"hands": (-0.1, 0.42, 0.05)} if kind else {"lead": (-0.6, -0.3, 0.3), "off": (-0.6, -0.35, 0.34)}
    feet = {"feet": (0.05, 0.0, 0.55), "root": (0, -0.78, 0.0)}
    flat = {"pelvis": (-1.5, 0, 0), "spine": (0.0, 0, 0), "head": (0.0, 0, 0)}
    keys = [key(0.0, 0.3, **feet, **flat, **arms, elbows=0.6)]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [
            key(beat, pelvis=(-0.75, 0, 0), spine=(1.0, 0, 0), head=(0.3, 0, 0)),
            key(beat, c.r(0.0, 0.2), **flat),
        ]
    return keys


@keyframed("squats with arms", group=GROUP, counts=(1, 8), weight=1.5)
def squats_with_arms(c: Cue) -> list[KeyPose]:
    """Knee bends with the arms brought forward."""
    beat, deep = c.r(0.55, 0.95), c.r(0.25, 0.48)
    keys = [key(0.3, feet=(0.05, 0, 0))] if c.chance(0.5) else []
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [
            key(
                beat,
                c.r(0.0, 0.3),
                root=(0, -deep, -0.1),
                pelvis=(0.5, 0, 0),
                spine=(0.15, 0, 0),
                hands=(-0.05, 0.0, 0.95),
            ),
            key(beat, root=(0, 0, 0), pelvis=(0, 0, 0), spine=(0, 0, 0), hands=REST),
        ]
    return [*keys, back(0.4)]


def _pose(name: str, keys_of: dict[str, ArrayLike], sides: tuple[str, ...] = SIDED) -> None:
    @keyframed(name, group=GROUP, sides=sides)
    def held(c: Cue) -> list[KeyPose]:
        return [key(c.r(0.9, 1.5), c.r(1.5, 3.5), **keys_of), back(c.r(0.9, 1.3))]


_pose(
    "tree pose",
    {
        "lead_foot": (-0.16, 0.45, 0.02), "lead_turn": 1.0, "lead_knee": 1.0, "root": (-0.09, 0.0, 0),
        "hands": (-0.3, 0.9, 0.1),
    },
)  # fmt: skip
_pose(
    "warrior pose",
    {
        "lead_foot": (0.0, 0.0, 0.5), "off_foot": (0.05, 0.0, -0.5), "off_turn": 0.8, "root": (0, -0.28, 0.15),
        "lead": (0.1, 0.03, 0.97), "off": (0.35, 0.03, -0.9), "spine": (0, 0, -0.5), "pelvis": (0, 0, -0.5),
        "head": (0, 0, 0.8),
    },
)  # fmt: skip


@keyframed("jump rope", group=GROUP, counts=(3, 12), weight=1.5)
def jump_rope(c: Cue) -> list[KeyPose]:
    """Small hops while the wrists circle beside the hips."""
    beat, hop = c.r(0.36, 0.52), c.r(0.05, 0.14)
    centre = c.about((0.25, -0.6, 0.3), 0.03)
    keys = [key(0.5, hands=centre)]
    for _ in range(c.times(4, 10, beat)):
        keys += [
            key(beat / 2, feet=(0, hop, 0), root=(0, hop, 0), hands=moved(centre, 0.03, 0.09, 0)),
            key(beat / 2, feet=(0, 0, 0), root=(0, -0.05, 0), hands=moved(centre, -0.03, -0.09, 0)),
        ]
    return [*keys, back(0.5)]


@keyframed("hula hoop", group=GROUP, counts=(3, 10), directions=("clockwise", "counterclockwise"))
def hula_hoop(c: Cue) -> list[KeyPose]:
    lap, wide = c.r(0.7, 1.1), c.r(0.06, 0.12)
    way = {"clockwise": 1.0, "counterclockwise": -1.0}.get(c.step.direction, 1.0) * (1.0 if c.lead == "right" else -1.0)
    turns = orbit("root", (0, -0.02, 0), (wide, 0, 0), (0, 0, -wide * way), c.times(4, 8, lap), lap)
    arms: dict[str, ArrayLike] = {"hands": c.about((c.r(0.4, 0.7), c.r(-0.3, 0.1), 0.3), 0.05), "feet": (0.06, 0, 0)}
    return [key(0.5, **arms, root=(wide, -0.02, 0)), *turns, back(0.6)]
