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
from indexer.rigs.mapping import SIDES
from indexer.rigs.rest_pose import standing_axes
from indexer.take import UP_AXES

#: Directions of `UP_AXES`, (6, 3).
AXES = np.vstack([np.eye(3), -np.eye(3)])

#: Expected where a file says nothing: nearly all are Y up, many Z up.
_HABIT = np.array([-5.0, 0.0, -1.0, -5.0, -5.0, -5.0])
_STATED, _AT_REST = 3.0, 2.6  # what the axis that a file states, or that of a standing rest pose, is before others
_CLEAR = 3.6  # what an axis is before the next one where it is certain; of 1,016 real takes five have less
_FRAMES = 2000  # enough to tell
_NEAR, _SUPPORT = 0.12, 0.25  # leg lengths above the lowest point in which joints touch the ground, and carry the body
_KNEELING = 0.2  # leg lengths above the lowest point in which a knee lies on the ground
_INVERTED = -0.3  # mean cosine below which a body is no less likely
_PINNED = 0.1  # leg lengths around the origin in which the hips stay where the root's place has been removed
_HAND = 0.12  # leg lengths that hands and feet reach beyond wrists and toes
_STEADY = 0.15  # leg lengths by which the height of the lowest point varies over a level floor
_SOLE, _FLAT, _STEEP = 0.35, 0.35, 0.8  # how far (cosine) a foot points down, and may do more or less on the floor
_GRAVITY = 12.0  # leg lengths a second squared, on a leg of 0.82 m
_FALLING, _SIDEWAYS = (0.7, 1.25), 0.3  # shares of it, along the axis and square to it, in flight


class Up(NamedTuple):
    """The axis of a file that is up.

    Attributes
    ----------
    axis : str
        One of `UP_AXES`.
    reason : str
        Why it is thought to be.
    rival : str
        The axis that may be up as well; empty where one is clearly better.
    """

    axis: str
    reason: str
    rival: str = ""

    def warnings(self) -> tuple[str, ...]:
        """What to say where it is not certain."""
        if not self.rival:
            return ()
        return (
            f"which way is up is not certain: {self.axis} was taken ({self.reason}), and {self.rival} may be;"
            f" --up {self.rival} takes that, --up {self.axis} confirms",
        )


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
        **_evidence(landmarks, _SOLE if standing is None else _sole(rest, standing[:, 1])),
    }
    total = np.sum(list(scores.values()), axis=0)
    second, best = np.argsort(total)[-2:]
    reason = max(scores, key=lambda reason: scores[reason][best] - scores[reason][second])
    return Up(UP_AXES[best], reason, "" if total[best] - total[second] > _CLEAR else UP_AXES[second])


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


def _evidence(landmarks: Landmarks, sole: float) -> dict[str, Array]:
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
    knees = np.stack([_along(some.marks[f"{side}_knee"] / leg) for side in SIDES], axis=1).min(axis=1) - lowest
    return {
        "posture": 4.0 * upright.mean(axis=0).clip(_INVERTED),
        "a floor at height 0": (not is_pinned)
        * (2.7 * _bell(middle, 0.0, 0.11) * np.exp((low - high) / _STEADY) + 1.5 * _bell(low, -0.03, 0.11)),
        "a level floor": -0.8 * np.log(high - low + 0.03),
        "still contacts": -0.75 * np.log(np.median(touching, axis=0) + 0.05),
        "what lies on the floor": 0.28 * near.sum(axis=1).mean(axis=0).clip(0, 10)
        + 1.0 * (knees < _KNEELING).mean(axis=0),
        "flat feet": -6.1 * _steepness(some, leg, lowest, sole),
        "balance": -15.0 * np.minimum(np.median(_overhang(points, centre, support), axis=0), 0.6),
        "free fall": 1.9 * np.log1p(_falling(centre) if step == 1 else np.zeros(6)),
    }


def _sole(rest: Landmarks, up: Array) -> float:
    """How far (cosine) the feet of a standing rest pose (T = 1) point down."""
    feet = [rest.bone(f"{side}_ankle", f"{side}_toe") for side in SIDES if f"{side}_toe" in rest.marks]
    return -float((unit(np.concatenate(feet)) @ up).mean()) if feet else _SOLE


def _steepness(landmarks: Landmarks, leg: float, lowest: Array, sole: float) -> Array:
    """How far (6,) feet near the ground are from lying on it, mean cosine.

    `lowest` (T, 6) is in leg lengths; `sole` is how far (cosine) the feet point down when they stand.
    """
    steep = []
    for side in SIDES:
        if f"{side}_toe" in landmarks.marks:
            down = _along(unit(landmarks.bone(f"{side}_ankle", f"{side}_toe")))
            is_low = _along(landmarks.marks[f"{side}_ankle"] / leg) - lowest < _SUPPORT
            tilt = np.abs(down + sole).clip(_FLAT, _STEEP)
            usual = (_FLAT + _STEEP) / 2
            steep.append(np.where(is_low.any(axis=0), (tilt * is_low).sum(axis=0) / is_low.sum(axis=0).clip(1), usual))
    return np.asarray(np.mean(steep, axis=0)) if steep else np.zeros(6)


def _falling(centre: Array) -> Array:
    """In how many frames (6,) the body's centre (T, 3) falls freely against each axis, with the frame after."""
    pull = np.diff(centre, 2, axis=0) * (FPS**2 / _GRAVITY)
    along = _along(pull)
    sideways = (pull**2).sum(axis=-1)[:, None] - along**2
    falls = (along < -_FALLING[0]) & (along > -_FALLING[1]) & (sideways < _SIDEWAYS**2)
    return np.asarray((falls[1:] & falls[:-1]).sum(axis=0))


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
