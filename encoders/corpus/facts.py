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

from encoders.corpus.scene import Scene, Step

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
_PARTICULARS = tuple(f.name for f in fields(Step) if f.name != "action")


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


def _names(step: Step) -> tuple[str, ...]:
    """The action, and what else whoever does it is doing."""
    if step.action == "run" and step.speed == "fast":
        return ("run", "sprint")
    return (step.action, *filter(None, [_KINDS_OF.get(step.action)]))


def _named(action: str, step: Step) -> set[str]:
    """The action, and each particular of it."""
    if step.action == "sprint":
        step = replace(step, speed="fast")
    told = {(name, value) for name in _PARTICULARS if (value := getattr(step, name))}
    told |= {("direction", also) for also in _ALSO_CALLED.get(step.direction, ())}
    return {action} | {f"{action}.{name}={value}" for name, value in told}


class Untold:
    """Which sentences keep quiet about what anybody would tell of a motion: that it goes aside, or is a special kind.

    "A person walks" is true of somebody who walks backwards, but said of somebody who does not: what is called plainly
    is to be found before what is not.
    """

    def __init__(self, vocabulary: Sequence[str]) -> None:
        actions: dict[str, int] = {}
        for fact in vocabulary:
            actions.setdefault(fact.partition(".")[0], len(actions))
        # What each fact (rows) says of each action (columns).
        self._named, self._way, self._elsewhere, self._particular, self._kind = (
            np.zeros((len(vocabulary), len(actions)), np.float32) for _ in range(5)
        )
        for row, fact in enumerate(vocabulary):
            action, _, particular = fact.partition(".")
            column, general = actions[action], _KINDS_OF.get(fact, "")
            self._named[row, column] = not particular
            self._particular[row, column] = particular not in ("", _AHEAD)
            self._way[row, column] = particular.startswith("direction=")
            self._elsewhere[row, column] = self._way[row, column] and particular != _AHEAD
            if general in actions and fact not in _HARDLY_TOLD:
                self._kind[row, actions[general]] = 1

    def __call__(self, meanings: Sequence[Iterable[int]], facts: Sequence[Iterable[int]]) -> NDArray[np.bool_]:
        """Boolean (meanings, motions); facts are indices into the vocabulary."""
        said, holds = _rows(meanings, len(self._named)), _rows(facts, len(self._named))
        named = said @ self._named > 0
        no_way, plain = named & ~(said @ self._way > 0), named & ~(said @ (self._particular + self._kind) > 0)
        untold = no_way.astype(np.float32) @ (holds @ self._elsewhere > 0).T
        untold += plain.astype(np.float32) @ (holds @ self._kind > 0).T
        return np.asarray(untold > 0, np.bool_)


def _rows(sets: Sequence[Iterable[int]], size: int) -> NDArray[np.float32]:
    """One row a set, 1 at each of its members."""
    rows = np.zeros((len(sets), size), np.float32)
    for i, members in enumerate(sets):
        rows[i, list(members)] = 1
    return rows


def stated_by(meanings: Sequence[Iterable[int]], facts: Sequence[Iterable[int]], size: int) -> NDArray[np.bool_]:
    """Whether each meaning (rows) holds in each motion (columns): all its facts are among the motion's."""
    rows, columns = _rows(meanings, size), _rows(facts, size)
    missing = rows @ (1 - columns).T
    return np.asarray((missing == 0) & (rows.sum(axis=1) > 0)[:, None], np.bool_)
