"""Manners and styles: the manner of a performer as a few numbers that change the body, and named styles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.arm_carriage import carry_idle_hands, sample_carriage
from encoders.corpus.engine.curves import Array, Curves
from encoders.corpus.engine.style_variants import STYLE_VARIANTS
from encoders.motion import FPS


@dataclass(frozen=True)
class Manner:
    """Body changes of one performer; all 0 is neutral.

    The first group are logarithms of factors, so that ``exp(manner.pace)`` multiplies a speed; the second group are
    angles in radians, the third shares of an arm's length or metres.
    """

    pace: float = 0.0  # overall tempo
    stride: float = 0.0  # step length
    swing: float = 0.0  # arm swing
    sway: float = 0.0  # sideways hip movement and roll
    bounce: float = 0.0  # rise and fall of the hips
    twist: float = 0.0  # counter-rotation of chest and hips
    width: float = 0.0  # distance of the feet
    reach: float = 0.0  # size of gestures

    bend: float = 0.0  # spine forward
    tilt: float = 0.0  # pelvis forward
    nod: float = 0.0  # head down
    roll: float = 0.0  # spine to the left
    toes: float = 0.0  # toes outward
    shrug: float = 0.0  # shoulders raised
    elbow: float = 0.0  # elbows turned outward

    apart: float = 0.0  # hands off the body, arm lengths
    raised: float = 0.0  # hands up and elbows bent, arm lengths
    ahead: float = 0.0  # hands forward, arm lengths
    crouch: float = 0.0  # hips lowered, metres
    lift: float = 0.0  # feet and knees raised in a step, metres
    wander: float = 0.0  # unsteadiness, metres
    tremble: float = 0.0  # fast small shaking, metres
    jerk: float = 0.0  # 0 smooth to 1 stop-and-go
    limp: float = 0.0  # positive spares the left leg, negative the right
    rock: float = 0.0  # shoulders tip from side to side with every step, radians
    pulse: float = 0.0  # hips and head bounce to a beat, metres
    splay: float = 0.0  # knees outward, radians

    carriage: str = ""  # where idle hands are held, a name of `encoders.corpus.engine.arm_carriage.CARRIAGES`

    def factor(self, field: str) -> float:
        """Factor of a logarithmic field, e.g. ``manner.factor("pace")``."""
        return float(np.exp(getattr(self, field)))


NEUTRAL = Manner()
_FIELDS = [field.name for field in fields(Manner) if field.name != "carriage"]

#: Body changes of each style at full strength.
STYLES: dict[str, dict[str, float]] = {
    "tired": {"pace": -0.3, "stride": -0.25, "swing": -0.35, "bend": 0.35, "nod": 0.35, "crouch": 0.03, "lift": -0.03,
        "bounce": -0.2, "ahead": 0.08, "reach": -0.3, "sway": 0.15},
    "old": {"pace": -0.45, "stride": -0.5, "swing": -0.6, "bend": 0.5, "nod": -0.15, "crouch": 0.07, "lift": -0.04,
        "raised": 0.12, "ahead": 0.15, "width": 0.15, "tremble": 0.004, "reach": -0.35},
    "angry": {"pace": 0.25, "stride": 0.1, "swing": 0.35, "bend": 0.15, "nod": 0.15, "apart": 0.1, "elbow": 0.4,
        "bounce": 0.3, "jerk": 0.3, "width": 0.2, "lift": 0.02, "raised": 0.08, "reach": 0.15, "shrug": 0.1},
    "happy": {"pace": 0.12, "stride": 0.05, "swing": 0.6, "bend": -0.1, "nod": -0.15, "bounce": 0.6, "sway": 0.35,
        "lift": 0.05, "apart": 0.08, "raised": 0.12, "twist": 0.3, "reach": 0.2, "elbow": 0.2,
        "pulse": 0.012},
    "proud": {"pace": -0.1, "stride": 0.1, "swing": 0.2, "bend": -0.28, "nod": -0.2, "apart": 0.14, "elbow": 0.4,
        "width": 0.15, "twist": 0.15, "toes": 0.2, "lift": 0.02},
    "sad": {"pace": -0.35, "stride": -0.35, "swing": -0.8, "bend": 0.28, "nod": 0.6, "lift": -0.04, "bounce": -0.4,
        "ahead": 0.04, "apart": -0.05, "reach": -0.4, "sway": -0.1},
    "drunk": {"pace": -0.25, "stride": -0.15, "wander": 0.14, "sway": 0.6, "width": 0.5, "bend": 0.15, "nod": 0.2,
        "apart": 0.18, "raised": 0.06, "twist": 0.3, "roll": 0.1},
    "limping": {"pace": -0.3, "stride": -0.2, "limp": 1.0, "bend": 0.1, "roll": 0.08, "swing": -0.3},
    "sneaking": {"pace": -0.5, "stride": 0.05, "swing": -0.5, "bend": 0.45, "crouch": 0.14, "lift": 0.08,
        "raised": 0.3, "ahead": 0.25, "nod": -0.3, "elbow": 0.2, "bounce": -0.5},
    "heavy": {"pace": -0.35, "stride": -0.05, "swing": -0.1, "width": 0.7, "sway": 0.7, "apart": 0.25, "elbow": 0.35,
        "bounce": 0.3, "lift": 0.06, "toes": 0.3, "bend": 0.05, "jerk": 0.1,
        "rock": 0.08, "splay": 0.25},
    "feminine": {"pace": -0.03, "stride": -0.1, "sway": 0.9, "width": -0.7, "swing": -0.05, "apart": 0.06,
        "elbow": -0.35, "bend": -0.05, "twist": 0.25, "toes": -0.05, "raised": 0.06, "bounce": 0.1},
    "masculine": {"pace": -0.03, "stride": 0.1, "sway": 0.1, "width": 0.45, "apart": 0.18, "elbow": 0.4,
        "swing": 0.15, "toes": 0.2, "twist": 0.2, "bend": -0.02, "shrug": 0.05,
        "rock": 0.04, "splay": 0.2},
    "childlike": {"pace": 0.25, "stride": -0.15, "swing": 0.8, "bounce": 0.8, "lift": 0.1, "apart": 0.16,
        "raised": 0.1, "sway": 0.3, "nod": -0.1, "reach": 0.3, "wander": 0.03, "twist": 0.3},
    "robotic": {"pace": -0.3, "jerk": 1.0, "sway": -1.5, "bounce": -1.0, "twist": -1.5, "raised": 0.22, "swing": 0.1,
        "bend": -0.08, "toes": -0.12},
    "zombie": {"pace": -0.5, "stride": -0.4, "swing": -1.5, "raised": 0.55, "ahead": 0.5, "bend": 0.2, "roll": 0.15,
        "nod": -0.1, "wander": 0.07, "lift": -0.05, "limp": 0.5, "width": 0.3},
    "scared": {"pace": 0.1, "stride": -0.4, "bend": 0.25, "nod": -0.1, "raised": 0.4, "ahead": 0.25, "apart": -0.05,
        "shrug": 0.3, "crouch": 0.07, "tremble": 0.006, "swing": -0.8, "reach": -0.25},
    "confident": {"pace": 0.05, "stride": 0.15, "swing": 0.35, "bend": -0.15, "nod": -0.08, "apart": 0.08,
        "twist": 0.25, "width": 0.1},
    "relaxed": {"pace": -0.2, "stride": -0.05, "swing": 0.1, "bend": 0.02, "sway": 0.2, "bounce": -0.1, "tilt": -0.08,
        "reach": -0.1},
    "injured": {"pace": -0.5, "stride": -0.4, "limp": 1.0, "bend": 0.4, "roll": 0.12, "raised": 0.2, "ahead": 0.1,
        "swing": -0.7, "nod": 0.15},
    "cool": {"pace": -0.15, "stride": 0.05, "sway": 0.45, "swing": 0.25, "bend": -0.1, "tilt": -0.15, "roll": 0.06,
        "apart": 0.15, "elbow": 0.25, "twist": 0.45, "bounce": 0.3, "toes": 0.3, "width": 0.3, "nod": -0.1,
        "rock": 0.05},
    "energetic": {"pace": 0.3, "stride": 0.12, "swing": 0.5, "bounce": 0.5, "lift": 0.06, "raised": 0.15,
        "elbow": 0.1, "reach": 0.25, "twist": 0.2},
    "elegant": {"pace": -0.15, "stride": 0.02, "bend": -0.16, "nod": -0.12, "width": -0.5, "sway": 0.3, "swing": -0.1,
        "elbow": -0.1, "apart": 0.05, "bounce": -0.3},
    "shy": {"pace": -0.2, "stride": -0.35, "swing": -0.8, "bend": 0.2, "nod": 0.4, "apart": -0.05, "raised": 0.1,
        "ahead": 0.15, "width": -0.4, "shrug": 0.15, "toes": -0.15, "reach": -0.4,
        "splay": -0.1},
    "tough": {"pace": -0.1, "stride": 0.1, "swing": 0.35, "bend": 0.15, "nod": -0.3, "apart": 0.22, "elbow": 0.5,
        "shrug": 0.12, "width": 0.7, "toes": 0.4, "splay": 0.35, "rock": 0.14, "twist": 0.6, "sway": 0.3,
        "bounce": 0.2, "crouch": 0.03, "reach": 0.15, "tilt": -0.1},
    "musical": {"pace": 0.03, "swing": 0.4, "bounce": 0.8, "pulse": 0.03, "sway": 0.7, "twist": 0.5, "raised": 0.2,
        "apart": 0.12, "elbow": 0.2, "rock": 0.08, "lift": 0.05, "reach": 0.15, "nod": -0.05, "width": 0.2},
}  # fmt: skip


def _row(changes: Mapping[str, float]) -> Array:
    return np.array([changes.get(field, 0.0) for field in _FIELDS])


_STYLE_ROWS = np.stack([_row(style) for style in STYLES.values()])
_OTHER_ROWS = {name: np.stack([_row(way) for way in ways]) for name, ways in STYLE_VARIANTS.items()}
#: Standard deviation between performers, by field.
_INDIVIDUAL = Manner(
    pace=0.12, stride=0.12, swing=0.4, sway=0.35, bounce=0.25, twist=0.35, width=0.3, reach=0.15, bend=0.09, tilt=0.07,
    nod=0.12, roll=0.03, toes=0.12, shrug=0.05, elbow=0.2, apart=0.06, raised=0.06, ahead=0.05, crouch=0.012,
    lift=0.015, wander=0.008, tremble=0.0005, jerk=0.05, limp=0.04, rock=0.025, pulse=0.001, splay=0.06,
)  # fmt: skip
_INDIVIDUAL_ROW = np.array([getattr(_INDIVIDUAL, field) for field in _FIELDS])


def sample_individual(rng: Generator) -> Array:
    """The individual manner of a random performer: a row of manner fields.

    Besides noise in every field, a share of one or two styles is mixed in.
    """
    row = rng.normal(0.0, 1.0, len(_FIELDS)) * _INDIVIDUAL_ROW
    strength = rng.uniform(0.0, 0.6, 2) * (rng.random(2) < 0.6)
    return np.asarray(row + strength @ _STYLE_ROWS[rng.integers(0, len(STYLES), 2)])


def sample_manner(
    style: str, individual: Array, rng: Generator, *, styles: Mapping[str, Mapping[str, float]] = STYLES
) -> Manner:
    """Manner of a performer in a style ("" for none), which hides much of the individual manner.

    `styles` gives each known style's body changes at full strength.

    Raises
    ------
    KeyError
        If the style is unknown.
    """
    row = individual
    if style:
        own = _sample_style(style, styles, rng)
        # Performers weight the fields of a style differently.
        means = np.exp(rng.normal(0.0, 0.3, len(_FIELDS))) * np.where(rng.random(len(_FIELDS)) < 0.12, 0.25, 1.0)
        row = 0.5 * individual + own * _strength(rng) * means
    row = np.clip(row, _LEAST, _MOST)
    manner = Manner(**dict(zip(_FIELDS, row.tolist(), strict=True)), carriage=sample_carriage(style, rng))
    return manner if rng.random() < 0.5 else replace(manner, roll=-manner.roll, limp=-manner.limp)


#: Limits of each field, so that a strong style stays plausible.
_LEAST, _MOST = np.full(len(_FIELDS), -2.0), np.full(len(_FIELDS), 2.0)
for _field, _low, _high in (
    ("pace", -0.8, 0.55), ("stride", -0.8, 0.45), ("bend", -0.5, 1.1), ("nod", -0.7, 1.0), ("tilt", -0.35, 0.35),
    ("crouch", -0.01, 0.2), ("lift", -0.08, 0.25), ("rock", -0.02, 0.3), ("pulse", 0.0, 0.07), ("splay", -0.4, 0.7),
    ("apart", -0.12, 0.6), ("shrug", -0.25, 0.5), ("toes", -0.4, 0.8),
):  # fmt: skip
    _LEAST[_FIELDS.index(_field)], _MOST[_FIELDS.index(_field)] = _low, _high


def _sample_style(style: str, styles: Mapping[str, Mapping[str, float]], rng: Generator) -> Array:
    """The usual variant of a style, or a mix of it with another variant."""
    own = _row(styles[style])
    others = _OTHER_ROWS.get(style)
    if others is None or rng.random() < 0.4:
        return own
    return np.asarray(own + rng.uniform(0.4, 1.0) * (others[int(rng.integers(len(others)))] - own))


def _strength(rng: Generator) -> float:
    """Random strength of a style: mostly clear, sometimes faint or exaggerated."""
    return float(rng.uniform(1.2, 1.9) if rng.random() < 0.25 else rng.uniform(0.55, 1.3))


def _pulse(frames: int, rng: Generator, knots_per_second: float) -> Array:
    """Smooth random curve (F,) of unit variance."""
    count = max(int(frames / 20 * knots_per_second) + 3, 4)
    return np.interp(np.linspace(0, count - 1, frames), np.arange(count), rng.normal(0.0, 1.0, count))


def apply_manner(curves: Curves, manner: Manner, rng: Generator) -> None:
    """Apply a manner to the body of `curves`, in place: posture and unsteadiness (not tempo and stride)."""
    frames = len(curves)
    curves.spine[:, 0] += manner.bend
    curves.spine[:, 1] += manner.roll
    curves.pelvis[:, 0] += manner.tilt
    curves.head[:, 0] += manner.nod - 0.7 * manner.bend - 0.5 * manner.tilt
    curves.root[:, 1] -= max(manner.crouch, -0.01)
    curves.foot_yaw[:] += np.array([manner.toes, -manner.toes])
    curves.shrug[:] += manner.shrug
    curves.elbow[:] += manner.elbow
    curves.knee[:] += np.array([manner.splay, -manner.splay])
    _plant_wide(curves, manner)
    if manner.pulse > 0.004 or manner.rock > 0.05:
        _bounce_to_a_beat(curves, manner, rng)
    if manner.carriage:
        carry_idle_hands(curves, rng, manner.carriage)
    # Busy arms (raised, or reaching for a place in the world) are changed less.
    busy = np.clip((curves.hands[..., 1] + 0.9) / 0.5, 0.0, 1.0)
    idle = (1.0 - busy) * (1.0 - curves.reach_weight)
    carried = 0.3 if manner.carriage else 1.0
    curves.hands[..., 0] += carried * manner.apart * (0.25 + 0.75 * idle)
    curves.hands[..., 1] += max(manner.raised, -0.04) * idle
    curves.hands[..., 2] += (manner.ahead + 0.6 * max(manner.raised, 0.0)) * idle
    if manner.wander > 0.01:
        curves.root[:, 0] += 0.4 * manner.wander * _pulse(frames, rng, 1.0)
        curves.spine[:, 1] += 1.2 * manner.wander * _pulse(frames, rng, 0.8)
        curves.spine[:, 0] += 1.0 * manner.wander * _pulse(frames, rng, 0.8)


def _plant_wide(curves: Curves, manner: Manner) -> None:
    """Widen the stance of a body that stands, in place."""
    feet = curves.feet
    if np.ptp(feet, axis=0).max() > 0.02 or curves.root[:, 1].min() < 0.7 or np.ptp(curves.heading) > 0.2:
        return
    out = 0.045 * float(np.clip(manner.width, -1.0, 1.6))
    aside = np.array([np.cos(curves.heading[0]), 0.0, -np.sin(curves.heading[0])])
    feet[:, 0] += out * aside
    feet[:, 1] -= out * aside


def _bounce_to_a_beat(curves: Curves, manner: Manner, rng: Generator) -> None:
    """Bounce knees, head and trunk to a beat where the feet are still, in place."""
    pace = np.abs(np.diff(curves.root[:, [0, 2]], axis=0, prepend=curves.root[:1, [0, 2]])).sum(1) * FPS
    still = np.clip(1.0 - pace / 0.4, 0.0, 1.0)
    beat = 2 * np.pi * (rng.uniform(1.4, 2.2) * np.arange(len(curves)) / FPS + rng.random())
    give = still * 0.5 * (1.0 - np.cos(beat))
    curves.root[:, 1] -= 1.3 * manner.pulse * give
    curves.head[:, 0] += 5.0 * manner.pulse * give
    sway = still * (manner.pulse + 0.12 * max(manner.rock, 0.0)) * np.sin(beat / 2)
    curves.spine[:, 1] += 2.5 * sway
    curves.root[:, 0] += 0.7 * sway * np.cos(curves.heading)
    curves.root[:, 2] -= 0.7 * sway * np.sin(curves.heading)
