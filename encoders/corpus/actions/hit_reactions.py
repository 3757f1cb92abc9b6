"""Being hit, startled or in cover: jolts of the body, from whose pose people recover, and the face behind the arms."""

from __future__ import annotations

from numpy.typing import ArrayLike

from encoders.corpus.engine.keyframed_actions import SIDED, UPPER, Cue, keyframed
from encoders.corpus.engine.keyframes import REST, KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES, HEIGHTS

GROUP = "sport"
Pose = dict[str, ArrayLike]


def _ready(c: Cue) -> tuple[list[KeyPose], Pose]:
    """Standing, or on guard before the blow; with the place to which the hands return."""
    if c.chance(0.55):
        return [key(c.r(0.1, 0.3), c.r(0.0, 0.5))], {"hands": REST}
    up, long = c.r(-0.4, 0.05), c.r(0.1, 0.28)
    hands: Pose = {"lead": c.about((-0.2, up, 0.32), 0.03), "off": c.about((-0.16, up, 0.45), 0.03)}
    stance: Pose = {"off_foot": (0.02, 0, long * 0.6), "lead_foot": (0.04, 0, -long * 0.6), "root": (0, -0.06, 0)}
    return [key(c.r(0.4, 0.6), c.r(0.1, 0.5), **hands, **stance)], hands


def _size(c: Cue) -> float:
    return {"small": 0.55, "": 1.0, "large": 1.5}[c.step.amplitude] * c.r(0.8, 1.25)


def _level(c: Cue) -> str:
    return c.step.height or ("low", "middle", "high")[int(c.rng.choice(3, p=[0.15, 0.5, 0.35]))]


def _jolted(c: Cue, jolt: Pose, after: Pose, away: tuple[float, float]) -> list[KeyPose]:
    """Jolts with a stagger in the direction `away` (to the leading side, forward), each with its recovery."""
    keys, hands = _ready(c)
    size = _size(c)
    for _ in range(c.times(1, 1)):
        far = 0.32 * size * c.r(0.5, 1.2)
        foot = "lead" if away[0] > 0 or (away[0] == 0 and c.chance(0.5)) else "off"
        aside = far * abs(away[0])
        keys += [
            key(c.r(0.07, 0.13), **jolt),
            key(c.r(0.16, 0.26), c.r(0.0, 0.15), **after, **{f"{foot}_foot": (aside, 0, far * away[1])},
                root=(0.6 * far * away[0], -0.1 * size, 0.6 * far * away[1])),
            key(c.r(0.35, 0.7), c.r(0.05, 0.4), spine=(0.05, 0, 0), pelvis=(0, 0, 0), head=(0, 0, 0), **hands,
                root=(0.5 * far * away[0], -0.03, 0.5 * far * away[1])),
        ]  # fmt: skip
    return [*keys, back(c.r(0.5, 0.8))] if c.chance(0.6) else keys


@keyframed(
    "hit reaction",
    group=GROUP,
    heights=HEIGHTS,
    amplitudes=AMPLITUDES,
    counts=(1, 3),
    speeds=(),
    styled=False,
    weight=2,
)
def hit_reaction(c: Cue) -> list[KeyPose]:
    """Struck from the front: the head snaps back, the trunk folds over the belly, or a leg gives way."""
    size, turn = _size(c), c.r(-0.35, 0.35)
    level = _level(c)
    if level == "high":
        jolt: Pose = {
            "head": (-0.7 * size, 0.3 * turn, turn),
            "spine": (-0.3 * size, 0, turn),
            "hands": (0.3, -0.7, 0.2),
        }
        face: Pose = {"lead": (-0.22, 0.15, 0.33)} if c.chance(0.4) else {"hands": (0.35, -0.5, 0.3)}
        return _jolted(c, jolt, {"head": (-0.2, 0, turn), "spine": (-0.15 * size, 0, turn), **face}, (0, -1))
    if level == "middle":
        fold = 0.55 * min(size, 1.4)
        jolt = {
            "spine": (fold, 0, turn),
            "pelvis": (0.25 * fold, 0, 0),
            "root": (0, -0.06, -0.14 * size),
            "head": (-0.2, 0, 0),
        }
        belly: Pose = {"lead": (-0.35, -0.5, 0.33), "off": (-0.38, -0.55, 0.36)} if c.chance(0.6) else {}
        return _jolted(c, {**jolt, "hands": (0.1, -0.5, 0.45)}, {"spine": (1.2 * fold, 0, 0), **belly}, (0, -1))
    jolt = {
        "lead_foot": (0.02, 0.1, -0.2),
        "root": (0.04, -0.12 * size, 0),
        "spine": (0.35, 0.2, 0),
        "pelvis": (0.15, 0.1, 0),
    }
    return _jolted(
        c, {**jolt, "off": (0.6, -0.4, 0.3)}, {"lead": (-0.02, -0.85, 0.3), "spine": (0.5, 0.1, 0)}, (0.3, -0.5)
    )


@keyframed(
    "hit from the side", group=GROUP, sides=SIDED, heights=HEIGHTS, amplitudes=AMPLITUDES, counts=(1, 3), speeds=(),
    styled=False, weight=1.5,
)  # fmt: skip
def hit_from_the_side(c: Cue) -> list[KeyPose]:
    """Struck on the named side: head, trunk or leg are thrown to the other."""
    size, level = _size(c), _level(c)
    if level == "high":
        jolt: Pose = {
            "head": (0.1, -0.6 * size, -0.7 * size),
            "spine": (0.1, -0.3 * size, -0.4 * size),
            "hands": (0.3, -0.7, 0.2),
        }
        after: Pose = {"head": (0.2, -0.3, -0.3), "spine": (0.2, -0.3 * size, -0.2)}
        face: Pose = {"lead": (-0.1, 0.2, 0.25)} if c.chance(0.4) else {"off": (0.5, -0.5, 0.2)}
        return _jolted(c, jolt, {**after, **face}, (-1, 0))
    if level == "middle":
        shoulder = c.chance(0.5)
        turn = 0.6 * size if shoulder else -0.1  # a shoulder is driven back, ribs fold over the blow
        jolt = {
            "spine": (0.1, -0.2 if shoulder else 0.3 * size, turn),
            "pelvis": (0, -0.15 * size, 0.2 * turn),
            "root": (-0.1 * size, -0.04, 0),
            "head": (0.1, 0.2, -0.3 * turn),
            "hands": (0.35, -0.6, 0.2),
        }
        hold: Pose = (
            {"off": (-0.55, -0.1 if shoulder else -0.5, 0.33)} if c.chance(0.4) else {"lead": (0.0, -0.6, 0.25)}
        )
        return _jolted(c, jolt, {"spine": (0.3, 0.15, 0.4 * turn), **hold}, (-1, -0.4 if shoulder else 0))
    jolt = {
        "lead_foot": (-0.12, 0.09, 0.0),
        "lead_knee": -0.5,
        "root": (0.05, -0.14 * size, 0),
        "spine": (0.3, -0.25, 0),
    }
    after = {"lead": (-0.02, -0.85, 0.25), "spine": (0.45, 0.1, 0.2), "lead_knee": 0.0}
    return _jolted(c, {**jolt, "off": (0.7, -0.3, 0.2)}, after, (-1, 0))


@keyframed(
    "hit from behind",
    group=GROUP,
    heights=("middle", "high"),
    amplitudes=AMPLITUDES,
    counts=(1, 3),
    speeds=(),
    styled=False,
)
def hit_from_behind(c: Cue) -> list[KeyPose]:
    """Struck in the back, which arches, or on the back of the head; a stagger forward."""
    size, turn = _size(c), c.r(-0.3, 0.3)
    if _level(c) == "high":
        jolt: Pose = {"head": (0.7 * size, 0, turn), "spine": (0.35 * size, 0, 0), "hands": (0.2, -0.6, 0.35)}
        rub: Pose = {"lead": (-0.28, 0.4, -0.05), "lead_elbow": 0.6} if c.chance(0.5) else {}
        return _jolted(c, jolt, {"head": (0.4, 0, 0), "spine": (0.4 * size, 0, 0), **rub}, (0, 1))
    jolt = {
        "spine": (-0.45 * min(size, 1.3), 0, turn),
        "head": (-0.5, 0, 0),
        "hands": (0.45, -0.5, -0.25),
        "root": (0, -0.03, 0.14),
    }
    return _jolted(c, jolt, {"spine": (0.35 * size, 0, 0), "head": (0.1, 0, 0), "hands": (0.3, -0.5, 0.3)}, (0, 1))


@keyframed("flinch", group=GROUP, directions=SIDED, amplitudes=AMPLITUDES, counts=(1, 3), speeds=(), styled=False)
def flinch(c: Cue) -> list[KeyPose]:
    """Start as at a bang: shoulders up, head drawn in, arms before the face, turned away."""
    size, keys = min(_size(c), 1.3), [key(0.1, c.r(0.1, 0.8))]
    way = c.toward or c.r(-1, 1)
    for _ in range(c.times(1, 1)):
        up = c.r(-0.15, 0.3)
        arms: Pose = (
            {"lead": (-0.15, up, 0.35), "off": (-0.2, up - 0.1, 0.4)}
            if c.chance(0.75)
            else {"hands": (0.15, -0.5, 0.35)}
        )
        keys += [
            key(c.r(0.1, 0.18), c.r(0.1, 0.6), **arms, shrugs=0.35, head=(0.35, 0.2 * way, 0.6 * way),
                spine=(0.3 * size, 0.2 * way, 0.35 * way), root=(0.04 * way, -0.12 * size, -0.08 * size), elbows=0.3),
            key(c.r(0.4, 0.8), c.r(0.0, 0.4), hands=(0.1, -0.7, 0.3), shrugs=0.1, head=(0, 0, 0), spine=(0.1, 0, 0),
                root=(0, -0.03, -0.02), elbows=0.0),
        ]  # fmt: skip
    return [*keys, back(0.6)]


@keyframed("guard face", group=GROUP, parts=UPPER, speeds=(), weight=1.5)
def guard_face(c: Cue) -> list[KeyPose]:
    """Both forearms upright before the face or the temples, chin down; held, and sometimes shaken by blows."""
    out, up, ahead = c.r(-0.3, -0.05), c.r(0.05, 0.3), c.r(0.24, 0.36)
    cover: Pose = {
        "lead": c.about((out, up, ahead), 0.02), "off": c.about((out, up, ahead + c.r(0.0, 0.06)), 0.02),
        "spine": (c.r(0.05, 0.35), 0, 0.0), "head": (c.r(0.1, 0.4), 0, 0.0), "shrugs": c.r(0.0, 0.25),
    }  # fmt: skip
    keys = [key(c.r(0.2, 0.45), c.r(0.3, 1.2), **cover)]
    for _ in range(int(c.rng.integers(0, 4))):
        shaken = {**cover, "spine": (c.r(0.0, 0.35), c.r(-0.15, 0.15), c.r(-0.25, 0.25))}
        keys += [key(c.r(0.15, 0.4), c.r(0.0, 0.3), **shaken)]
    return [*keys, back(c.r(0.4, 0.7))] if c.chance(0.7) else keys
