"""All action programs by name, for training or held out, and random action steps."""

from __future__ import annotations

import functools

from numpy.random import Generator

from encoders.corpus.actions import (
    acrobatics,
    bending,
    bowing,
    climbing,
    closed_paths,
    drills,
    exercise,
    falls,
    floor,
    hit_reactions,
    jumps,
    locomotion,
    posture,
    stepping,
    stretching,
    turning,
    unsteady,
    waiting,
)
from encoders.corpus.actions.dance import free, imitation, set_dances
from encoders.corpus.actions.gestures import alone, directing, feelings, greeting, waving
from encoders.corpus.actions.objects import chores, everyday, gripping, handling, music
from encoders.corpus.actions.sports import balls, combat, outdoor, swings
from encoders.corpus.engine.curves import ARMS
from encoders.corpus.engine.program import REGISTERED, Program
from encoders.corpus.engine.style import STYLES
from encoders.corpus.heldout import heldout_actions
from encoders.corpus.scene import ActionStep

#: Modules whose import registers programs: every module of this package but this one, and the held-out one.
FAMILIES = (
    *(acrobatics, bending, bowing, climbing, closed_paths, drills, exercise, falls, floor, hit_reactions, jumps),
    *(locomotion, posture, stepping, stretching, turning, unsteady, waiting),
    *(free, imitation, set_dances),
    *(alone, directing, feelings, greeting, waving),
    *(chores, everyday, gripping, handling, music),
    *(balls, combat, outdoor, swings),
    heldout_actions,
)


@functools.cache
def programs() -> dict[str, Program]:
    """All programs by name, without the held-out ones."""
    return {name: action for name, action in sorted(REGISTERED.items()) if not action.held_out}


@functools.cache
def held_out_programs() -> dict[str, Program]:
    """The held-out programs by name: for evaluation only."""
    return {name: action for name, action in sorted(REGISTERED.items()) if action.held_out}


def program_of(name: str) -> Program:
    """The program of an action, held out or not.

    Raises
    ------
    KeyError
        If the action is unknown.
    """
    return REGISTERED[name]


def parts_of(step: ActionStep) -> frozenset[str]:
    """Body parts that a step occupies; one arm only where it names the side of an action of either arm.

    Raises
    ------
    KeyError
        If the action is unknown.
    """
    action = program_of(step.action)
    other = {"left": "right_arm", "right": "left_arm"}.get(step.side)
    return action.parts - {other} if action.sides and action.parts >= ARMS else action.parts


def compatible(*steps: ActionStep) -> bool:
    """Whether steps can happen at the same time: no body part is occupied twice."""
    parts = [parts_of(step) for step in steps]
    return sum(map(len, parts)) == len(frozenset().union(*parts))


def sample_step(action: Program, rng: Generator, *, detail: float = 0.5) -> ActionStep:
    """A random step of this program: each field that it supports is set with probability `detail`."""

    def draw(values: tuple[str, ...]) -> str:
        return str(rng.choice(values)) if values and rng.random() < detail else ""

    counts, side, direction = action.counts, draw(action.sides), draw(action.directions)
    turned = action.degrees and direction != "around" and rng.random() < 0.5 * detail
    return ActionStep(
        action.name,
        side=side,
        direction=direction,
        speed=draw(action.speeds) if rng.random() < 0.5 else "",
        amplitude=draw(action.amplitudes) if rng.random() < 0.5 else "",
        count=int(rng.integers(counts[0], counts[1] + 1)) if counts and rng.random() < detail else 0,
        style=draw(tuple(STYLES)) if action.styled and rng.random() < 0.6 else "",
        height=draw(action.heights),
        degrees=int(rng.choice(action.degrees)) if turned else 0,
    )
