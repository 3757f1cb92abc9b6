"""Musical instruments."""

from __future__ import annotations

from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.keyframed_actions import SIDED, UPPER, Cue, keyframed, moved
from encoders.corpus.engine.keyframes import KeyPose, back, key
from encoders.corpus.engine.program import AMPLITUDES

GROUP = "object"


@keyframed("play guitar", group=GROUP, parts=ARMS, sides=SIDED, amplitudes=AMPLITUDES, counts=(3, 12), weight=1.5)
def play_guitar(c: Cue) -> list[KeyPose]:
    """One hand strums before the belly, the other holds the neck out at the side."""
    size, beat, groove = c.size(0.25), c.r(0.16, 0.32), c.r(0.0, 0.12)
    strings, neck = c.about((-0.3, -0.5, 0.34), 0.02), c.about((0.3, c.r(-0.4, -0.1), 0.5), 0.04)
    keys = [key(0.7, lead=moved(strings, 0.05, 0.1, 0), off=neck, off_elbow=0.1, head=(0.15, 0, -0.3))]
    for index in range(c.times(4, 10, 2 * beat)):
        slide = moved(neck, -0.1 * (index % 3 == 0), 0.04 * (index % 3 == 1), 0)
        keys += [
            key(
                beat,
                lead=moved(strings, -0.02, -0.12 * size, 0.02),
                head=(0.15 + groove, 0, -0.3),
                root=(0, -0.1 * groove, 0),
            ),
            key(
                beat,
                lead=moved(strings, 0.05, 0.1 * size, 0.02),
                off=slide,
                head=(0.15 - groove, 0, -0.3),
                root=(0, 0, 0),
            ),
        ]
    return [*keys, back(0.7)]


@keyframed("play violin", group=GROUP, parts=ARMS, sides=SIDED, counts=(2, 8), weight=1.3, precise=True)
def play_violin(c: Cue) -> list[KeyPose]:
    """The leading hand bows before the chest; the other holds the neck out from the chin."""
    beat = c.r(0.3, 0.7)
    keys = [
        key(
            0.7,
            off=(0.0, 0.0, 0.6),
            off_elbow=-0.6,
            lead=(-0.4, -0.05, 0.45),
            lead_elbow=0.4,
            head=(0.15, -0.25, -0.45),
        )
    ]
    for _ in range(c.times(3, 6, 2 * beat)):
        keys += [
            key(beat * c.r(0.7, 1.2), lead=(0.15, -0.28, 0.62), spine=(0, 0.05, 0.06)),
            key(beat * c.r(0.7, 1.2), lead=(-0.45, 0.0, 0.42), spine=(0, -0.05, -0.05)),
        ]
    return [*keys, back(0.7)]


@keyframed("play piano", group=GROUP, parts=ARMS, weight=1.2)
def play_piano(c: Cue) -> list[KeyPose]:
    """The hands wander along the keys with small strokes."""
    keys = [key(0.7, hands=(-0.15, -0.45, 0.55), head=(0.2, 0, 0))]
    for _ in range(c.times(8, 18, 0.4)):
        spots = [moved((-0.12, -0.45, 0.55), c.r(-0.15, 0.35), 0, 0) for _ in range(2)]
        beat = c.r(0.14, 0.3)
        keys += [
            key(beat, lead=moved(spots[0], 0, 0.08, 0), off=spots[1]),
            key(beat, lead=spots[0], off=moved(spots[1], 0, 0.08, 0), spine=(0.08, c.r(-0.06, 0.06), 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("play drums", group=GROUP, parts=UPPER, amplitudes=AMPLITUDES, counts=(4, 12), weight=1.2)
def play_drums(c: Cue) -> list[KeyPose]:
    size, beat = c.size(0.25), c.r(0.13, 0.24)
    drum = {"lead": c.about((0.0, -0.45, 0.55), 0.05), "off": c.about((-0.05, -0.45, 0.55), 0.05)}
    rise = 0.28 * size
    keys = [key(0.6, lead=moved(drum["lead"], 0, rise, 0), off=drum["off"], spine=(0.1, 0, 0))]
    for _ in range(c.times(5, 12, 2 * beat)):
        aside = 0.3 if c.chance(0.2) else 0.0
        keys += [
            key(
                beat,
                lead=moved(drum["lead"], aside, 0.6 * aside, 0),
                off=moved(drum["off"], 0, rise, 0),
                head=(0.12, 0, 0),
            ),
            key(beat, lead=moved(drum["lead"], 0, rise, 0), off=drum["off"], head=(-0.02, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("play trumpet", group=GROUP, parts=UPPER, precise=True)
def play_trumpet(c: Cue) -> list[KeyPose]:
    keys = [key(0.7, lead=(-0.25, 0.08, 0.5), off=(-0.3, 0.04, 0.42), elbows=0.4, spine=(-0.1, 0, 0))]
    for _ in range(c.times(2, 5, 0.9)):
        keys += [
            key(0.4, 0.1, spine=(-0.18, 0.05, 0), head=(-0.1, 0, 0)),
            key(0.4, 0.1, spine=(-0.03, -0.05, 0), head=(0, 0, 0)),
        ]
    return [*keys, back(0.7)]


@keyframed("play flute", group=GROUP, parts=ARMS, sides=SIDED, precise=True)
def play_flute(c: Cue) -> list[KeyPose]:
    keys = [key(0.7, lead=(0.15, 0.12, 0.4), off=(-0.5, 0.12, 0.4), elbows=0.3, head=(0.05, 0.1, -0.3))]
    for _ in range(c.times(2, 5, 0.9)):
        keys += [key(0.4, spine=(0, 0.06, 0.08)), key(0.4, spine=(0, -0.06, -0.05))]
    return [*keys, back(0.7)]
