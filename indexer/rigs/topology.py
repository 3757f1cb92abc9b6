"""Ways through a skeleton's tree, given the parent of each joint (-1 for a root)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Parents = NDArray[np.int64]


def ancestry(parents: Parents, joint: int) -> list[int]:
    """A joint and its parents up to the root."""
    chain = [joint]
    while parents[chain[-1]] >= 0:
        chain.append(int(parents[chain[-1]]))
    return chain


def paths(parents: Parents) -> list[list[int]]:
    """The way from a root to each leaf."""
    leaves = sorted(set(range(len(parents))) - set(parents.tolist()))
    return [ancestry(parents, leaf)[::-1] for leaf in leaves]


def children(parents: Parents) -> list[list[int]]:
    """The children of each joint."""
    found: list[list[int]] = [[] for _ in parents]
    for joint, parent in enumerate(parents.tolist()):
        if parent >= 0:
            found[parent].append(joint)
    return found


def meeting(parents: Parents, a: int, b: int) -> int | None:
    """The nearest joint above both; None in different trees."""
    above = set(ancestry(parents, b))
    return next((joint for joint in ancestry(parents, a) if joint in above), None)


def route(parents: Parents, start: int, end: int) -> list[int]:
    """The joints from one to another, both included; none in different trees."""
    turn = meeting(parents, start, end)
    if turn is None:
        return []
    up, down = ancestry(parents, start), ancestry(parents, end)
    return up[: up.index(turn) + 1] + down[: down.index(turn)][::-1]
