"""Waiting on one's feet, and the poses in which performers and characters stand before and between movements."""

from __future__ import annotations

from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import Cue, keyframed, moved
from encoders.corpus.engine.keyframes import REST, KeyPose, back, key

#: Where waiting people put their hands: hanging, folded before the belly, at the hips, behind the back, on the chest.
_HANDS: tuple[dict[str, ArrayLike], ...] = (
    {"hands": REST},
    {"lead": (-0.32, -0.72, 0.32), "off": (-0.34, -0.76, 0.34)},
    {"hands": (0.02, -0.66, 0.05), "elbows": 0.8},
    {"lead": (-0.3, -0.7, -0.33), "off": (-0.3, -0.74, -0.35)},
    {"lead": (-0.6, -0.36, 0.33), "off": (-0.58, -0.42, 0.38), "elbows": 0.4},
    {"hands": (0.02, -0.78, 0.12), "elbows": 0.3},
)


@keyframed("wait", group="posture", speeds=(), weight=1.5)
def wait(c: Cue) -> list[KeyPose]:
    """Shift the weight, look about, change the arms, put a foot elsewhere: at leisure, with long rests."""
    kept = _HANDS[int(c.rng.integers(len(_HANDS)))]
    keys = [key(c.r(0.3, 0.8), c.r(0.2, 1.5), **kept)]
    foot: ArrayLike = (0.0, 0.0, 0.0)
    for _ in range(c.times(2, 4, 2.0)):
        side = c.r(-1.0, 1.0)
        if c.chance(0.35):
            kept = _HANDS[int(c.rng.integers(len(_HANDS)))]
        if c.chance(0.35):
            foot = (c.r(0.0, 0.12), 0.0, c.r(-0.1, 0.12))
        look: ArrayLike = (c.r(-0.1, 0.3), 0.0, c.r(-0.8, 0.8)) if c.chance(0.5) else (c.r(0.0, 0.15), 0.0, 0.0)
        keys += [
            key(c.r(0.5, 1.1), c.r(0.4, 2.2), **kept, root=(0.07 * side, -0.012 * abs(side), c.r(-0.02, 0.02)),
                pelvis=(0, -0.12 * side, 0), spine=(c.r(0.0, 0.12), 0.12 * side, c.r(-0.12, 0.12)), head=look,
                lead_foot=foot)
        ]  # fmt: skip
    return [*keys, back(c.r(0.6, 1.0))] if c.chance(0.4) else keys


@keyframed("a-pose", group="gesture", parts=ARMS, speeds=(), styled=False)
def a_pose(c: Cue) -> list[KeyPose]:
    """Straight arms held slantwise down at the sides, half-way to a T."""
    out = c.r(0.55, 0.8)
    arms = moved((out, -((0.98 - out * out) ** 0.5), 0.03), 0.0, 0.0, c.r(-0.03, 0.08))
    return [key(c.r(0.4, 0.9), c.r(1.0, 3.0), hands=arms), *([back(0.7)] if c.chance(0.6) else [])]
