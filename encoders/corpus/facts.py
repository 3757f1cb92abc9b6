"""Facts: what a scene makes true, so that a sentence is known to be true of a clip it was not written for.

A sentence that says "a person walks" is true of every clip in which somebody walks left, slowly or drunk. Such a
pair is no negative for contrastive training; "walks left" against "walks right" is one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields
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
    return (step.action, *filter(None, [_KINDS_OF.get(step.action)]))


def _named(action: str, step: Step) -> set[str]:
    """The action, and each particular of it."""
    return {action} | {f"{action}.{name}={value}" for name in _PARTICULARS if (value := getattr(step, name))}


def stated_by(meanings: Sequence[Iterable[int]], facts: Sequence[Iterable[int]], size: int) -> NDArray[np.bool_]:
    """Whether each meaning (rows) holds in each motion (columns): all its facts are among the motion's."""
    rows, columns = np.zeros((len(meanings), size), np.float32), np.zeros((len(facts), size), np.float32)
    for i, row in enumerate(meanings):
        rows[i, list(row)] = 1
    for j, column in enumerate(facts):
        columns[j, list(column)] = 1
    missing = rows @ (1 - columns).T
    return np.asarray((missing == 0) & (rows.sum(axis=1) > 0)[:, None], np.bool_)
