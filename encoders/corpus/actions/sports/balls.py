"""Ball games: throwing, catching, kicking, bowling, volleyball."""

from __future__ import annotations

import numpy as np

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import HANDS, SIDED, UPPER, Cue, keyframed
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "sport"


def _ending(c: Cue) -> list[KeyPose]:
    return [back(c.r(0.6, 0.9))] if c.chance(0.8) else [key(0.2, 0.2)]


@keyframed("throw", group=GROUP, sides=HANDS, speeds=("slow", "fast"), amplitudes=AMPLITUDES, counts=(1, 4), weight=3)
def throw(c: Cue) -> list[KeyPose]:
    """Overhand: the hand goes back behind the head, the other foot steps, the arm whips over and follows through."""
    size, keys = c.size(), list[KeyPose]()
    for _ in range(c.times(1, 2)):
        turn, stride = 0.5 * size * c.r(0.6, 1.2), c.r(0.0, 0.4) * size
        if c.both:
            keys += [
                key(c.r(0.4, 0.6), 0.1, hands=(-0.1, 0.55, -0.15), spine=(-0.2, 0, 0), root=(0, -0.02, -0.04)),
                key(
                    0.14,
                    hands=(-0.2, 0.5, 0.75),
                    spine=(0.1, 0, 0),
                    off_foot=(0, 0, stride),
                    root=(0, -0.04, stride / 2),
                ),
                key(0.14, 0.1, hands=(-0.1, -0.3, 0.85), spine=(0.35, 0, 0)),
            ]
        else:
            keys += [
                key(c.r(0.35, 0.6), c.r(0.0, 0.2), lead=(0.45, 0.3, -0.4), off=(0.1, -0.1, 0.75),
                spine=(-0.08, 0.05, turn),
                    root=(0.03, -0.02, -0.06), head=(0, 0, -turn)),
                key(c.r(0.17, 0.25), lead=(0.1, 0.45, 0.75), off=(0.3, -0.5, 0.2), spine=(0.1, -0.1, -0.3 * turn),
                    off_foot=(0, 0, stride), root=(-0.02, -0.04, stride / 2), head=(0, 0, 0)),
                key(c.r(0.14, 0.2), 0.1, lead=(-0.5, -0.5, 0.6), spine=(0.35, -0.1, -turn), head=(0, 0, 0.4 * turn)),
            ]  # fmt: skip
        keys += [back(c.r(0.5, 0.9))]
    return keys


@keyframed("throw underhand", group=GROUP, sides=HANDS, counts=(1, 4))
def throw_underhand(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        stride = c.r(0.0, 0.35)
        keys += [
            key(c.r(0.35, 0.6), 0.05, hand=(0.15, -0.8, -0.45), spine=(0.15, 0, 0.25)),
            key(
                0.22, hand=(0.0, -0.6, 0.6), spine=(0.2, 0, -0.1), off_foot=(0, 0, stride), root=(0, -0.06, stride / 2)
            ),
            key(0.15, 0.15, hand=(-0.05, 0.05, 0.9), spine=(0.02, 0, -0.15)),
            back(c.r(0.6, 0.9)),
        ]
    return keys


@keyframed("catch", group=GROUP, sides=HANDS, heights=("low", "middle", "high"), counts=(1, 4))
def catch(c: Cue) -> list[KeyPose]:
    up, keys = c.height(-0.6, -0.15, 0.75), list[KeyPose]()
    hand = "hand" if c.step.side else "hands"
    for _ in range(c.times(1, 2)):
        x = c.r(-0.32, -0.15)
        keys += [
            key(
                c.r(0.25, 0.45), c.r(0.05, 0.3), **{hand: (x + 0.08, up, 0.78 if up < 0.6 else 0.4)}, root=(0, -0.04, 0)
            ),
            key(0.14, **{hand: (x - 0.02, up - 0.05, 0.62 if up < 0.6 else 0.36)}),
            key(0.25, c.r(0.2, 0.6), **{hand: (x - 0.05, max(up - 0.35, -0.45), 0.38)}, root=(0, -0.02, -0.03)),
        ]
    return [*keys, *_ending(c)]


@keyframed("pass ball", group=GROUP, parts=ARMS, counts=(1, 4))
def pass_ball(c: Cue) -> list[KeyPose]:
    """Chest pass."""
    up, keys = c.r(-0.3, -0.1), list[KeyPose]()
    for _ in range(c.times(1, 2)):
        keys += [
            key(0.4, c.r(0.1, 0.4), hands=(-0.22, up, 0.32), elbows=0.4),
            key(c.r(0.14, 0.22), 0.15, hands=(-0.18, up + 0.05, 0.95), elbows=0.0, spine=(0.15, 0, 0),
                lead_foot=(0, 0, c.r(0.0, 0.3)), root=(0, -0.03, 0.1)),
        ]  # fmt: skip
        keys += [back(0.7)]
    return keys


@keyframed("dribble", group=GROUP, parts=UPPER, sides=HANDS, amplitudes=AMPLITUDES, counts=(3, 12), weight=2)
def dribble(c: Cue) -> list[KeyPose]:
    """Bounce a ball beside the body; with both hands it crosses over from one to the other."""
    beat, high = c.r(0.22, 0.34), c.r(0.12, 0.26) * c.size(0.2)
    place = c.about((c.r(0.05, 0.4), c.r(-0.68, -0.5), c.r(0.15, 0.5)), 0.03)
    push, crouch = np.array([0.0, -high, 0.03]), c.r(0.0, 0.12)
    keys = [key(0.5, lead=place + -push, spine=(0.2, 0, 0), root=(0, -crouch, 0))]
    for index in range(c.times(5, 12, 2 * beat)):
        hand = "off" if c.both and index % 2 else "lead"
        dip = {"spine": (0.25, 0, 0)} if c.chance(0.5) else {"spine": (0.18, 0, 0)}
        keys += [key(beat, **{hand: place + push}, **dip), key(beat, **{hand: place - push})]
    return [*keys, back(0.6)]


@keyframed("shoot basketball", group=GROUP, counts=(1, 3), weight=1.5)
def shoot_basketball(c: Cue) -> list[KeyPose]:
    """Gather at the chest, bend, rise and push the ball up over the head; often with a hop."""
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        hop = c.r(0.08, 0.25) if c.chance(0.5) else 0.0
        keys += [
            key(c.r(0.4, 0.6), 0.1, lead=(-0.22, -0.25, 0.4), off=(-0.25, -0.25, 0.42), spine=(0.15, 0, 0)),
            key(c.r(0.25, 0.35), lead=(-0.2, -0.2, 0.38), off=(-0.25, -0.2, 0.4), root=(0, -0.16, 0),
                spine=(0.3, 0, 0)),
            key(0.22, lead=(-0.2, 0.42, 0.3), off=(-0.28, 0.35, 0.3), root=(0, 0.02 + hop * 0.6, 0), spine=(0, 0, 0),
                feet=(0, hop * 0.5, 0)),
            key(0.16, 0.1, lead=(-0.15, 0.85, 0.45), off=(-0.1, 0.65, 0.35), root=(0, 0.03 + hop, 0.03),
                feet=(0, hop, 0)),
            key(0.22, 0.1, lead=(-0.1, 0.75, 0.5), root=(0, -0.08, 0.03), feet=(0, 0, 0), spine=(0.1, 0, 0)),
            back(c.r(0.6, 0.9)),
        ]  # fmt: skip
    return keys


@keyframed("kick ball", group=GROUP, sides=SIDED, amplitudes=AMPLITUDES, counts=(1, 3), weight=2)
def kick_ball(c: Cue) -> list[KeyPose]:
    """A step of the standing leg, the kicking leg swung back and through, the arms against it."""
    size, keys = c.size(), list[KeyPose]()
    for _ in range(c.times(1, 1)):
        stride, lift = c.r(0.15, 0.45), c.r(0.2, 0.5) * size
        keys += [
            key(c.r(0.3, 0.45), off_foot=(0, 0, stride), root=(-0.06, -0.03, stride * 0.8), off=(0.3, -0.7, -0.2)),
            key(c.r(0.18, 0.28), lead_foot=(0.08, 0.3 * size, stride - 0.45), lead_toes=-0.9, lead=(0.3, -0.75, 0.4),
                off=(0.5, -0.6, 0.1), spine=(0.15, 0, 0.15), pelvis=(0.15, 0, 0.2), root=(-0.08, -0.06, stride)),
            key(c.r(0.12, 0.18), lead_foot=(-0.02, 0.03, stride + 0.15), lead_toes=-0.5, pelvis=(-0.1, 0, -0.1)),
            key(c.r(0.13, 0.2), 0.05, lead_foot=(-0.1, lift, stride + 0.65), lead_toes=0.1, lead=(0.3, -0.7, -0.4),
                off=(0.1, -0.55, 0.5), spine=(0.1, 0, -0.2), pelvis=(-0.3, 0, -0.25)),
            key(c.r(0.3, 0.45), lead_foot=(0.02, 0.0, stride + c.r(0.0, 0.3)), lead_toes=0.0, pelvis=(0, 0, 0),
                root=(0, -0.02, stride + 0.05), spine=(0.05, 0, 0)),
        ]  # fmt: skip
        keys += [back(0.9)]
    return keys


@keyframed("header", group=GROUP, counts=(1, 4))
def header(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 2)):
        hop = c.r(0.0, 0.2)
        keys += [
            key(0.35, spine=(-0.25, 0, 0), head=(-0.35, 0, 0), root=(0, -0.1, -0.03), hands=(0.4, -0.5, 0.1)),
            key(
                0.16,
                spine=(0.3, 0, 0),
                head=(0.3, 0, 0),
                root=(0, hop, 0.05),
                feet=(0, hop, 0),
                hands=(0.35, -0.6, -0.3),
            ),
            key(0.25, root=(0, -0.05, 0), feet=(0, 0, 0)),
            back(0.6),
        ]
    return keys


@keyframed("bowl", group=GROUP, sides=SIDED)
def bowl(c: Cue) -> list[KeyPose]:
    """Roll a ball: steps, a long backswing, a deep lunge and release near the ground."""
    return [
        key(0.5, 0.3, hands=(-0.25, -0.25, 0.4)),
        key(0.4, lead_foot=(0, 0, 0.3), root=(0, -0.03, 0.2), lead=(0.05, -0.7, 0.6), off=(0.1, -0.6, 0.5)),
        key(0.45, off_foot=(0, 0, 0.75), root=(0, -0.15, 0.45), lead=(0.15, -0.55, -0.7), off=(0.6, -0.4, 0.3),
            spine=(0.5, 0, 0.2), head=(-0.3, 0, 0)),
        key(0.25, root=(0, -0.3, 0.6), lead=(0.0, -0.9, 0.3), spine=(0.6, 0, 0), lead_foot=(-0.15, 0.0, 0.15)),
        key(0.2, c.r(0.3, 0.7), lead=(-0.1, 0.25, 0.8), spine=(0.35, 0, -0.2), root=(0, -0.22, 0.62)),
        back(1.2),
    ]  # fmt: skip


@keyframed("volleyball bump", group=GROUP, counts=(1, 4))
def volleyball_bump(c: Cue) -> list[KeyPose]:
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 3)):
        keys += [
            key(0.4, 0.1, hands=(-0.3, -0.7, 0.6), root=(0, -0.2, 0), spine=(0.3, 0, 0)),
            key(0.2, 0.1, hands=(-0.3, -0.25, 0.9), root=(0, -0.05, 0.03), spine=(0.1, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("spike", group=GROUP, sides=SIDED, counts=(1, 3))
def spike(c: Cue) -> list[KeyPose]:
    """Jump and strike down from above the head."""
    keys: list[KeyPose] = []
    for _ in range(c.times(1, 1)):
        hop = c.r(0.2, 0.4)
        keys += [
            key(0.35, root=(0, -0.25, 0), spine=(0.4, 0, 0), hands=(0.15, -0.7, -0.55)),
            key(0.2, root=(0, 0.05, 0.03), spine=(-0.1, 0, 0), hands=(0.1, 0.5, 0.5)),
            key(0.2, root=(0, hop, 0.06), feet=(0, hop, 0), lead=(0.35, 0.5, -0.35), off=(0.05, 0.8,
                0.4), spine=(-0.25, 0, 0.3)),
            key(0.16, root=(0, hop * 0.7, 0.08), feet=(0, hop * 0.7, 0), lead=(-0.1, 0.3, 0.8), off=(0.1, -0.2, 0.3),
                spine=(0.25, 0, -0.3)),
            key(0.2, 0.05, root=(0, -0.15, 0.1), feet=(0, 0, 0.08), lead=(-0.3, -0.5, 0.4), spine=(0.4, 0, 0)),
            back(0.7),
        ]  # fmt: skip
    return keys


@keyframed("juggle", group=GROUP, parts=ARMS, counts=(4, 12))
def juggle(c: Cue) -> list[KeyPose]:
    beat, up = c.r(0.16, 0.24), c.r(-0.55, -0.35)
    keys = [key(0.5, hands=(-0.05, up, 0.45), head=(-0.15, 0, 0))]
    for _ in range(c.times(5, 12, 2 * beat)):
        keys += [
            key(beat, lead=(-0.15, up + 0.16, 0.47), off=(0.0, up - 0.06, 0.45)),
            key(beat, lead=(0.0, up - 0.06, 0.45), off=(-0.15, up + 0.16, 0.47)),
        ]
    return [*keys, back(0.6)]
