"""Keyframed actions: the decorator that turns functions from a cue to key poses into action programs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ARMS, BODY, Array, Curves
from encoders.corpus.engine.keyframes import KeyPose, key, play
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import Manner
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

HANDS = ("left", "right", "both")
SIDED = ("left", "right")
ONE_ARM = frozenset({"lead_arm"})
#: Wrist at the mouth: (outward, upward, forward) of its shoulder in arm lengths.
MOUTH = (-0.25, 0.14, 0.34)
UPPER = frozenset({"spine", "head", "left_arm", "right_arm"})

_TEMPO = {"": 1.0, "slow": 1.55, "fast": 0.66}
_SIZE = {"": 1.0, "small": 0.6, "large": 1.4}
_RIGHT_HANDED = 0.7


@dataclass
class Cue:
    """The context of one performance of a step: the leading side, and random choices.

    Attributes
    ----------
    step, manner, rng, frames
        The arguments of the program.
    lead : str
        Leading side: the step's, else random, mostly the right.
    """

    step: ActionStep
    manner: Manner
    rng: Generator
    frames: int
    lead: str = field(init=False)

    def __post_init__(self) -> None:
        if self.step.side in SIDED:
            self.lead = self.step.side
        elif self.step.direction in SIDED and self.rng.random() < 0.8:
            self.lead = self.step.direction
        else:
            self.lead = "right" if self.rng.random() < _RIGHT_HANDED else "left"

    @property
    def both(self) -> bool:
        """Whether both sides act."""
        return self.step.side == "both"

    @property
    def toward(self) -> float:
        """1 if the step's direction is the leading side, -1 if it is the other, 0 if it is neither."""
        if self.step.direction not in SIDED:
            return 0.0
        return 1.0 if self.step.direction == self.lead else -1.0

    def size(self, spread: float = 0.15) -> float:
        """Random factor of a gesture's size, by the step's amplitude and the performer's reach."""
        reach = 0.5 * float(np.clip(self.manner.reach, -0.6, 0.5))
        return float(_SIZE[self.step.amplitude] * np.exp(reach + self.rng.normal(0.0, spread)))

    def times(self, low: int, high: int, period: float = 0.0) -> int:
        """Number of repetitions: the step's count, else what fills `frames` at `period` seconds each, else random."""
        if self.step.count:
            return self.step.count
        if self.frames and period:
            return max(1, round(self.frames / FPS / period))
        return int(self.rng.integers(low, high + 1))

    def r(self, low: float, high: float) -> float:
        """A uniform random number."""
        return float(self.rng.uniform(low, high))

    def chance(self, share: float) -> bool:
        """True with this probability."""
        return bool(self.rng.random() < share)

    def about(self, centre: ArrayLike, spread: float = 0.06) -> Array:
        """`centre` with normal noise."""
        centre = np.asarray(centre, np.float64)
        return np.asarray(centre + self.rng.normal(0.0, 1.0, centre.shape) * spread)

    def height(self, low: float, middle: float, high: float) -> float:
        """The value for the step's height; random between low and high if unspecified."""
        named = {"low": low, "middle": middle, "high": high}.get(self.step.height)
        return self.r(low, high) if named is None else named


Blocking = Callable[[Cue], list[KeyPose]]
Finish = Callable[[Cue, Curves], None]


def keyframed(
    name: str,
    *,
    group: str,
    parts: Iterable[str] = BODY,
    precise: bool = False,
    finish: Finish | None = None,
    **attributes: object,
) -> Callable[[Blocking], Blocking]:
    """Register a function from a `Cue` to key poses as an action program.

    Parameters
    ----------
    parts : iterable of str
        Occupied body parts; "lead_arm" is the leading arm, or both.
    precise : bool
        Whether hands touch something, so that their positions vary little.
    finish : callable, optional
        Changes the curves, in place, after the key poses are played.
    **attributes
        As for `encoders.corpus.engine.program.program`.
    """
    owned = frozenset(parts)
    declared = owned - ONE_ARM | (ARMS if owned & ONE_ARM else frozenset())

    def register(blocking: Blocking) -> Blocking:
        @program(name, group=group, parts=declared, **attributes)
        def make(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
            cue = Cue(step, manner, rng, frames)
            pace = float(np.exp(-np.clip(manner.pace, -0.5, 0.4) + rng.normal(0.0, 0.12)))
            keys = blocking(cue)
            curves = play(
                keys, rng, lead=cue.lead, both=cue.both, tempo=_TEMPO[step.speed] * pace, frames=frames, parts=owned,
                precise=precise, reach=float(np.exp(0.3 * np.clip(manner.reach, -0.8, 0.5))),
            )  # fmt: skip
            if finish is not None:
                finish(cue, curves)
            return curves

        return blocking

    return register


def moved(place: ArrayLike, outward: float, upward: float, forward: float) -> Array:
    """A place shifted by an offset."""
    return np.asarray(np.asarray(place, np.float64) + np.array([outward, upward, forward]))


def grip(across: float, up: float, ahead: float, apart: float = 0.06) -> dict[str, ArrayLike]:
    """Both hands on one handle: `across` from the body's centre towards the leading side, in arm lengths."""
    return {
        "lead": (across - 0.34 + apart, up + apart, ahead),
        "off": (-across - 0.34 + apart, up - apart, ahead),
    }


def orbit(
    channel: str, centre: ArrayLike, first: ArrayLike, second: ArrayLike, turns: int, seconds: float
) -> list[KeyPose]:
    """Key poses that move a channel round an ellipse `turns` times: half axes `first` (its start) and `second`."""
    angle = np.arange(1, turns * 8 + 1)[:, None] * (np.pi / 4)
    points = np.asarray(centre) + np.cos(angle) * np.asarray(first) + np.sin(angle) * np.asarray(second)
    return [key(seconds / 8, **{channel: point}) for point in points]
