"""Gestures without an addressee: raise, cross, fold, touch, nod, look."""

from __future__ import annotations

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, ONE_ARM, SIDED, UPPER, Cue, keyframed, orbit
from encoders.corpus.engine.keyframes import REST, KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "gesture"
HEAD_ONLY = frozenset({"head"})


def _ending(c: Cue, seconds: float = 0.6, stays: float = 0.2) -> list[KeyPose]:
    """Usually back to rest; sometimes the clip ends in the pose."""
    return [key(0.1, 0.2)] if c.chance(stays) else [back(c.r(0.8, 1.3) * seconds)]


@keyframed("raise arm", group=GROUP, parts=ONE_ARM, sides=HANDS, heights=("middle", "high"), counts=(1, 4), weight=2)
def raise_arm(c: Cue) -> list[KeyPose]:
    up = c.height(0.0, 0.15, 0.92)
    top = c.about((c.r(0.0, 0.45), up, max(0.05, (0.98 - up * up) ** 0.5 if up < 0.6 else 0.15)), 0.05)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.5, 1.0), c.r(0.1, 1.2), hand=top, head=(-0.25 * up * c.r(0, 1), 0, 0)), back(c.r(0.5, 0.9))]
    return keys[:-1] + _ending(c)


@keyframed("raise arm forward", group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(1, 4))
def raise_arm_forward(c: Cue) -> list[KeyPose]:
    front = c.about((c.r(-0.15, 0.1), 0.02, 0.97), 0.04)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.5, 1.0), c.r(0.2, 1.5), hand=front), back(c.r(0.5, 0.9))]
    return keys[:-1] + _ending(c)


@keyframed("raise arm sideways", group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(1, 4))
def raise_arm_sideways(c: Cue) -> list[KeyPose]:
    out = c.about((0.97, 0.02, 0.05), 0.04)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.5, 1.0), c.r(0.2, 1.5), hand=out), back(c.r(0.5, 0.9))]
    return keys[:-1] + _ending(c)


@keyframed("lower arm", group=GROUP, parts=ONE_ARM, sides=HANDS)
def lower_arm(c: Cue) -> list[KeyPose]:
    start = c.about(((0.1, 0.93, 0.1), (0.95, 0.05, 0.1), (0.0, 0.1, 0.95))[int(c.r(0, 3))], 0.05)
    return [key(0.0, c.r(0.3, 0.9), hand=start), back(c.r(0.6, 1.4)), key(0.2, 0.3)]


@keyframed("t-pose", group=GROUP, parts=ARMS)
def t_pose(c: Cue) -> list[KeyPose]:
    out = c.about((0.98, 0.03, 0.0), 0.03)
    return [key(c.r(0.6, 1.1), c.r(0.8, 2.5), hands=out), *_ending(c, 0.9, 0.35)]


@keyframed("cross arms", group=GROUP, parts=ARMS, precise=True)
def cross_arms(c: Cue) -> list[KeyPose]:
    up, ahead = c.r(-0.48, -0.3), c.r(0.3, 0.4)
    folded = {"lead": (-0.62, up + 0.06, ahead), "off": (-0.58, up, ahead + 0.06)}
    return [
        key(c.r(0.6, 1.0), c.r(1.0, 3.0), **folded, elbows=c.r(0.3, 0.7), spine=(c.r(-0.1, 0.02), 0, 0)),
        *_ending(c, 0.7, 0.4),
    ]


@keyframed("cross arms overhead", group=GROUP, parts=ARMS, counts=(1, 4))
def cross_arms_overhead(c: Cue) -> list[KeyPose]:
    keys = [key(c.r(0.5, 0.8), hands=(0.5, 0.7, 0.2))]
    for _ in range(c.times(1, 3)):
        keys += [key(0.3, c.r(0.1, 0.6), hands=c.about((-0.55, 0.72, 0.25), 0.04)), key(0.3, hands=(0.4, 0.75, 0.2))]
    return [*keys, back(0.7)]


@keyframed("hands on hips", group=GROUP, parts=ONE_ARM, sides=HANDS, precise=True)
def hands_on_hips(c: Cue) -> list[KeyPose]:
    hip = (c.r(-0.04, 0.04), c.r(-0.72, -0.62), c.r(-0.08, 0.12))
    return [
        key(c.r(0.5, 0.9), c.r(1.0, 3.0), hand=hip, elbow=c.r(0.7, 1.2), root=(-0.03 * c.r(-1, 1), 0, 0)),
        *_ending(c, 0.6, 0.4),
    ]


@keyframed("hands behind back", group=GROUP, parts=ARMS, precise=True)
def hands_behind_back(c: Cue) -> list[KeyPose]:
    up = c.r(-0.8, -0.62)
    return [
        key(0.35, hands=(0.15, -0.88, -0.2)),
        key(0.4, c.r(1.0, 3.0), lead=(-0.3, up, -0.33), off=(-0.3, up - 0.05, -0.36), spine=(-0.08, 0, 0)),
        key(0.3, hands=(0.15, -0.88, -0.2)),
        back(0.4),
    ]


@keyframed("hands on head", group=GROUP, parts=ONE_ARM, sides=HANDS, precise=True)
def hands_on_head(c: Cue) -> list[KeyPose]:
    top = (c.r(-0.2, -0.08), c.r(0.42, 0.55), c.r(-0.02, 0.14))
    return [
        key(c.r(0.6, 1.0), c.r(0.8, 2.5), hand=top, elbow=c.r(0.2, 0.9), head=(c.r(-0.1, 0.3), 0, 0)),
        *_ending(c, 0.7),
    ]


def _rub(
    c: Cue, spot: tuple[float, float, float], move: tuple[float, float, float], low: int, high: int
) -> list[KeyPose]:
    """The hand moves to a place on the body and rubs it to and fro."""
    there = c.about(spot, 0.03)
    shift = c.about(move, 0.01) * c.size()
    keys = [key(c.r(0.5, 0.9), 0.1, hand=there, elbow=c.r(0.0, 0.5))]
    pause = c.r(0.12, 0.24)
    for _ in range(c.times(low, high, 2 * pause)):
        keys += [key(pause, hand=there + shift), key(pause, hand=there - shift)]
    return keys


@keyframed("scratch head", group=GROUP, parts=ONE_ARM, sides=HANDS, precise=True)
def scratch_head(c: Cue) -> list[KeyPose]:
    spot = (c.r(-0.22, -0.05), c.r(0.35, 0.52), c.r(-0.05, 0.2))
    tilt = key(0.0, head=(c.r(0.0, 0.3), c.r(-0.2, 0.2), 0))
    keys = _rub(c, spot, (0.02, 0.05, 0.04), 3, 8)
    return [*keys, KeyPose(0.05, 0.0, tilt.channels), back(0.6)]


def _touch(name: str, spot: tuple[float, float, float], bow: float, elbow: float = 0.3) -> None:
    @keyframed(name, group=GROUP, parts=ONE_ARM, sides=HANDS, counts=(1, 4), precise=True)
    def touch(c: Cue) -> list[KeyPose]:
        keys: list[KeyPose] = []
        for _ in range(c.times(1, 1)):
            nod = (bow * c.r(0.5, 1.5), 0, 0)
            keys += [key(c.r(0.5, 0.9), c.r(0.2, 1.4), hand=c.about(spot, 0.03), elbow=elbow * c.r(0.5, 1.5), head=nod)]
            keys += [back(c.r(0.5, 0.8))]
        return keys


_touch("touch nose", (-0.27, 0.22, 0.32), 0.05)
_touch("touch ear", (-0.12, 0.22, 0.12), 0.05, 0.7)
_touch("touch face", (-0.2, 0.12, 0.28), 0.1)
_touch("touch chest", (-0.3, -0.25, 0.27), 0.1)
_touch("touch belly", (-0.3, -0.55, 0.3), 0.15)
_touch("touch neck", (-0.2, 0.1, 0.1), 0.1, 0.6)
_touch("cover mouth", (-0.28, 0.14, 0.31), 0.08)
_touch("shield eyes", (-0.2, 0.3, 0.32), -0.03, 0.8)
_touch("cover ears", (-0.12, 0.22, 0.1), 0.2, 0.9)


@keyframed("touch shoulder", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(1, 4), precise=True)
def touch_shoulder(c: Cue) -> list[KeyPose]:
    """The shoulder of the same side; `touch opposite shoulder` reaches across."""
    spot, keys = (-0.02, 0.08, 0.22), list[KeyPose]()
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.5, 0.8), c.r(0.2, 1.0), hand=c.about(spot, 0.03), elbow=0.4), back(0.6)]
    return keys


@keyframed("touch opposite shoulder", group=GROUP, parts=ONE_ARM, sides=SIDED, counts=(1, 4), precise=True)
def touch_opposite_shoulder(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.5, 0.8), c.r(0.2, 1.0), hand=c.about((-0.72, 0.02, 0.26), 0.03)), back(0.6)]
    return keys


@keyframed("touch knee", group=GROUP, sides=HANDS, counts=(1, 4))
def touch_knee(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        low = {"reaches": (0.12, 0.52, 0.2)} if c.both else {"lead_reach": (0.12, 0.52, 0.2)}
        keys += [
            key(c.r(0.6, 1.0), c.r(0.2, 1.2), **low, spine=(0.5, 0, 0), pelvis=(0.5, 0, 0), root=(0, -0.06, -0.1),
                head=(-0.3, 0, 0)),
            back(c.r(0.6, 0.9)),
        ]  # fmt: skip
    return keys


@keyframed("rub hands", group=GROUP, parts=ARMS, precise=True)
def rub_hands(c: Cue) -> list[KeyPose]:
    up, ahead, beat = c.r(-0.5, -0.2), c.r(0.4, 0.55), c.r(0.1, 0.2)
    keys = [key(c.r(0.5, 0.8), hands=(-0.27, up, ahead))]
    for _ in range(c.times(4, 10, 2 * beat)):
        slide = 0.06 * c.r(0.7, 1.5)
        keys += [
            key(beat, lead=(-0.27, up + slide / 2, ahead + slide), off=(-0.27, up - slide / 2, ahead - slide)),
            key(beat, lead=(-0.27, up - slide / 2, ahead - slide), off=(-0.27, up + slide / 2, ahead + slide)),
        ]
    return [*keys, back(0.6)]


@keyframed("wipe face", group=GROUP, parts=ONE_ARM, sides=HANDS, precise=True)
def wipe_face(c: Cue) -> list[KeyPose]:
    brow = c.chance(0.4)
    start, end = ((-0.55, 0.32, 0.3), (-0.05, 0.3, 0.3)) if brow else ((-0.27, 0.3, 0.3), (-0.25, 0.08, 0.32))
    keys = [key(c.r(0.5, 0.8), hand=c.about(start, 0.02), elbow=0.5)]
    for _ in range(c.times(1, 3)):
        keys += [key(c.r(0.3, 0.6), hand=c.about(end, 0.02)), key(c.r(0.2, 0.4), hand=c.about(start, 0.02))]
    return [*keys[:-1], back(0.6)]


@keyframed("cover face", group=GROUP, parts=UPPER, precise=True)
def cover_face(c: Cue) -> list[KeyPose]:
    return [
        key(c.r(0.5, 0.9), c.r(0.8, 2.5), hands=(-0.24, 0.2, 0.3), elbows=c.r(-0.2, 0.4), head=(c.r(0.2, 0.5), 0, 0),
            spine=(c.r(0.05, 0.3), 0, 0)),
        back(0.8),
    ]  # fmt: skip


@keyframed("facepalm", group=GROUP, parts=ONE_ARM, sides=SIDED, precise=True)
def facepalm(c: Cue) -> list[KeyPose]:
    return [
        key(c.r(0.3, 0.6), c.r(0.6, 2.0), hand=(-0.24, 0.26, 0.31), elbow=0.2, head=(c.r(0.25, 0.5), 0, 0),
            spine=(c.r(0, 0.15), 0, 0)),
        back(0.7),
    ]  # fmt: skip


@keyframed("think", group=GROUP, parts=ARMS, sides=SIDED, precise=True)
def think(c: Cue) -> list[KeyPose]:
    other = {"off": (-0.55, -0.4, 0.36)} if c.chance(0.7) else {}
    tilt = c.r(-0.2, 0.2)
    keys = [key(c.r(0.6, 0.9), c.r(0.5, 1.2), lead=(-0.24, 0.02, 0.3), lead_elbow=-0.1, **other, head=(0.1, tilt, 0))]
    if c.chance(0.5):
        keys += [key(0.4, c.r(0.3, 0.9), head=(c.r(-0.3, 0.1), -tilt, c.r(-0.4, 0.4)))]
    return [*keys, *_ending(c, 0.7, 0.3)]


@keyframed("pray", group=GROUP, parts=ARMS, precise=True)
def pray(c: Cue) -> list[KeyPose]:
    bow = c.r(0.1, 0.5)
    return [
        key(c.r(0.7, 1.1), c.r(0.8, 2.5), hands=(-0.29, c.r(-0.2, 0.0), c.r(0.34, 0.45)), elbows=c.r(0.0, 0.6),
            head=(bow, 0, 0), spine=(bow * 0.4, 0, 0)),
        *_ending(c, 0.8),
    ]  # fmt: skip


@keyframed("shrug", group=GROUP, parts=ARMS, counts=(1, 3))
def shrug(c: Cue) -> list[KeyPose]:
    palms = c.about((c.r(0.15, 0.4), c.r(-0.6, -0.3), c.r(0.3, 0.45)), 0.03)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [
            key(c.r(0.3, 0.5), c.r(0.2, 0.8), hands=palms, shrugs=c.r(0.25, 0.5), head=(0, c.r(-0.2, 0.25), 0)),
            key(c.r(0.25, 0.4), hands=palms - [0.05, 0.15, 0.1], shrugs=0.0),
        ]
    return [*keys, back(0.5)]


@keyframed("nod", group=GROUP, parts=HEAD_ONLY, counts=(1, 6), amplitudes=AMPLITUDES)
def nod(c: Cue) -> list[KeyPose]:
    deep, beat = 0.4 * c.size(0.25), c.r(0.2, 0.38)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 4, 2 * beat)):
        keys += [key(beat, head=(deep, 0, 0), spine=(deep * 0.12, 0, 0)), key(beat, head=(-0.25 * deep, 0, 0))]
    return [*keys, back(0.3)]


@keyframed("shake head", group=GROUP, parts=HEAD_ONLY, counts=(1, 6), amplitudes=AMPLITUDES)
def shake_head(c: Cue) -> list[KeyPose]:
    wide, beat = 0.55 * c.size(0.25), c.r(0.2, 0.4)
    keys: list[KeyPose] = []
    for _ in range(c.times(2, 4, 2 * beat)):
        keys += [key(beat, head=(0.05, 0, wide)), key(beat, head=(0.05, 0, -wide))]
    return [*keys, back(0.35)]


@keyframed("look", group=GROUP, parts=HEAD_ONLY, directions=("left", "right", "up", "down", "around"), weight=2)
def look(c: Cue) -> list[KeyPose]:
    turn = c.r(0.7, 1.15)
    if c.step.direction == "around":
        return [
            key(c.r(0.5, 0.9), c.r(0.2, 0.8), head=(c.r(-0.2, 0.1), 0, turn), spine=(0, 0, 0.3 * turn)),
            key(c.r(0.7, 1.2), c.r(0.2, 0.8), head=(c.r(-0.2, 0.1), 0, -turn), spine=(0, 0, -0.3 * turn)),
            back(0.6),
        ]
    pitch = {"up": c.r(-0.75, -0.4), "down": c.r(0.4, 0.8)}.get(c.step.direction, c.r(-0.1, 0.1))
    side = c.toward if c.step.direction else 1.0
    gaze = (pitch, 0, side * turn)
    return [
        key(c.r(0.35, 0.8), c.r(0.5, 1.8), head=gaze, spine=(0.2 * pitch, 0, side * turn * c.r(0, 0.4))),
        *_ending(c, 0.6, 0.25),
    ]


@keyframed("tilt head", group=GROUP, parts=HEAD_ONLY, directions=SIDED, counts=(1, 4))
def tilt_head(c: Cue) -> list[KeyPose]:
    side = (c.toward or 1.0) * c.r(0.35, 0.6)
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        keys += [key(c.r(0.4, 0.7), c.r(0.3, 1.0), head=(0, side, 0)), back(0.5)]
    return keys


@keyframed("roll head", group=GROUP, parts=HEAD_ONLY, counts=(1, 4))
def roll_head(c: Cue) -> list[KeyPose]:
    way = 1 if c.chance(0.5) else -1
    keys = [key(0.6, head=(0.4, 0, 0))]
    return [*keys, *orbit("head", (0, 0, 0), (0.4, 0, 0), (0, 0.4 * way, 0), c.times(1, 3), c.r(1.6, 2.8)), back(0.5)]


@keyframed("roll shoulders", group=GROUP, parts=ARMS, counts=(2, 6))
def roll_shoulders(c: Cue) -> list[KeyPose]:
    beat, lift = c.r(0.25, 0.45), c.r(0.25, 0.45)
    keys: list[KeyPose] = []
    for _ in range(c.times(2, 5, 2 * beat)):
        up = (0.12, -0.88, 0.02)
        keys += [key(beat, shrugs=lift, hands=up, spine=(-0.05, 0, 0)), key(beat, shrugs=-0.08, hands=REST)]
    return [*keys, back(0.4)]


@keyframed("check watch", group=GROUP, parts=ARMS, sides=SIDED, precise=True)
def check_watch(c: Cue) -> list[KeyPose]:
    helper = {"off": (-0.55, -0.3, 0.42)} if c.chance(0.4) else {}
    return [
        key(c.r(0.5, 0.8), c.r(0.6, 1.8), lead=(-0.4, c.r(-0.25, -0.1), 0.42), lead_elbow=0.5, **helper,
            head=(c.r(0.3, 0.55), 0, c.r(-0.15, 0.1))),
        back(0.6),
    ]  # fmt: skip
