"""Random scenes with the action frequencies of human captions: steps in sequence, some simultaneous."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

from numpy.random import Generator

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.engine.program import Program
from encoders.corpus.language.lexicon import PHRASES, entry_of
from encoders.corpus.language.weighted_choice import pick_weighted
from encoders.corpus.scene import ActionStep, Scene

_LENGTHS = (0.5, 0.28, 0.15, 0.07)  # share of scenes with 1, 2, 3 and 4 steps in sequence
_AT_ONCE = 0.22  # share of groups with a simultaneous second action, if one fits
_CARRIERS = ("locomotion", "posture")  # groups of actions that a gesture may accompany
#: Plain gaits and their sampling weights.
_GAITS = {"walk": 5.0, "run": 4.0, "jog": 2.0, "sprint": 3.0, "sidestep": 1.0, "turn": 1.0}
_NO_DIRECTION = 0.5  # share of plain gaits without a direction
_FLATTEN = 0.5  # exponent on the human frequency of an action: 0 uniform, 1 as in HumanML3D


@cache
def mentions() -> dict[str, float]:
    """Action -> mentions per thousand actions in the captions of HumanML3D."""
    path = PHRASES / "mentions.json"
    counted: dict[str, float] = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return counted


def _weight(action: Program) -> float:
    return action.weight * float((1.0 + mentions().get(action.name, 0.0)) ** _FLATTEN)


@cache
def _drawable() -> tuple[tuple[Program, float], ...]:
    """The programs with phrases, and their sampling weights."""
    return tuple((action, _weight(action)) for name, action in programs().items() if entry_of(name) is not None)


def _draw(rng: Generator, options: list[tuple[Program, float]]) -> Program:
    return pick_weighted(rng, [action for action, _ in options], [weight for _, weight in options])


def _companion(base: Program, rng: Generator) -> Program | None:
    """A gesture that needs none of the body parts of `base`, or None."""
    fitting = [
        (action, weight)
        for action, weight in _drawable()
        if action.group not in _CARRIERS and not action.parts & base.parts and action.starts == action.ends == "stand"
    ]
    return _draw(rng, fitting) if fitting else None


def random_scene(rng: Generator) -> Scene:
    """One to four steps in sequence, some with a simultaneous gesture; every field is supported by its program.

    Actions follow a flattened human frequency, so that rare ones appear, and each starts in the posture in which the
    previous one ends. A simultaneous gesture has no style and speed of its own.
    """
    length = int(rng.choice(len(_LENGTHS), p=_LENGTHS)) + 1
    detail = float(rng.choice([0.35, 0.6, 0.9]))
    groups: list[tuple[ActionStep, ...]] = []
    posture, style, previous = "", "", ""
    for _ in range(length):
        fitting = [
            (action, weight)
            for action, weight in _drawable()
            if action.name != previous and (not posture or action.starts == posture)
        ]
        if not fitting:
            break
        action = _draw(rng, fitting)
        step = sample_step(action, rng, detail=detail)
        if groups:  # one style per performer
            step = replace(step, style=style if action.styled else "")
        else:
            style = step.style if length == 1 or rng.random() < 0.5 else ""
            step = replace(step, style=style)
        group: tuple[ActionStep, ...] = (step,)
        if action.group in _CARRIERS and rng.random() < _AT_ONCE:
            companion = _companion(action, rng)
            if companion is not None:
                group = (step, replace(sample_step(companion, rng, detail=detail), style="", speed=""))
        groups.append(group)
        posture, previous = action.ends, action.name
    return Scene(tuple(groups))


def random_gait(rng: Generator) -> Scene:
    """A plain gait and nothing else: the commonest queries, which need every style."""
    action = _draw(rng, [(programs()[name], weight) for name, weight in _GAITS.items()])
    step = sample_step(action, rng, detail=0.7)
    return Scene(((replace(step, direction="") if rng.random() < _NO_DIRECTION else step,),))
