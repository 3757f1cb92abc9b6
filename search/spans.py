"""Spans of time: moments, their overlap, length bonus and non-maximum suppression."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Two windows of one motion overlap by at most this intersection over union.
MAX_OVERLAP = 0.3
#: Two moments of one motion share at most this part of the shorter one, so that none contains another.
MAX_SHARED = 0.5
#: What doubling its length adds to the score of a window, and of a moment: a window inside a long action scores like
#: the whole action.
WINDOW_BONUS, MOMENT_BONUS = 0.03, 0.03

_SHORTEST = 0.1  # seconds


@dataclass(frozen=True)
class Moment:
    """A span of a motion and its similarity to a query.

    Attributes
    ----------
    start, end : float
        Seconds.
    score : float
        Cosine similarity, the mean over the span.
    peak : float, optional
        The highest similarity in the span.
    """

    start: float
    end: float
    score: float
    peak: float | None = field(default=None, compare=False)

    @property
    def peak_score(self) -> float:
        """What its strength is calibrated on: the peak, or the score of a span that is one window."""
        return self.score if self.peak is None else self.peak

    @property
    def rank_score(self) -> float:
        """What moments are ranked by: the peak, with a bonus for length."""
        return float(length_adjusted(np.array([self.peak_score]), np.array([self.end - self.start]), MOMENT_BONUS)[0])


def length_adjusted(scores: NDArray[np.floating], seconds: NDArray[np.floating], bonus: float) -> NDArray[np.float64]:
    """Scores (..., N) of spans of `seconds` (N,), with `bonus` added for each doubling of the length."""
    return np.asarray(scores + bonus * np.log2(np.maximum(seconds, _SHORTEST)), np.float64)


def temporal_iou(starts: ArrayLike, ends: ArrayLike, start: float, end: float) -> NDArray[np.float64]:
    """Temporal intersection over union of each span with the span from `start` to `end`.

    Parameters
    ----------
    starts, ends : array-like (N,)
        Seconds.

    Returns
    -------
    float64 array (N,), 0 to 1
    """
    starts, ends = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    shared = np.clip(np.minimum(ends, end) - np.maximum(starts, start), 0, None)
    union = (ends - starts) + (end - start) - shared
    return np.asarray(shared / np.maximum(union, 1e-9), dtype=np.float64)


def shared_part(starts: ArrayLike, ends: ArrayLike, start: float, end: float) -> NDArray[np.float64]:
    """What each span (N,) and the span from `start` to `end` have in common, as a part (0 to 1) of the shorter one."""
    starts, ends = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    shared = np.clip(np.minimum(ends, end) - np.maximum(starts, start), 0, None)
    return np.asarray(shared / np.maximum(np.minimum(ends - starts, end - start), 1e-9), dtype=np.float64)


def temporal_nms(
    starts: ArrayLike,
    ends: ArrayLike,
    scores: ArrayLike,
    *,
    overlap: Callable[..., NDArray[np.float64]] = temporal_iou,
    most: float = MAX_OVERLAP,
) -> Iterator[int]:
    """Temporal non-maximum suppression: the indices of the spans that remain, best first.

    Parameters
    ----------
    starts, ends, scores : array-like (N,)
    overlap : callable
        `temporal_iou` or `shared_part`.
    most : float
        A span that overlaps a better one by more is suppressed.
    """
    starts, ends = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    order = np.argsort(-np.asarray(scores), kind="stable")
    while len(order):
        best, order = int(order[0]), order[1:]
        yield best
        order = order[overlap(starts[order], ends[order], starts[best], ends[best]) <= most]
