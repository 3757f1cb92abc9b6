"""Combat: punches, kicks, blocks, blades, guns, bows.

Fighters are seldom rooted: they step about, turn and sway, and are on guard before and after.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import Curves
from encoders.corpus.engine.keyframed_actions import HANDS, SIDED, Cue, grip, keyframed, moved
from encoders.corpus.engine.keyframes import Channels, KeyPose, back, key
from encoders.corpus.engine.program import HEIGHTS
from encoders.corpus.engine.stance import step_about

GROUP = "sport"


def _footwork(c: Cue, curves: Curves) -> None:
    """Steps under the blows: of most fighters, many steps."""
    if c.chance(0.85):
        step_about(curves, c.rng, c.r(0.4, 2.0))


def _aiming(c: Cue, curves: Curves) -> None:
    """Few steps, if any."""
    if c.chance(0.3):
        step_about(curves, c.rng, c.r(0.1, 0.6))


def _opening(c: Cue, seconds: float) -> float:
    """Seconds from standing to the first pose: none for who is on guard already."""
    return 0.0 if c.chance(0.5) else seconds


def _ending(c: Cue, keys: list[KeyPose], seconds: float, share: float = 0.4) -> list[KeyPose]:
    """The keys, and standing relaxed after them: sometimes, and always after a brief action."""
    brief = sum(k.seconds + k.hold for k in keys) < 1.1
    return [*keys, back(seconds)] if c.chance(share) or brief else keys


def _guard(c: Cue) -> dict[str, ArrayLike]:
    """Fists up before the face."""
    up = c.r(-0.5, 0.15)
    return {"lead": c.about((-0.22, up, 0.3), 0.03), "off": c.about((-0.18, up, 0.42), 0.03)}


def _stance(c: Cue) -> dict[str, ArrayLike]:
    """Feet set apart with the other foot ahead, knees bent; sometimes simply standing."""
    if c.chance(0.15):
        return {}
    long = c.r(0.12, 0.42)
    return {
        "off_foot": (0.03, 0.0, long * 0.6), "lead_foot": (0.06, 0.0, -long * 0.6), "root": (0.0, -c.r(0.03, 0.1), 0.0),
        "lead_turn": 0.5, "spine": (0.1, 0, 0), "pelvis": (0.05, 0, c.r(0.0, 0.6)),
    }  # fmt: skip


def _blow(c: Cue, hand: str, through: list[tuple[float, ArrayLike]], guard: Channels, reach: float) -> list[KeyPose]:
    """One strike: key places with their times, the trunk turning into it, and back on guard."""
    toward = -reach if hand == "lead" else reach
    keys = []
    for index, (seconds, place) in enumerate(through):
        last = index == len(through) - 1
        turn = toward if last else -0.3 * toward
        hold = c.r(0.02, 0.15) if last else 0.0
        hips = c.r(0.3, 1.0) * turn
        aside = c.r(-0.2, 0.15) if last else 0.0
        trunk = {
            "spine": (c.r(0.0, 0.25) if last else 0.0, aside, turn), "pelvis": (0.06, 0, hips),
            "head": (0.05, 0, -0.8 * (turn + hips)),
        }  # fmt: skip
        keys += [key(seconds, hold, **{hand: place}, **trunk)]
    again = {hand: guard[hand]}
    settled = {"spine": (0.08, c.r(-0.12, 0.12), 0), "pelvis": (0.05, 0, 0), "head": (0, 0, 0)}
    return [*keys, key(c.r(0.18, 0.32), c.r(0.0, 0.2), **again, **settled)]


def _round(c: Cue, kinds: tuple[str, ...]) -> list[KeyPose]:
    """Punches of these kinds by the step's hand, or by both in turn, from a guard or from hanging arms."""
    guard = _guard(c)
    on_guard = c.chance(0.75)
    keys = [key(_opening(c, c.r(0.4, 0.7)), c.r(0.2, 0.5), **guard, **_stance(c))] if on_guard else []
    if not on_guard and c.chance(0.7):  # a step into it
        step = {"off_foot": (0.0, 0.0, c.r(0.2, 0.4)), "root": (0.0, -0.05, 0.12)}
        keys = [key(c.r(0.3, 0.45), **guard, **step)]
    height = {"low": -0.45, "middle": -0.15, "high": 0.2}.get(c.step.height, c.r(-0.2, 0.15))
    count = c.times(1, 4 if c.both else 2, 0.6)
    for index in range(count):
        hand = "off" if c.both and index % 2 else "lead"
        kind = kinds[int(c.rng.integers(len(kinds)))]
        fast = c.r(0.1, 0.2)
        front = c.about((-0.3, height, 0.93), 0.05)
        if kind == "straight":
            wind = [(c.r(0.15, 0.35), (0.05, -0.3, -0.05))] if c.chance(0.45) else []
            path: list[tuple[float, ArrayLike]] = [*wind, (fast, front)]
        elif kind == "hook":
            path = [
                (0.18, (0.35, height - 0.1, 0.25)),
                (fast, (-0.1, height, 0.72)),
                (0.08, (-0.6, height + 0.02, 0.5)),
            ]
        else:
            path = [(0.2, (-0.05, -0.55, 0.15)), (fast, (-0.28, -0.15, 0.5)), (0.09, (-0.3, 0.35, 0.5))]
        keys += _blow(c, hand, path, guard, c.r(0.25, 0.6))
    return _ending(c, keys, c.r(0.5, 0.8), 0.45 if on_guard else 0.8)


def _punch(name: str, kinds: tuple[str, ...], weight: float = 1.0) -> None:
    @keyframed(name, group=GROUP, finish=_footwork, sides=HANDS, heights=HEIGHTS, counts=(1, 6), weight=weight)
    def punch(c: Cue) -> list[KeyPose]:
        return _round(c, kinds)


_punch("punch", ("straight", "straight", "straight", "hook"), 3.0)
_punch("jab", ("straight",))
_punch("hook", ("hook",))
_punch("uppercut", ("uppercut",))


@keyframed("box", group=GROUP, finish=_footwork, counts=(3, 10), weight=2)
def box(c: Cue) -> list[KeyPose]:
    """Shadow boxing: combinations, bobbing, weaving, small steps."""
    guard, stance = _guard(c), _stance(c)
    keys = [key(_opening(c, 0.5), 0.2, **guard, **stance)]
    for _ in range(c.times(4, 8, 0.8)):
        move = c.rng.random()
        if move < 0.65:
            hand = "off" if c.chance(0.5) else "lead"
            keys += _blow(
                c, hand, [(c.r(0.1, 0.18), c.about((-0.3, c.r(-0.2, 0.2), 0.92), 0.04))], guard, c.r(0.2, 0.5)
            )
        elif move < 0.85:
            side = 1 if c.chance(0.5) else -1
            keys += [
                key(0.22, root=(0.1 * side, -0.15, 0.0), spine=(0.3, c.r(0.2, 0.5) * side, 0.2 * side)),
                key(0.25, root=(-0.05 * side, -0.06, 0.0), spine=(0.1, -c.r(0.05, 0.25) * side, 0)),
            ]
        else:
            keys += [key(0.12, root=(0, -0.09, 0.02)), key(0.12, root=(0, -0.03, -0.01))]
    return _ending(c, keys, 0.7, 0.3)


@keyframed("fighting stance", group=GROUP, finish=_footwork, sides=SIDED)
def fighting_stance(c: Cue) -> list[KeyPose]:
    keys = [key(_opening(c, 0.5), 0.3, **_guard(c), **_stance(c))]
    for _ in range(int(c.r(2, 6))):
        keys += [key(0.2, root=(c.r(-0.05, 0.05), -0.1, 0.02)), key(0.2, root=(0, -0.05, 0))]
    return _ending(c, keys, 0.7)


@keyframed("block", group=GROUP, finish=_footwork, sides=HANDS, heights=HEIGHTS, counts=(1, 4))
def block(c: Cue) -> list[KeyPose]:
    up = c.height(-0.55, 0.1, 0.5)
    keys = [key(_opening(c, 0.4), c.r(0.0, 0.3), **_guard(c), **_stance(c))]
    for _ in range(c.times(1, 3)):
        place = c.about((c.r(-0.35, 0.05), up, c.r(0.25, 0.5)), 0.05)
        turn, away = c.r(-0.6, 0.4), c.r(-0.3, 0.2)
        keys += [
            key(c.r(0.12, 0.22), c.r(0.1, 0.6), hand=place, elbow=c.r(0.2, 0.7), root=(0.3 * away, -0.1, -0.04),
                spine=(c.r(-0.1, 0.25), away, turn), pelvis=(0, 0, 0.5 * turn), head=(0.05, -0.4 * away, -turn)),
            key(c.r(0.22, 0.4), hand=(-0.2, 0.0, 0.35), elbow=0.0, spine=(0.05, 0, 0), pelvis=(0, 0, 0),
                head=(0, 0, 0), root=(0, -0.05, 0)),
        ]  # fmt: skip
    return _ending(c, keys, 0.6)


def _poise(c: Cue) -> dict[str, ArrayLike]:
    """Arms during a kick: on guard, out for balance, or loose."""
    kind = c.rng.random()
    if kind < 0.4:
        return _guard(c)
    if kind < 0.7:
        return {"lead": c.about((0.4, -0.6, -0.1), 0.08), "off": c.about((0.3, -0.3, 0.4), 0.08)}
    return {"lead": c.about((0.3, -0.85, -0.1), 0.06), "off": c.about((0.2, -0.85, 0.25), 0.06)}


def _kicked(c: Cue, chamber: Channels, strike: Channels, ready: bool) -> list[KeyPose]:
    """Kicks: weight over, knee up, strike, knee back, foot down; `count` times."""
    loose = {"lead": (0.2, -0.9, 0.0), "off": (0.2, -0.9, 0.1)}
    keys = [key(_opening(c, c.r(0.4, 0.6)), c.r(0.0, 0.3), **_guard(c), **_stance(c))] if ready else []
    for _ in range(c.times(1, 2)):
        arms = _poise(c)
        wound, turned = c.r(-0.15, 0.5), c.r(-0.9, 0.15)
        keys += [
            key(c.r(0.22, 0.4), **arms, **_twisted(chamber, wound, -0.6 * wound)),
            key(c.r(0.13, 0.24), c.r(0.0, 0.2), **_twisted(strike, -0.5 * wound, turned)),
            key(c.r(0.16, 0.28), **_twisted(chamber, 0.2 * wound, 0.5 * turned)),
            key(c.r(0.22, 0.4), lead_foot=(0.03, 0, c.r(-0.1, 0.25)), lead_toes=0.0, root=(0, -0.02, c.r(0.0, 0.08)),
                spine=(c.r(0.0, 0.2), 0, 0), pelvis=(0, 0, 0), head=(0, 0, 0), off_turn=0.0,
                **(loose if not ready else {})),
        ]  # fmt: skip
    return _ending(c, keys, c.r(0.5, 0.8), 0.55)


def _twisted(pose: Channels, chest: float, hips: float) -> Channels:
    """The pose with chest and hips turned further to the leading side, and the standing foot with the hips."""
    spine, pelvis = (np.array(pose.get(part, (0, 0, 0)), np.float64) for part in ("spine", "pelvis"))
    spine[2] += chest - 0.5 * hips
    pelvis[2] += hips
    return {**pose, "spine": spine, "pelvis": pelvis, "off_turn": -0.8 * hips}


@keyframed(
    "kick",
    group=GROUP,
    finish=_footwork,
    sides=SIDED,
    heights=HEIGHTS,
    amplitudes=("small", "large"),
    counts=(1, 5),
    weight=3,
)
def kick(c: Cue) -> list[KeyPose]:
    """A front kick."""
    high = c.height(0.3, 0.7, 1.15) * {"small": 0.75, "large": 1.15}.get(c.step.amplitude, 1.0)
    ahead = (0.8**2 - min(abs(high - 0.8), 0.6) ** 2) ** 0.5 * (0.97 if high < 1.0 else 0.9)
    lean = 0.25 + 0.35 * high
    chamber: Channels = {
        "lead_foot": (-0.03, 0.25 + 0.3 * high, 0.12), "root": (-0.1, -0.01, 0.0), "spine": (0.05, 0, 0),
        "lead_toes": -0.4, "pelvis": (-0.1 * high, 0, 0),
    }  # fmt: skip
    strike: Channels = {
        "lead_foot": (-0.06, high, ahead), "root": (-0.1, 0.0, 0.06), "pelvis": (-0.45 * lean, 0, -0.15),
        "lead_toes": 0.7, "spine": (-0.1 * lean, 0, 0.15), "head": (0.5 * lean, 0, 0),
    }  # fmt: skip
    return _kicked(c, chamber, strike, c.chance(0.5))


@keyframed("side kick", group=GROUP, finish=_footwork, sides=SIDED, heights=HEIGHTS, counts=(1, 5))
def side_kick(c: Cue) -> list[KeyPose]:
    high = c.height(0.35, 0.7, 1.05)
    out = (0.79**2 - min(abs(high - 0.82), 0.6) ** 2) ** 0.5
    tip = -0.35 - 0.35 * high
    chamber: Channels = {"lead_foot": (0.05, 0.45, 0.1), "root": (-0.1, -0.02, 0), "pelvis": (0, tip * 0.3, 0)}
    strike: Channels = {
        "lead_foot": (out * 0.97 - 0.15, high, 0.05), "root": (-0.16, -0.02, 0), "pelvis": (0, tip * 0.8, 0),
        "spine": (0, tip * 0.3, 0), "head": (0, -tip * 0.6, 0.7),
    }  # fmt: skip
    return _kicked(c, chamber, strike, c.chance(0.6))


@keyframed("roundhouse kick", group=GROUP, finish=_footwork, sides=SIDED, heights=HEIGHTS, counts=(1, 4))
def roundhouse_kick(c: Cue) -> list[KeyPose]:
    high = c.height(0.4, 0.75, 1.15)
    turn = c.r(0.6, 1.1)
    keys = [key(_opening(c, 0.4), 0.2, **_guard(c), **_stance(c))]
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.22, 0.35), lead_foot=(0.35, 0.6 * high, -0.1), root=(-0.1, -0.02, 0), pelvis=(0, -0.3, 0.1)),
            key(0.12, lead_foot=(0.35, 0.95 * high, 0.45), pelvis=(-0.1, -0.5, -turn * 0.6), spine=(0, -0.2, -0.2)),
            key(0.1, 0.05, lead_foot=(-0.3, high, 0.68), pelvis=(-0.15, -0.45, -turn), lead=(0.3, -0.6, -0.2),
                spine=(0, -0.1, 0.5 * turn), off_turn=0.7 * turn),
            key(0.22, lead_foot=(0.0, 0.4, 0.3), pelvis=(0, -0.1, -0.4), spine=(0, 0, 0)),
            key(0.25, lead_foot=(0.05, 0, 0.05), root=(0, -0.04, 0), pelvis=(0, 0, 0), off_turn=0.0, **_guard(c)),
        ]  # fmt: skip
    return _ending(c, keys, 0.7)


@keyframed("knee strike", group=GROUP, finish=_footwork, sides=SIDED, counts=(1, 4))
def knee_strike(c: Cue) -> list[KeyPose]:
    keys = [key(_opening(c, 0.4), hands=(-0.2, 0.05, 0.6), **_stance(c))]
    for _ in range(c.times(1, 3)):
        keys += [
            key(0.2, 0.05, lead_foot=(-0.05, 0.55, 0.05), root=(-0.08, 0.0, 0.08), pelvis=(-0.35, 0, c.r(-0.5, 0)),
                spine=(c.r(0, 0.2), 0, c.r(-0.1, 0.4)), hands=(-0.15, -0.4, 0.35)),
            key(0.3, lead_foot=(0.05, 0, -0.15), root=(0, -0.04, 0), pelvis=(0, 0, 0),
                spine=(0.05, 0, 0), hands=(-0.2, 0.05, 0.6)),
        ]  # fmt: skip
    return _ending(c, keys, 0.6)


@keyframed("elbow strike", group=GROUP, finish=_footwork, sides=SIDED, counts=(1, 4))
def elbow_strike(c: Cue) -> list[KeyPose]:
    keys = [key(_opening(c, 0.4), **_guard(c), **_stance(c))]
    for _ in range(c.times(1, 2)):
        hips = c.r(0.1, 0.6)
        keys += [
            key(0.2, lead=(0.05, -0.05, 0.1), lead_elbow=1.2, spine=(0, 0, 0.4), pelvis=(0, 0, 0.4 * hips)),
            key(0.13, 0.1, lead=(-0.62, 0.0, 0.22), lead_elbow=1.4, spine=(0.1, 0, -0.6), pelvis=(0, 0, -hips)),
            key(0.3, lead=(-0.2, 0.0, 0.3), lead_elbow=0.0, spine=(0, 0, 0), pelvis=(0, 0, 0)),
        ]
    return _ending(c, keys, 0.6)


SLASHES = ("down", "left", "right", "up")


@keyframed("slash", group=GROUP, finish=_footwork, sides=HANDS, directions=SLASHES, counts=(1, 5), weight=2)
def slash(c: Cue) -> list[KeyPose]:
    """Swing a blade: down, across to either side, upward, or down across; one hand or both."""
    two = c.both or (not c.step.side and c.chance(0.6))
    across = c.toward or (-1.0 if c.chance(0.7) else 1.0)
    ways = {
        "down": ((0.0, 0.75, -0.05), (0.0, 0.2, 0.8), (0.0, -0.65, 0.5)),
        "up": ((-0.5 * across, -0.75, 0.25), (0.0, -0.1, 0.8), (0.45 * across, 0.65, 0.3)),
        "side": ((-0.75 * across, 0.05, 0.3), (0.0, -0.05, 0.85), (0.8 * across, -0.1, 0.35)),
        "": ((-0.5 * across, 0.75, 0.0), (0.0, 0.1, 0.8), (0.55 * across, -0.65, 0.4)),
    }
    start, middle, end = (c.about(p, 0.06) for p in ways["side" if c.step.direction in SIDED else c.step.direction])

    def blade(p: ArrayLike) -> dict[str, ArrayLike]:
        x, y, z = np.asarray(p, np.float64)
        return grip(x, y, z, 0.05) if two else {"lead": (x * 0.9, y, z)}

    front = c.r(0.15, 0.45)
    first = _opening(c, 0.5)
    keys = [key(first, c.r(0.1, 0.5), **blade((0.05, -0.35, 0.55)), root=(0, -0.04, 0), off_foot=(0.03, 0, 0.12))]
    for _ in range(c.times(1, 2)):
        turn, fast, hips = across * c.r(0.3, 0.7), c.r(0.16, 0.3), c.r(0.1, 0.8)
        keys += [
            key(c.r(0.3, 0.55), c.r(0.0, 0.2), **blade(start), spine=(-0.12, 0, -turn), head=(0.05, 0, turn * 0.7),
                pelvis=(0, 0, -hips * turn)),
            key(
                fast,
                **blade(middle),
                spine=(0.1, 0, 0.3 * turn),
                lead_foot=(0.03, 0, front),
                root=(0, -0.08, front / 2),
            ),
            key(fast, c.r(0.1, 0.5), **blade(end), spine=(0.3, c.r(-0.2, 0.2), turn), head=(0, 0, -turn * 0.5),
                pelvis=(0.05, 0, hips * turn)),
            key(c.r(0.3, 0.5), **blade((0.05, -0.3, 0.55)), spine=(0.05, 0, 0), pelvis=(0, 0, 0),
                lead_foot=(0.03, 0, -0.05)),
        ]  # fmt: skip
    return _ending(c, keys, 0.8, 0.5)


@keyframed("stab", group=GROUP, finish=_footwork, sides=HANDS, heights=HEIGHTS, counts=(1, 4))
def stab(c: Cue) -> list[KeyPose]:
    """Thrust a blade or spear forward with a lunge."""
    up, two = c.height(-0.5, -0.2, 0.1), c.both
    drawn, out = (0.1, up - 0.1, -0.1), (-0.25, up, 0.94)
    keys = [key(_opening(c, 0.4), hands=(-0.1, -0.4, 0.45), off_foot=(0.02, 0, 0.1))]
    for _ in range(c.times(1, 2)):
        other = {"off": (-0.55, up - 0.15, 0.35)} if two else {}
        ahead = {"off": (-0.35, up - 0.05, 0.75)} if two else {"off": c.about((0.2, -0.5, -0.2), 0.08)}
        lunge = c.r(0.25, 0.5)
        keys += [
            key(c.r(0.3, 0.45), lead=drawn, **other, spine=(0, 0, 0.4), head=(0, 0, -0.3)),
            key(c.r(0.14, 0.22), c.r(0.1, 0.4), lead=out, **ahead, lead_foot=(0.02, 0, lunge), root=(0, -0.12, 0.25),
                spine=(0.25, 0, -0.35), head=(-0.1, 0, 0.2)),
            key(0.4, lead=drawn, lead_foot=(0.02, 0, 0.0), root=(0, -0.02, 0), spine=(0, 0, 0.1)),
        ]  # fmt: skip
    return [*keys, back(0.7)]


@keyframed("shoot gun", group=GROUP, finish=_aiming, sides=HANDS, counts=(1, 6))
def shoot_gun(c: Cue) -> list[KeyPose]:
    two = c.both or (not c.step.side and c.chance(0.6))
    aim = {"lead": (-0.3, 0.05, 0.9), "off": (-0.38, 0.0, 0.85)} if two else {"lead": (-0.15, 0.06, 0.95)}
    kick = {name: moved(p, 0.0, 0.09, -0.09) for name, p in aim.items()}
    keys = [key(c.r(0.3, 0.6), c.r(0.4, 0.9), **aim)]
    for _ in range(c.times(1, 4)):
        keys += [key(0.07, **kick, spine=(-0.05, 0, 0)), key(0.18, c.r(0.1, 0.4), **aim, spine=(0.03, 0, 0))]
    return [*keys, back(0.7)]


@keyframed("shoot bow", group=GROUP, sides=SIDED, counts=(1, 3))
def shoot_bow(c: Cue) -> list[KeyPose]:
    """Hold the bow out, draw the string back to the cheek with the leading hand, let go."""
    bow = (0.9, 0.06, 0.35)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [
            key(0.6, 0.2, off=(0.5, -0.1, 0.55), lead=(-0.85, -0.05, 0.45), spine=(0, 0, 0.5), head=(0, 0, -0.9)),
            key(c.r(0.8, 1.3), c.r(0.5, 1.0), off=bow, lead=(-0.12, 0.1, 0.22), lead_elbow=0.9, spine=(-0.03, 0, 0.7)),
            key(0.12, 0.4, lead=(0.15, 0.08, 0.05)),
        ]
    return [*keys, back(0.8)]
