"""Choosing: one candidate for each interval, so that sentences are shown well and bodies agree where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from encoders.motion import FPS, Motion
from encoders.skeleton import INDEX
from search.compose.candidates import Candidate
from search.compose.joins import heading
from search.compose.rotations import about_vertical
from search.compose.stitched import StitchedScores
from search.compose.timeline import Timeline

Array = NDArray[np.float64]

#: What a metre of mean distance between two poses costs in similarity, and a metre a second between their speeds.
_POSE, _SPEED = 0.45, 0.045
_GROUND = np.array([1.0, 0.0, 1.0])
_FEET = [INDEX[name] for name in ("left_ankle", "right_ankle", "left_foot", "right_foot")]
#: How much more the feet count: they should not have to slide.
_FEET_WEIGHT = 2.0
#: Frames over which speeds at joins are taken.
_REACH = 3
#: Rounds in which each interval's candidate is looked at again, the others kept.
_ROUNDS = 2
#: What spans already shown in another sample cost, and the spread of the noise that makes samples differ.
USED, SPREAD = 0.2, 0.03


@dataclass(frozen=True, eq=False)
class Edge:
    """How a candidate begins or ends: joints (22, 3) in the frame of its body, heights kept, and their speeds."""

    pose: Array
    speed: Array

    @classmethod
    def of(cls, frames: Array, at: int, seconds: float) -> Edge:
        """Of two frames (2, 22, 3) that lie `seconds` apart; `at` is the one whose body gives place and heading."""
        placed = frames - frames[at, :1] * _GROUND
        local = about_vertical(placed, -float(heading(frames[at])))
        return cls(local[at], (local[1] - local[0]) / seconds)


def join_costs(ends: Sequence[Edge], begins: Sequence[Edge]) -> Array:
    """What it costs (A, B) to go from each of A ends to each of B beginnings."""
    weights = np.ones(ends[0].pose.shape[0])
    weights[_FEET] = _FEET_WEIGHT
    weights /= weights.sum()

    def distances(a: Sequence[Array], b: Sequence[Array]) -> Array:
        apart = np.stack(a)[:, None] - np.stack(b)[None]
        found: Array = np.sqrt((apart**2).sum(-1)) @ weights
        return found

    poses = distances([edge.pose for edge in ends], [edge.pose for edge in begins])
    speeds = distances([edge.speed for edge in ends], [edge.speed for edge in begins])
    return _POSE * poses + _SPEED * speeds


def best_path(fits: Sequence[Array], joins: Sequence[Array]) -> list[int]:
    """The choice at each of N steps that has the highest sum of fits, less the costs of the joins.

    Dynamic programming (Viterbi): exact, in time proportional to the joins.

    Parameters
    ----------
    fits : N arrays (C_n,)
    joins : N - 1 arrays (C_n, C_n+1)
    """
    best, back = fits[0], []
    for fit, join in zip(fits[1:], joins, strict=True):
        through = best[:, None] - join
        back.append(through.argmax(axis=0))
        best = through.max(axis=0) + fit
    path = [int(best.argmax())]
    for came_from in reversed(back):
        path.append(int(came_from[path[-1]]))
    return path[::-1]


@dataclass(frozen=True, eq=False)
class Joins:
    """What it costs to go from the candidates of one interval that leads to those of the next.

    Attributes
    ----------
    order : tuple of int
        The intervals that lead.
    begin : array (C,)
        What each candidate of the first costs after what comes before it.
    costs : tuple of arrays (C_n, C_n+1)
    """

    order: tuple[int, ...]
    begin: Array
    costs: tuple[Array, ...]

    @classmethod
    def of(cls, timeline: Timeline, offered: Sequence[Sequence[Candidate]], after: Motion | None) -> Joins:
        """Of the candidates offered for each interval, after a motion if one is given."""
        order = tuple(dict.fromkeys(cut.base for cut in timeline.cuts()))
        edges = {i: [_edges(candidate) for candidate in offered[i]] for i in order}
        begin = np.zeros(len(offered[order[0]]))
        if after is not None:
            begin = join_costs([_last_edge(after)], [edge for edge, _ in edges[order[0]]])[0]
        costs = [join_costs([end for _, end in edges[a]], [edge for edge, _ in edges[b]]) for a, b in pairwise(order)]
        return cls(order, begin, tuple(costs))

    def best(self, fits: Sequence[Array]) -> list[int]:
        """The candidate of each interval by its fits (C,): those that lead together, the others by themselves."""
        steps = [fits[i] for i in self.order]
        leading = dict(zip(self.order, best_path([steps[0] - self.begin, *steps[1:]], self.costs), strict=True))
        return [leading.get(i, int(fit.argmax())) for i, fit in enumerate(fits)]

    def around(self, interval: int, choice: Sequence[int], count: int) -> Array:
        """What the joins of each of `count` candidates of an interval cost, with the choice of its neighbours."""
        total = np.zeros(count)
        if interval not in self.order:
            return total
        at = self.order.index(interval)
        total += self.costs[at - 1][choice[self.order[at - 1]]] if at else self.begin
        if at + 1 < len(self.order):
            total += self.costs[at][:, choice[self.order[at + 1]]]
        return total


def refined(choice: Sequence[int], costs: Sequence[Array], joins: Joins, stitched: StitchedScores) -> list[int]:
    """A choice improved: each interval takes the candidate with which it and those seen during it score highest.

    Coordinate ascent, until nothing changes or after a few rounds; the sum that is climbed never falls.

    Parameters
    ----------
    costs : sequence of arrays (C,)
        What each candidate costs in similarity.
    """
    best = list(choice)
    for _ in range(_ROUNDS):
        before = list(best)
        for i, cost in enumerate(costs):
            tried = [[*best[:i], option, *best[i + 1 :]] for option in range(len(cost))]
            scores = sum(stitched.of(j, tried) for j in stitched.seen[i])
            best[i] = int((scores - cost - joins.around(i, best, len(cost))).argmax())
        if best == before:
            break
    return best


def _edges(candidate: Candidate) -> tuple[Edge, Edge]:
    first, last = candidate.ends(_REACH)
    seconds = _REACH / FPS / candidate.rate
    return Edge.of(first, 0, seconds), Edge.of(last, 1, seconds)


def _last_edge(after: Motion) -> Edge:
    joints = after.resample(FPS).joints[-_REACH - 1 :].astype(np.float64)
    return Edge.of(joints[[0, -1]], 1, max(len(joints) - 1, 1) / FPS)
