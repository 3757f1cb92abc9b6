"""Facts: what a scene makes true, so that a sentence is known to be true of a clip it was not written for.

A sentence that says "a person walks" is true of every clip in which somebody walks left, slowly or drunk. Such a
pair is no negative for contrastive training; "walks left" against "walks right" is one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.scene import ActionStep, Scene

#: Who does the first is also doing the second, in the words of people.
_KINDS_OF = {
    "jog": "run", "sprint": "run", "limp": "walk", "sneak": "walk", "tiptoe": "walk", "march": "walk",
    "stagger": "walk", "crouch walk": "walk", "shuffle": "walk", "drag leg": "walk",
    "balance beam": "walk", "take steps": "walk", "walk half circle": "walk", "walk figure eight": "walk",
    "get pushed": "stumble", "hop": "jump", "leap": "jump",
    "spin jump": "jump", "jump over": "jump", "hurdle": "jump", "army crawl": "crawl", "pivot": "turn",
}  # fmt: skip
#: Kinds that people seldom tell apart from what they are a kind of.
_HARDLY_TOLD = {"jog"}
#: Directions that are said of one another: who walks left while looking ahead mostly goes ahead, too.
_ALSO_CALLED = {
    "left": ("forward-left",), "right": ("forward-right",), "forward-left": ("left",), "forward-right": ("right",),
    "backward-left": ("backward",), "backward-right": ("backward",),
}  # fmt: skip
_AHEAD = "direction=forward"
_PARTICULARS = tuple(f.name for f in fields(ActionStep) if f.name != "action")


def facts(scene: Scene) -> frozenset[str]:
    """Everything a scene says: each action, each particular of it, what comes before what, and what happens at once."""
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
    """The action, and what else whoever does it is doing."""
    if step.action == "run" and step.speed == "fast":
        return ("run", "sprint")
    return (step.action, *filter(None, [_KINDS_OF.get(step.action)]))


def _named(action: str, step: ActionStep) -> set[str]:
    """The action, and each particular of it."""
    if step.action == "sprint":
        step = replace(step, speed="fast")
    told = {(name, value) for name in _PARTICULARS if (value := getattr(step, name))}
    told |= {("direction", also) for also in _ALSO_CALLED.get(step.direction, ())}
    return {action} | {f"{action}.{name}={value}" for name, value in told}


class Underspecified:
    """Which sentences keep quiet about what anybody would tell: that a motion goes aside, takes both hands, is special.

    "A person walks" is true of somebody who walks backwards, but said of somebody who does not, and "a person waves" of
    somebody who waves both hands: what is called plainly is to be found before what is not.
    """

    def __init__(self, vocabulary: Sequence[str]) -> None:
        actions: dict[str, int] = {}
        self._action = np.array([actions.setdefault(f.partition(".")[0], len(actions)) for f in vocabulary], np.int64)
        self._general = np.array([actions.get(_told_as(fact), -1) for fact in vocabulary], np.int64)
        particulars = [fact.partition(".")[2] for fact in vocabulary]
        self._particular = np.array([p not in ("", _AHEAD) for p in particulars], np.bool_)
        self._way = np.array([p.startswith("direction=") for p in particulars], np.bool_)
        self._side = np.array([p.startswith("side=") for p in particulars], np.bool_)
        self._both = np.array([p == "side=both" for p in particulars], np.bool_)
        self._named = np.array([not p for p in particulars], np.bool_)
        self._actions = len(actions)

    def __call__(self, meanings: Sequence[Sequence[int]], facts: Sequence[Sequence[int]]) -> NDArray[np.bool_]:
        """Boolean (meanings, motions); facts are indices into the vocabulary."""
        named = self._of_actions(meanings, self._action, self._named)
        kind = self._general >= 0
        plain = named & ~self._of_actions(meanings, self._action, self._particular)
        plain &= ~self._of_actions(meanings, self._general, kind)
        no_way = named & ~self._of_actions(meanings, self._action, self._way)
        no_side = named & ~self._of_actions(meanings, self._action, self._side)
        quiet = np.hstack([no_way, no_side, plain])
        elsewhere = self._of_actions(facts, self._action, self._way & self._particular)
        both, special = self._of_actions(facts, self._action, self._both), self._of_actions(facts, self._general, kind)
        shown = np.hstack([elsewhere, both, special])
        return np.asarray(quiet.astype(np.float32) @ shown.astype(np.float32).T > 0, np.bool_)

    def _of_actions(
        self, sets: Sequence[Sequence[int]], action: NDArray[np.int64], which: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """Boolean (sets, actions): whether a set has a fact out of `which` that belongs to an action."""
        rows = np.repeat(np.arange(len(sets)), [len(members) for members in sets])
        members = np.concatenate([np.asarray(members, np.int64) for members in sets])
        rows, members = rows[which[members]], members[which[members]]
        table = np.zeros((len(sets), self._actions), np.bool_)
        table[rows, action[members]] = True
        return table


def _told_as(fact: str) -> str:
    """The action of which this one is a kind that people would name; none for other facts."""
    return "" if fact in _HARDLY_TOLD else _KINDS_OF.get(fact, "")


def _rows(sets: Sequence[Iterable[int]], size: int) -> NDArray[np.float32]:
    """One row a set, 1 at each of its members."""
    rows = np.zeros((len(sets), size), np.float32)
    for i, members in enumerate(sets):
        rows[i, list(members)] = 1
    return rows


def entailment_of_indices(
    meanings: Sequence[Iterable[int]], facts: Sequence[Iterable[int]], size: int
) -> NDArray[np.bool_]:
    """Whether each meaning (rows) holds in each motion (columns): all its facts are among the motion's."""
    rows, columns = _rows(meanings, size), _rows(facts, size)
    missing = rows @ (1 - columns).T
    return np.asarray((missing == 0) & (rows.sum(axis=1) > 0)[:, None], np.bool_)


def entailment(meanings: Sequence[Iterable[str]], facts: Sequence[Iterable[str]]) -> NDArray[np.bool_]:
    """`entailment_of_indices` of facts as they are written: boolean (meanings, motions)."""
    index: dict[str, int] = {}
    rows, columns = ([[index.setdefault(f, len(index)) for f in members] for members in s] for s in (meanings, facts))
    return entailment_of_indices(rows, columns, len(index))
