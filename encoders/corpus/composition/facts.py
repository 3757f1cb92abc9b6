"""Facts of a scene, and which captions they entail: a caption may describe clips that it was not written for.

"A person walks" describes every clip of somebody walking left, slowly or drunk. Such a pair is a false negative of
contrastive training; "walks left" with a clip of "walks right" is a true negative.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.open_scenes import open_directions
from encoders.corpus.engine.program import REGISTERED
from encoders.corpus.scene import ActionStep, Scene

#: Action -> the more general action that people also call it (hypernyms).
HYPERNYMS = {
    "jog": "run", "sprint": "run", "limp": "walk", "sneak": "walk", "tiptoe": "walk", "march": "walk",
    "stagger": "walk", "crouch walk": "walk", "shuffle": "walk", "drag leg": "walk",
    "balance beam": "walk", "take steps": "walk", "walk half circle": "walk", "walk figure eight": "walk",
    "get pushed": "stumble", "hop": "jump", "leap": "jump",
    "spin jump": "jump", "jump over": "jump", "hurdle": "jump", "army crawl": "crawl", "pivot": "turn", "spin": "turn",
    "trip and fall": "fall", "slip and fall": "fall", "collapse": "fall", "die": "fall", "faint": "collapse",
    "hit from the side": "hit reaction", "hit from behind": "hit reaction", "wait": "stand", "jump start": "jump",
    "side lunges": "lunge", "touch opposite knee": "touch knee", "touch opposite shoulder": "touch shoulder",
}  # fmt: skip
#: Actions that people seldom distinguish from the general one.
_INTERCHANGEABLE = {"jog", "trip and fall", "slip and fall", "collapse", "faint", "wait"}
#: Directions with which a direction is also described: a step to the left with the gaze ahead mostly goes ahead, too.
_ALSO_CALLED = {
    "left": ("forward-left",), "right": ("forward-right",), "forward-left": ("left",), "forward-right": ("right",),
    "backward-left": ("backward",), "backward-right": ("backward",),
}  # fmt: skip
_TURNS = frozenset({"turn", "pivot", "spin jump"})
_ATTRIBUTES = tuple(f.name for f in fields(ActionStep) if f.name != "action")


def facts(scene: Scene) -> frozenset[str]:
    """Everything that a scene states: actions, their attributes, their order, and which of them are simultaneous."""
    found: set[str] = set()
    for group in scene.steps:
        for step in group:
            found.update(*(_named(name, step) for name in _names(step)))
        for a, b in combinations(group, 2):
            found.update("+".join(sorted(pair)) for pair in product(_names(a), _names(b)))
    for earlier, later in combinations(scene.steps, 2):
        for a, b in product(earlier, later):
            found.update(f"{first}<{second}" for first, second in product(_names(a), _names(b)))
    return frozenset(found)


def _names(step: ActionStep) -> tuple[str, ...]:
    """The action and its more general name."""
    if step.action == "run" and step.speed == "fast":
        return ("run", "sprint")
    return (step.action, *filter(None, [HYPERNYMS.get(step.action)]))


def _named(action: str, step: ActionStep) -> set[str]:
    """The facts of an action and of each of its attributes."""
    if step.action == "sprint":
        step = replace(step, speed="fast")
    stated = {(name, value) for name in _ATTRIBUTES if (value := getattr(step, name))}
    stated |= {("direction", also) for also in _ALSO_CALLED.get(step.direction, ())}
    stated |= _turned(step)
    return {action} | {f"{action}.{name}={value}" for name, value in stated}


def _turned(step: ActionStep) -> set[tuple[str, object]]:
    """What an angle says in other words: a turn around is one of 180 degrees, a single spin one of 360."""
    if step.degrees == 180 and step.direction:
        return {("direction", "around")}
    if step.action in _TURNS and step.direction == "around":
        return {("degrees", 180)}
    return {("degrees", 360)} if step.action == "spin" and step.count == 1 else set()


class Underspecified:
    """Which captions omit a salient attribute of a motion: a direction but forward, both hands, a more specific action.

    "A person walks" is true of walking backwards and "a person waves" of waving both hands, but people would say so.
    Plain motions are to be ranked above such ones, so these pairs stay negatives.
    """

    def __init__(self, vocabulary: Sequence[str]) -> None:
        actions: dict[str, int] = {}
        self._action = np.array([actions.setdefault(f.partition(".")[0], len(actions)) for f in vocabulary], np.int64)
        self._general = np.array([actions.get(_salient_kind_of(fact), -1) for fact in vocabulary], np.int64)
        attributes = [fact.partition(".")[2] for fact in vocabulary]
        self._attribute = np.array([bool(fact.partition(".")[2]) and not _expected(fact) for fact in vocabulary])
        self._direction = np.array([p.startswith("direction=") for p in attributes], np.bool_)
        self._side = np.array([p.startswith("side=") for p in attributes], np.bool_)
        self._both = np.array([p == "side=both" for p in attributes], np.bool_)
        self._named = np.array([not p for p in attributes], np.bool_)
        self._actions = len(actions)

    def __call__(self, meanings: Sequence[Sequence[int]], facts: Sequence[Sequence[int]]) -> NDArray[np.bool_]:
        """Boolean (meanings, motions); meanings and facts are sets of indices into the vocabulary."""
        named = self._of_actions(meanings, self._action, self._named)
        kind = self._general >= 0
        plain = named & ~self._of_actions(meanings, self._action, self._attribute)
        plain &= ~self._of_actions(meanings, self._general, kind)
        no_direction = named & ~self._of_actions(meanings, self._action, self._direction)
        no_side = named & ~self._of_actions(meanings, self._action, self._side)
        omitted = np.hstack([no_direction, no_side, plain])
        directed = self._of_actions(facts, self._action, self._direction & self._attribute)
        both, special = self._of_actions(facts, self._action, self._both), self._of_actions(facts, self._general, kind)
        shown = np.hstack([directed, both, special])
        return np.asarray(omitted.astype(np.float32) @ shown.astype(np.float32).T > 0, np.bool_)

    def _of_actions(
        self, sets: Sequence[Sequence[int]], action: NDArray[np.int64], which: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """Boolean (sets, actions): whether a set has a fact of the mask `which` that belongs to an action."""
        rows = np.repeat(np.arange(len(sets)), [len(members) for members in sets])
        members = np.concatenate([np.asarray(members, np.int64) for members in sets])
        rows, members = rows[which[members]], members[which[members]]
        table = np.zeros((len(sets), self._actions), np.bool_)
        table[rows, action[members]] = True
        return table


def _expected(fact: str) -> bool:
    """Whether a fact is a direction that people need not name, such as forward."""
    action, _, attribute = fact.partition(".")
    name, _, direction = attribute.partition("=")
    usual = open_directions(action) if action in REGISTERED else ()
    expected = {"forward", *usual}.union(*(_ALSO_CALLED.get(way, ()) for way in usual))
    return name == "direction" and direction in expected


def _salient_kind_of(fact: str) -> str:
    """The general action of an action that people would name by its own name; "" for other facts."""
    return "" if fact in _INTERCHANGEABLE else HYPERNYMS.get(fact, "")


def _rows(sets: Sequence[Iterable[int]], size: int) -> NDArray[np.float32]:
    """Indicator rows (sets, size) of sets of indices."""
    rows = np.zeros((len(sets), size), np.float32)
    for i, members in enumerate(sets):
        rows[i, list(members)] = 1
    return rows


def entailment_of_indices(
    meanings: Sequence[Iterable[int]], facts: Sequence[Iterable[int]], size: int
) -> NDArray[np.bool_]:
    """Boolean (meanings, motions): all facts of a meaning are among the motion's; False for an empty meaning."""
    rows, columns = _rows(meanings, size), _rows(facts, size)
    missing = rows @ (1 - columns).T
    return np.asarray((missing == 0) & (rows.sum(axis=1) > 0)[:, None], np.bool_)


def entailment(meanings: Sequence[Iterable[str]], facts: Sequence[Iterable[str]]) -> NDArray[np.bool_]:
    """`entailment_of_indices` of facts as strings: boolean (meanings, motions)."""
    index: dict[str, int] = {}
    rows, columns = ([[index.setdefault(f, len(index)) for f in members] for members in s] for s in (meanings, facts))
    return entailment_of_indices(rows, columns, len(index))
