"""Choosing: one candidate for each interval, so that sentences are shown well and bodies agree where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.skeleton import INDEX
from search.compose.joins import heading

Array = NDArray[np.float64]

#: What a metre of mean distance between two poses costs in similarity, and a metre a second between their speeds.
_POSE, _SPEED = 0.45, 0.045
_GROUND = np.array([1.0, 0.0, 1.0])
_FEET = [INDEX[name] for name in ("left_ankle", "right_ankle", "left_foot", "right_foot")]
#: How much more the feet count: they should not have to slide.
_FEET_WEIGHT = 2.0
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
        angle = -float(heading(frames[at]))
        cosine, sine = np.cos(angle), np.sin(angle)
        turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
        local = placed @ turn.T
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
