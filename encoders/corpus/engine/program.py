"""Action programs: functions that synthesise one action as curves, and the decorator that registers them.

A program is a function ``make(step, manner, rng, frames) -> Curves``: it performs one `ActionStep` with a canonical
body that starts at the origin, facing +Z. `frames` is a hint (0: as long as it takes). The decorator names it::

    @program("wave", group="gesture", parts={"right_arm"}, sides=("left", "right", "both"), counts=(2, 6))
    def wave(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves: ...
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from numpy.random import Generator

from encoders.corpus.engine.curves import BODY, Curves
from encoders.corpus.engine.style import Manner
from encoders.corpus.scene import ActionStep

ActionFunction = Callable[[ActionStep, Manner, Generator, int], Curves]

SPEEDS = ("slow", "fast")
AMPLITUDES = ("small", "large")
HEIGHTS = ("low", "middle", "high")


@dataclass(frozen=True)
class Program:
    """An action that can be synthesised, and the attributes with which it can be.

    Attributes
    ----------
    name : str
        Value of `ActionStep.action`.
    make : callable
        ``make(step, manner, rng, frames) -> Curves``.
    group : str
        "locomotion", "posture", "gesture", "sport", "object", "dance", "exercise".
    parts : frozenset of str
        Body parts it occupies unless a side narrows them down; `Curves.parts` of a result is exact.
    sides, directions, speeds, amplitudes, heights : tuple of str
        Values of the step's fields that it supports; "" (unspecified) is always allowed.
    degrees : tuple of int
        Angles that it supports.
    counts : (int, int) or None
        Smallest and largest count that it supports.
    styled : bool
        Whether a style changes it visibly.
    starts, ends : str
        Posture before and after: "stand", "sit", "kneel", "floor".
    weight : float
        Sampling weight, relative to the others.
    held_out : bool
        For evaluation only: never sampled, parsed from a sentence or trained on.
    """

    name: str
    make: ActionFunction
    group: str
    parts: frozenset[str] = BODY
    sides: tuple[str, ...] = ()
    directions: tuple[str, ...] = ()
    speeds: tuple[str, ...] = SPEEDS
    amplitudes: tuple[str, ...] = ()
    heights: tuple[str, ...] = ()
    degrees: tuple[int, ...] = ()
    counts: tuple[int, int] | None = None
    styled: bool = True
    starts: str = "stand"
    ends: str = "stand"
    weight: float = 1.0
    held_out: bool = False


#: Every program whose module has been imported, by name.
REGISTERED: dict[str, Program] = {}


def program(
    name: str, *, group: str, parts: Iterable[str] = BODY, **attributes: object
) -> Callable[[ActionFunction], ActionFunction]:
    """Register the decorated function as an action program; see `Program` for the attributes.

    Raises
    ------
    ValueError
        If the name is taken.
    """

    def register(make: ActionFunction) -> ActionFunction:
        if name in REGISTERED:
            raise ValueError(f"action program {name!r} is registered twice")
        REGISTERED[name] = Program(name, make, group, frozenset(parts), **attributes)  # type: ignore[arg-type]
        return make

    return register
