"""The registry of action programs: what the corpus can act out, and with which particulars.

A program is a function ``make(step, manner, rng, frames) -> Curves``: it acts out one `ActionStep` for a canonical body
that begins at the origin, facing +Z. `frames` is a hint (0: as long as it takes). The decorator names it::

    @program("wave", group="gesture", parts={"right_arm"}, sides=("left", "right", "both"), counts=(2, 6))
    def wave(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves: ...
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from numpy.random import Generator

from encoders.corpus.engine.curves import ARMS, BODY, Curves
from encoders.corpus.engine.style import STYLES, Manner
from encoders.corpus.scene import ActionStep

Make = Callable[[ActionStep, Manner, Generator, int], Curves]

#: Modules that register programs when imported.
MODULES = (
    "locomotion",
    "turning",
    "stepping",
    "closed_paths",
    "unsteady",
    "jumps",
    "climbing",
    "posture",
    "bending",
    "bowing",
    "floor",
    "acrobatics",
    "gestures",
    "sports",
    "objects",
    "dance",
    "exercise",
    "stretching",
)
#: The module of programs that are only measured with.
HELD_OUT = "encoders.corpus.heldout.actions"

SPEEDS = ("slow", "fast")
AMPLITUDES = ("small", "large")


@dataclass(frozen=True)
class Program:
    """An action that can be acted out.

    Attributes
    ----------
    name : str
        What `ActionStep.action` calls it.
    make : callable
        ``make(step, manner, rng, frames) -> Curves``.
    group : str
        "locomotion", "posture", "gesture", "sport", "object", "dance", "exercise".
    parts : frozenset of str
        Parts it needs, where a side does not change them; the curves it makes say exactly.
    sides, directions, speeds, amplitudes, heights : tuple of str
        Values of the step's fields that it honours; "" is always allowed.
    counts : (int, int) or None
        Smallest and largest count that it honours.
    styled : bool
        Whether a style changes it visibly.
    starts, ends : str
        Posture before and after: "stand", "sit", "kneel", "floor".
    weight : float
        How often to draw it, relative to the others.
    held_out : bool
        Only to measure with: never drawn, read out of sentences or trained on.
    """

    name: str
    make: Make
    group: str
    parts: frozenset[str] = BODY
    sides: tuple[str, ...] = ()
    directions: tuple[str, ...] = ()
    speeds: tuple[str, ...] = SPEEDS
    amplitudes: tuple[str, ...] = ()
    heights: tuple[str, ...] = ()
    counts: tuple[int, int] | None = None
    styled: bool = True
    starts: str = "stand"
    ends: str = "stand"
    weight: float = 1.0
    held_out: bool = False


_REGISTRY: dict[str, Program] = {}


def program(name: str, *, group: str, parts: Iterable[str] = BODY, **particulars: object) -> Callable[[Make], Make]:
    """Register the decorated function as an action program; see `Program` for the particulars.

    Raises
    ------
    ValueError
        If the name is taken.
    """

    def register(make: Make) -> Make:
        if name in _REGISTRY:
            raise ValueError(f"action program {name!r} is registered twice")
        _REGISTRY[name] = Program(name, make, group, frozenset(parts), **particulars)  # type: ignore[arg-type]
        return make

    return register


@functools.cache
def programs() -> dict[str, Program]:
    """All programs by name, but those held out."""
    for module in MODULES:
        importlib.import_module(f"encoders.corpus.actions.{module}")
    return {name: action for name, action in sorted(_REGISTRY.items()) if not action.held_out}


@functools.cache
def held_out_programs() -> dict[str, Program]:
    """The programs that are only measured with, by name."""
    importlib.import_module(HELD_OUT)
    return {name: action for name, action in sorted(_REGISTRY.items()) if action.held_out}


def program_of(name: str) -> Program:
    """The program of an action, held out or not.

    Raises
    ------
    KeyError
        If the action is unknown.
    """
    return programs().get(name) or held_out_programs()[name]


def parts_of(step: ActionStep) -> frozenset[str]:
    """Parts of the body that a step needs; one arm where it names a side of an action of either arm.

    Raises
    ------
    KeyError
        If the action is unknown.
    """
    action = program_of(step.action)
    other = {"left": "right_arm", "right": "left_arm"}.get(step.side)
    return action.parts - {other} if action.sides and action.parts >= ARMS else action.parts


def sample_step(action: Program, rng: Generator, *, detail: float = 0.5) -> ActionStep:
    """A random step of this program: each field that it honours is filled with a chance of `detail`."""

    def draw(values: tuple[str, ...]) -> str:
        return str(rng.choice(values)) if values and rng.random() < detail else ""

    counts = action.counts
    return ActionStep(
        action.name,
        side=draw(action.sides),
        direction=draw(action.directions),
        speed=draw(action.speeds) if rng.random() < 0.5 else "",
        amplitude=draw(action.amplitudes) if rng.random() < 0.5 else "",
        count=int(rng.integers(counts[0], counts[1] + 1)) if counts and rng.random() < detail else 0,
        style=draw(tuple(STYLES)) if action.styled and rng.random() < 0.6 else "",
        height=draw(action.heights),
    )
