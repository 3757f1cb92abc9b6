"""Which way is up in a file: what is expected before looking, weighed against what the movement shows.

The scores are log-odds: a softmax over the six axes was fitted to takes of motion capture and synthetic postures
(crawling, lying, handstands, climbing, ...), each also turned to Z up, raised off the floor, and with its root pinned.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from encoders.geometry import Array, unit
from encoders.motion import FPS
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.rest_pose import standing_axes
from indexer.take import UP_AXES

#: Directions of `UP_AXES`, (6, 3).
AXES = np.vstack([np.eye(3), -np.eye(3)])

#: Expected where a file says nothing: nearly all are Y up, many Z up.
_HABIT = np.array([-5.0, 0.0, -1.0, -5.0, -5.0, -5.0])
_STATED, _AT_REST = 3.0, 2.6  # what the axis that a file states, or that of a standing rest pose, is before others
_FRAMES = 2000  # enough to tell
_NEAR, _SUPPORT = 0.12, 0.25  # leg lengths above the lowest point in which joints touch the ground, and carry the body
_INVERTED = -0.3  # mean cosine below which a body is no less likely
_PINNED = 0.1  # leg lengths around the origin in which the hips stay where the root's place has been removed
_HAND = 0.12  # leg lengths that hands and feet reach beyond wrists and toes
_STEADY = 0.15  # leg lengths by which the height of the lowest point varies over a level floor


class Up(NamedTuple):
    """The axis of a file that is up, one of `UP_AXES`, and the reason to think so."""

    axis: str
    reason: str


def up_axis(landmarks: Landmarks, rest: Landmarks, stated: str | None = None, *, is_certain: bool = False) -> Up:
    """Which way is up.

    Parameters
    ----------
    landmarks : Landmarks
        The movement, at 20 frames a second.
    rest : Landmarks
        The rest pose, T = 1.
    stated : str, optional
        The axis that the file states.
    is_certain : bool
        That axis is up whatever the movement looks like.

    Returns
    -------
    Up
        Its reason is what speaks most for this axis against the next best.
    """
    if stated is not None and is_certain:
        return Up(stated, "by definition")
    standing = standing_axes(rest)
    at_rest = None if standing is None else UP_AXES[int(np.argmax(AXES @ standing[:, 1]))]
    scores = {
        _reason(stated, at_rest): _expected(stated, _STATED) if stated else _expected(at_rest, _AT_REST),
        **_evidence(landmarks),
    }
    second, best = np.argsort(np.sum(list(scores.values()), axis=0))[-2:]
    return Up(UP_AXES[best], max(scores, key=lambda reason: scores[reason][best] - scores[reason][second]))


def _reason(stated: str | None, at_rest: str | None) -> str:
    return "the file says so" if stated else "the rest pose stands" if at_rest else "most files are"


def _expected(axis: str | None, lead: float) -> Array:
    """Scores (6,) of the axes before looking, where one leads."""
    scores: Array = _HABIT.copy()
    if axis in ("y", "z"):
        scores[UP_AXES.index(axis)] = lead
    elif axis:  # hardly any file has another axis up, but solvers write rest poses along any
        scores[UP_AXES.index(axis)] += lead
    return scores


def _evidence(landmarks: Landmarks) -> dict[str, Array]:
    """Scores (6,) of the axes by what the movement shows."""
    leg = landmarks.leg_length
    step = max(len(landmarks) // _FRAMES, 1)
    some, later = landmarks[: max(len(landmarks) - 1, 1) : step], landmarks[min(1, len(landmarks) - 1) :: step]
    points = some.points() / leg
    speeds = np.linalg.norm(later.points() / leg - points, axis=-1) * FPS
    hips = some.middle("hip")
    upright = _along(unit(some.marks["head"] - hips) + unit(hips - some.middle("ankle"))) / 2
    centre = (hips + some.marks["neck"]) / leg / 4 + points.mean(axis=1) / 2
    heights = _along(points)  # (T, L, 6)
    lowest = heights.min(axis=1)
    low, middle, high = np.quantile(lowest, (0.05, 0.5, 0.95), axis=0)
    is_pinned = bool(np.linalg.norm(hips, axis=-1).max() < _PINNED * leg)
    near, support = (heights - lowest[:, None] < limit for limit in (_NEAR, _SUPPORT))
    touching = (speeds[..., None] * near).sum(axis=1) / near.sum(axis=1)
    return {
        "posture": 2.3 * upright.mean(axis=0).clip(_INVERTED) + 1.4 * (upright > 0.7).mean(axis=0),
        "a floor at height 0": (not is_pinned)
        * (_bell(middle, 0.0, 0.11) * (0.8 + 0.7 * np.exp((low - high) / _STEADY)) + 1.2 * _bell(low, -0.03, 0.11)),
        "a level floor": -0.4 * np.log(high - low + 0.03),
        "still contacts": -1.2 * np.log(np.median(touching, axis=0) + 0.05),
        "balance": -2.4 * np.minimum(np.median(_overhang(points, centre, support), axis=0), 0.6)
        + 0.2 * np.minimum(support.sum(axis=1).mean(axis=0), 10),
    }


def _along(vectors: Array) -> Array:
    """How far vectors (..., 3) go along each of `AXES`, (..., 6)."""
    return np.concatenate([vectors, -vectors], axis=-1)


def _bell(value: Array, centre: float, width: float) -> Array:
    """1 at the centre, falling to 0."""
    return np.asarray(np.exp(-(((value - centre) / width) ** 2) / 2))


def _overhang(points: Array, centre: Array, support: Array) -> Array:
    """How far (T, 6) the body's centre (T, 3) is beyond what carries it (T, L, 6) of the points (T, L, 3)."""
    where, inside = support[:, :, None], points[..., None]  # (T, L, 3, 6)
    low = np.where(where, inside, np.inf).min(axis=1)
    high = np.where(where, inside, -np.inf).max(axis=1)
    beyond = np.maximum(low - centre[..., None], centre[..., None] - high)
    level = np.abs(AXES.T) < 0.5  # the two directions (3, 6) at right angles to each axis
    return np.asarray(((beyond - _HAND).clip(0) * level).sum(axis=1))
