"""Directing and explaining gestures: beckon, point, show the way, refuse, call, explain."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS, Array
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, SIDED, UPPER, Cue, keyframed, moved
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "gesture"


@keyframed("beckon", group=GROUP, parts=ONE_ARM, sides=HANDS, amplitudes=AMPLITUDES, counts=(1, 6), weight=2)
def beckon(c: Cue) -> list[KeyPose]:
    """Come here: the hand is drawn in from before the body, or the wrist alone scoops, palm up or palm down."""
    size, kind = c.size(), c.rng.random()
    out = c.about((c.r(-0.1, 0.2), c.r(-0.45, 0.3), 0.55 + 0.2 * min(size, 1.2)), 0.04)
    if kind < 0.35:
        pull, beat = np.array([c.r(-0.2, 0.05), 0.12, -0.28]), c.r(0.25, 0.42)
    elif kind < 0.65:
        pull, beat = np.array([c.r(-0.1, 0.05), 0.3, -0.28]), c.r(0.25, 0.42)
    elif kind < 0.85:  # palm down, the hand paddles
        pull, beat = np.array([0.0, -0.2, -0.12]), c.r(0.15, 0.28)
    else:  # a great sweep of the whole arm
        pull, beat = np.array([-0.15, 0.55, -0.45]), c.r(0.35, 0.6)
    drawn = out + pull * size
    nod, lean = c.r(0.0, 0.12), c.r(-0.08, 0.15)
    keys = [key(c.r(0.35, 0.7), c.r(0.0, 0.3), hand=out, spine=(lean, 0, 0))]
    for _ in range(c.times(1, 5, 2 * beat)):
        keys += [key(beat, hand=drawn, head=(nod, 0, 0)), key(beat, hand=out, head=(-nod, 0, 0))]
    return [*keys, back(c.r(0.5, 0.8))]


def _aim(c: Cue) -> tuple[Array, tuple[float, float, float]]:
    """Wrist of a pointing arm, relative to its shoulder, and the gaze of the head."""
    direction = c.step.direction
    if not direction:
        direction = ("forward", "aside", "up", "down")[int(c.rng.choice(4, p=[0.5, 0.35, 0.1, 0.05]))]
    if direction in SIDED or direction == "aside":
        if c.toward < 0:
            return c.about((-0.72, 0.02, 0.55), 0.05), (0, 0, -0.9)
        angle = c.r(0.0, 0.7)
        return c.about((0.95 * np.cos(angle), 0.03, 0.95 * np.sin(angle)), 0.04), (0, 0, c.r(0.5, 1.0))
    if direction == "up":
        return c.about((0.05, 0.85, 0.4), 0.06), (-0.5, 0, 0.1)
    if direction == "down":
        return c.about((0.05, -0.7, 0.62), 0.06), (0.45, 0, 0.1)
    if direction == "backward":
        return c.about((0.6, 0.05, -0.6), 0.06), (0, 0, 1.1)
    return c.about((-0.05, 0.05, 0.95), 0.06), (0, 0, c.r(-0.1, 0.1))


POINTING = ("forward", "left", "right", "up", "down", "backward")


@keyframed("point", group=GROUP, parts=ONE_ARM, sides=SIDED, directions=POINTING, counts=(1, 3), weight=3)
def point(c: Cue) -> list[KeyPose]:
    place, gaze = _aim(c)
    bent = 1.0 if c.chance(0.7) else c.r(0.75, 1.0)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        twist = (0, 0, 0.3 * gaze[2])
        arm: dict[str, ArrayLike] = {"lead": place * bent}
        if c.chance(0.15):
            arm["off"] = (0.3, -0.6, 0.02)  # on the hip
        keys += [key(0.35, lead=(-0.1, -0.2, 0.4))] if c.chance(0.15) else []
        keys += [key(c.r(0.2, 0.7), c.r(0.3, 2.2), **arm, head=gaze, spine=twist)]
        if c.chance(0.3):
            keys += [key(0.2, lead=place * bent * 0.88), key(0.2, 0.3, lead=place * bent)]
        keys += [back(c.r(0.5, 0.8))]
    return keys if c.chance(0.85) else [*keys[:-1], key(0.1, 0.4)]


def _toward_the_way(c: Cue) -> float:
    """The direction shown: radians from straight ahead towards the leading side."""
    if c.step.direction == "forward":
        return c.r(-0.15, 0.85)
    if c.toward:
        return -c.r(0.75, 1.05) if c.toward < 0 else c.r(0.7, 1.7)
    return c.r(-0.1, 0.6) if c.chance(0.45) else c.r(0.4, 1.6)


def _open_hand(angle: float, up: float, length: float) -> Array:
    """Wrist of an arm held out at an angle and height, in arm lengths."""
    flat = np.sqrt(max(length**2 - up**2, 0.2))
    return np.array([flat * np.sin(angle), up, flat * np.cos(angle)])


def _before_the_way(c: Cue, angle: float, up: float) -> list[KeyPose]:
    """The hand's approach: past the chest, in a sweep from the front, from across the belly, or straight."""
    kind = c.rng.random()
    if kind < 0.4:
        return [key(c.r(0.3, 0.6), c.r(0.0, 0.2), lead=c.about((-0.2, c.r(-0.5, -0.2), 0.42), 0.06))]
    if kind < 0.6:
        sweep = _open_hand(angle - np.copysign(c.r(0.6, 1.1), angle), up + c.r(-0.1, 0.15), c.r(0.6, 0.85))
        return [key(c.r(0.35, 0.6), lead=sweep)]
    if kind < 0.7:
        return [key(c.r(0.4, 0.6), lead=c.about((-0.42, -0.55, 0.35), 0.04), lead_elbow=0.2)]
    return []


def _off_hand(c: Cue, angle: float, up: float) -> dict[str, ArrayLike]:
    """The other hand: hanging, behind the back, in front of the belly, on the hip, or parallel to the first."""
    kind = c.rng.random()
    if kind < 0.6:
        return {}
    if kind < 0.85:
        places = ((-0.15, -0.72, -0.24), (-0.36, -0.52, 0.3), (0.3, -0.6, 0.02))
        return {"off": c.about(places[int(c.rng.integers(3))], 0.03)}
    across = _open_hand(-0.8 * angle - 0.2, up - c.r(0.0, 0.2), c.r(0.6, 0.8))
    return {"off": across * [1.0 if angle > 0 else 0.5, 1.0, 1.0]}


@keyframed("guide", group=GROUP, parts=ONE_ARM, sides=SIDED, directions=("forward", "left", "right"), weight=8)
def guide(c: Cue) -> list[KeyPose]:
    """Show the way: an open hand is led out at waist to shoulder height and held, often with a slight bow or a turn."""
    angle, up = _toward_the_way(c), c.r(-0.62, 0.1)
    across = c.toward < 0
    up, length = (max(up, -0.4), c.r(0.8, 0.97)) if across else (up, c.r(0.6, 0.97))
    place = _open_hand(angle, up, length)
    bow, gaze = max(0.0, c.r(-0.2, 0.4)), float(np.clip(angle, -1, 1)) * c.r(0.0, 0.9)
    trunk: dict[str, ArrayLike] = {"spine": (bow, 0, gaze * c.r(0, 0.5)), "head": (bow * c.r(-0.3, 0.5), 0, gaze)}
    if c.chance(0.5):  # turns to the direction, or steps aside
        trunk["pelvis"] = (bow * 0.4, 0, c.r(0.2, 0.7) * gaze)
    if c.chance(0.2):
        trunk |= {"lead_foot": (0.12, 0.0, -0.18), "root": (0.04, -0.01, -0.08)}
    elif c.chance(0.12):
        trunk |= {"lead_foot": (0.05, 0.0, 0.25), "root": (0.03, -0.02, 0.12)}
    trunk |= _off_hand(c, angle, up)
    elbow, keys = c.r(-0.4, 0.3), _before_the_way(c, angle, up)
    if keys and c.chance(0.5):  # starts with a movement to the other side
        keys[0].channels["spine"] = np.array([0.0, 0.0, -c.r(0.1, 0.5)])
    keys += [key(c.r(0.3, 0.9), c.r(0.5, 3.0), lead=place, lead_elbow=elbow, **trunk)]
    kind = c.rng.random()
    if kind < 0.3:  # repeated, as an invitation
        for _ in range(int(c.rng.integers(1, 4))):
            near = place * c.r(0.7, 0.9) if c.chance(0.7) else c.about((0.0, -0.7, 0.2), 0.1)
            keys += [key(c.r(0.2, 0.45), lead=near), key(c.r(0.3, 0.5), c.r(0.1, 0.8), lead=place)]
    elif kind < 0.4:  # from the chest once more
        keys += [key(0.5, lead=(-0.2, -0.35, 0.42)), key(0.5, c.r(0.4, 1.2), lead=place)]
    elif kind < 0.5 and not c.toward:  # to the other side, too
        other = _open_hand(-0.7, up, min(length, 0.8))
        keys += [key(0.7, c.r(0.4, 1.0), lead=other, head=(0.0, 0.0, -0.5))]
    return [*keys, back(c.r(0.5, 1.0))] if c.chance(0.78) else keys


@keyframed("phone call", group=GROUP, parts=ONE_ARM, sides=SIDED, precise=True)
def phone_call(c: Cue) -> list[KeyPose]:
    ear, tilt = c.about((-0.1, 0.14, 0.14), 0.02), c.r(0.05, 0.3)
    keys = [key(c.r(0.5, 0.8), c.r(0.5, 1.2), lead=ear, lead_elbow=c.r(-0.3, 0.5), head=(0.1, tilt, 0))]
    for _ in range(int(c.r(0, 3))):
        keys += [key(0.5, c.r(0.3, 0.8), head=c.about((0.1, tilt, 0.0), 0.15), spine=c.about((0, 0, 0.0), 0.06))]
    return [*keys, back(0.7)]


@keyframed("call out", group=GROUP, parts=UPPER, sides=HANDS, counts=(1, 3), weight=2)
def call_out(c: Cue) -> list[KeyPose]:
    """Shout with the hands round the mouth (or one hand beside it), leaning into it."""
    mouth = c.about((-0.2, 0.16, 0.36), 0.03)
    two = c.both or (not c.step.side and c.chance(0.7))
    hands = {"hands": mouth} if two else {"lead": mouth}
    elbows = {"elbows": c.r(0.0, 0.6)} if two else {"lead_elbow": c.r(0.0, 0.6)}
    keys = [key(c.r(0.4, 0.7), 0.15, **hands, **elbows, spine=(-0.12, 0, 0), head=(-0.15, 0, 0))]
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.2, 0.35), c.r(0.4, 1.0), spine=(c.r(0.1, 0.3), 0, 0), head=(-0.1, 0, 0)),
            key(0.35, 0.1, spine=(-0.08, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("dismiss", group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(1, 4))
def dismiss(c: Cue) -> list[KeyPose]:
    """Go away: the hand is flicked out from the chest."""
    keys = [key(0.4, hand=(-0.3, -0.05, 0.38))]
    for _ in range(c.times(1, 3)):
        out = c.about((0.3, -0.1, 0.72), 0.06)
        keys += [key(c.r(0.2, 0.35), 0.1, hand=out), key(0.3, hand=(-0.25, -0.05, 0.4), head=(0, 0, -0.1))]
    return [*keys[:-1], back(0.6)]


@keyframed("wag finger", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(2, 6))
def wag_finger(c: Cue) -> list[KeyPose]:
    place, beat, wide = c.about((0.0, 0.0, 0.52), 0.06), c.r(0.14, 0.25), c.r(0.06, 0.12)
    keys = [key(0.5, lead=place, head=(0.08, 0, 0))]
    for _ in range(c.times(2, 5, 2 * beat)):
        keys += [key(beat, lead=moved(place, -wide, 0, 0)), key(beat, lead=moved(place, wide, 0, 0))]
    return [*keys, back(0.6)]


@keyframed("refuse", group=GROUP, parts=UPPER, counts=(2, 6))
def refuse(c: Cue) -> list[KeyPose]:
    """No, no: both hands cross and part before the chest while the head shakes."""
    up, beat = c.r(-0.3, -0.05), c.r(0.18, 0.3)
    keys = [key(0.4, hands=(0.0, up, 0.5))]
    for _ in range(c.times(2, 4, 2 * beat)):
        keys += [
            key(beat, lead=(-0.55, up + 0.05, 0.52), off=(-0.55, up - 0.05, 0.55), head=(0, 0, 0.35)),
            key(beat, hands=(0.1, up, 0.5), head=(0, 0, -0.35)),
        ]
    return [*keys, back(0.6)]


@keyframed("count fingers", group=GROUP, parts=ARMS, sides=SIDED, counts=(2, 6), precise=True)
def count_fingers(c: Cue) -> list[KeyPose]:
    place = c.about((-0.28, -0.12, 0.45), 0.04)
    beat = c.r(0.25, 0.4)
    keys = [key(0.6, off=moved(place, 0.0, -0.05, 0.05), lead=moved(place, 0.12, 0.1, 0), head=(0.25, 0, 0))]
    for _ in range(c.times(3, 5, 2 * beat)):
        keys += [key(beat, lead=moved(place, 0.0, 0.02, 0.02)), key(beat, lead=moved(place, 0.12, 0.12, 0))]
    return [*keys, back(0.6)]


@keyframed("talk", group=GROUP, parts=ARMS, amplitudes=AMPLITUDES, weight=2)
def talk(c: Cue) -> list[KeyPose]:
    """Explain something: the hands wander in front of the body with beats of speech."""
    size = c.size(0.25)
    one = c.chance(0.35)
    centre = np.array([0.05, -0.45, 0.5])
    keys: list[KeyPose] = []
    for _ in range(c.times(4, 9, 0.5)):
        place = centre + c.rng.normal(0.0, 1.0, 3) * [0.16, 0.13, 0.1] * size
        other = place * [c.r(0.6, 1.2), 1, 1] if c.chance(0.5) else centre + c.rng.normal(0, 0.12, 3) * size
        off = {} if one else {"off": other}
        nod = {"head": c.about((0.05, 0.0, 0.0), 0.12)} if c.chance(0.5) else {}
        keys += [key(c.r(0.22, 0.55), c.r(0.0, 0.25), lead=place, **off, **nod)]
    return [*keys, back(0.7)]


@keyframed("direct traffic", group=GROUP, parts=ARMS)
def direct_traffic(c: Cue) -> list[KeyPose]:
    """Stop one side with a flat hand, wave the other through with the whole arm; then the sides change."""
    keys: list[KeyPose] = []
    stop, wave = "off", "lead"
    for _ in range(c.times(1, 3, 3.0)):
        gaze = c.r(0.4, 0.9) if wave == "lead" else -c.r(0.4, 0.9)
        keys += [key(0.5, c.r(0.2, 0.8), **{stop: c.about((c.r(-0.1, 0.7), 0.1, 0.75), 0.05)}, head=(0, 0, -gaze))]
        out, across = c.about((0.85, c.r(-0.1, 0.35), 0.35), 0.05), c.about((c.r(-0.6, 0.0), 0.0, 0.5), 0.05)
        for _ in range(int(c.r(2, 5))):
            beat = c.r(0.28, 0.45)
            keys += [
                key(beat, **{wave: out}, head=(0, 0, gaze), spine=(0, 0, 0.2 * gaze)),
                key(beat, **{wave: across}, spine=(0, 0, -0.1 * gaze)),
            ]
        stop, wave = wave, stop
    return [*keys, back(0.7)]


@keyframed("conduct", group=GROUP, parts=ARMS, counts=(2, 8))
def conduct(c: Cue) -> list[KeyPose]:
    """Four beats: down, in, out, up."""
    size, beat, up = c.size(0.2), c.r(0.25, 0.45), c.r(-0.2, 0.1)
    keys: list[KeyPose] = []
    for _ in range(c.times(2, 3, 4 * beat)):
        for x, y in ((0.0, -0.3), (-0.2, -0.1), (0.35, -0.1), (0.0, 0.2)):
            keys += [key(beat, hands=(x * size, up + y * size, 0.55), head=(-0.15 * y, 0, 0))]
    return [*keys, back(0.7)]
