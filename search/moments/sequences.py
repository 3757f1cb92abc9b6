"""Steps in order, found as consecutive spans of one motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import window_starts
from search.moments.boundaries import gains
from search.moments.queried_motion import QueriedMotion
from search.moments.window_scores import WindowScores, join
from search.spans import WINDOW_BONUS, Moment, length_adjusted

#: What each second between two steps costs, in cosine, and what a gap costs at most: steps follow one another closely,
#: but a person may sit for long before standing up.
GAP_COST, MAX_GAP_COST = 0.08, 0.25

#: Lengths in seconds of the spans from which steps are chosen; from one to the next it is a tenth of their length in
#: even frames, at least two.
_LENGTHS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 12.0, 16.0)
#: How far beyond its window a step may reach, in seconds.
_REACH = 4.0
#: The shortest step, in seconds.
_SHORTEST = 0.5


def find_sequence(motion: QueriedMotion) -> list[Moment]:
    """The moments of the steps (S of them, one for each query), in order; none where no sequence fits."""
    sequence = best_sequence(step_spans(motion))
    return refine_sequence(motion, sequence) if sequence else []


def step_spans(motion: QueriedMotion) -> WindowScores:
    """Spans from which steps are chosen, each scored as the mean of its similarity over time."""
    frames, fps = motion.similarity.shape[1], motion.fps
    total = np.pad(np.cumsum(motion.similarity, axis=1, dtype=np.float64), ((0, 0), (1, 0)))
    sizes = [size for size in (round(seconds * fps) for seconds in _LENGTHS) if size <= frames] or [frames]
    parts = []
    for size in sizes:
        starts = window_starts(frames, size, max(size // 20 * 2, 2))
        scores = (total[:, starts + size] - total[:, starts]) / size
        parts.append(WindowScores(starts / fps, (starts + size) / fps, scores.astype(np.float32)))
    return join(parts)


def best_sequence(windows: WindowScores) -> list[Moment]:
    """The best window of each step, each beginning after the one before has ended; none where no sequence fits.

    Parameters
    ----------
    windows : WindowScores
        Candidates and their similarity to each step.
    """
    found = windows_in_order(
        windows.starts, windows.ends, length_adjusted(windows.scores, windows.lengths, WINDOW_BONUS)
    )
    return [
        Moment(float(windows.starts[i]), float(windows.ends[i]), float(windows.scores[step, i]))
        for step, i in enumerate(found[0] if found else ())
    ]


def refine_sequence(motion: QueriedMotion, sequence: Sequence[Moment]) -> list[Moment]:
    """The steps with their boundaries where similarity over time rises and falls, still in order."""
    similarity, fps, frames = motion.similarity, motion.fps, motion.similarity.shape[1]
    reach = round(_REACH * fps)
    rows = []
    for values, step, level in zip(similarity, sequence, motion.step_levels, strict=True):
        first = min(round(step.start * fps), frames - 1)
        last = min(max(round(step.end * fps), first + 1), frames)
        gain = gains(values, level, first, last)
        gain[: max(first - reach, 0)] = gain[last + reach :] = -np.inf
        rows.append(gain)
    return [
        Moment(a / fps, min(b / fps, motion.source.duration), float(values[a:b].mean()), float(values[a:b].max()))
        for values, (a, b) in zip(similarity, consecutive_spans(rows, round(_SHORTEST * fps)), strict=True)
    ]


def enclosing(sequence: Sequence[Moment]) -> Moment:
    """The span from the first step's start to the last one's end, with the mean of their scores and the lowest peak."""
    score, peak = float(np.mean([s.score for s in sequence])), min(s.peak_score for s in sequence)
    return Moment(sequence[0].start, sequence[-1].end, score, peak)


def windows_in_order(
    starts: NDArray[np.float64], ends: NDArray[np.float64], scores: NDArray[np.floating]
) -> tuple[NDArray[np.int64], float] | None:
    """The best sequence of windows, one a step, each beginning when the one before has ended or later.

    Dynamic programming over windows sorted by end: the best sequence up to each window is its own score and the best
    of all sequences that end before it begins, less the cost of the gap between.

    Parameters
    ----------
    starts, ends : float64 arrays (N,)
        Candidate windows in seconds.
    scores : array (S, N)
        The score of each window for each step.

    Returns
    -------
    indices : int64 array (S,)
        The window of each step.
    value : float
        Its summed scores less its gap costs; None instead of both where no sequence fits.
    """
    order = np.argsort(ends, kind="stable")
    starts, ends = starts[order], ends[order]
    scores = np.asarray(scores, np.float64)[:, order]
    before = np.searchsorted(ends, starts + 1e-6, side="right") - 1  # the last window that ends before each begins
    value, links = scores[0], []
    for step in scores[1:]:
        near, near_link = _best_before(value + GAP_COST * ends, before)
        far, far_link = _best_before(value - MAX_GAP_COST, before)
        near -= GAP_COST * starts
        links.append(np.where(near >= far, near_link, far_link))
        value = step + np.maximum(near, far)
    at = int(np.argmax(value))
    if not np.isfinite(value[at]):
        return None
    total, chain = float(value[at]), [at]
    for link in reversed(links):
        chain.append(int(link[chain[-1]]))
    return order[np.array(chain[::-1])].astype(np.int64), total


def _best_before(
    value: NDArray[np.float64], before: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The highest of the values up to each index in `before`, and its place; minus infinity before the first."""
    best = np.maximum.accumulate(value)
    leader = np.maximum.accumulate(np.where(value >= best, np.arange(len(value)), 0))
    return np.where(before >= 0, best[before], -np.inf), np.where(before >= 0, leader[before], -1)


def consecutive_spans(gain: Sequence[NDArray[np.float64]], shortest: int = 1) -> list[tuple[int, int]]:
    """Consecutive spans of frames, one a row, that add up to most; each begins where the one before ends or later.

    Kadane's algorithm for one row, its extension by dynamic programming for several: the best spans that end at each
    frame are the row's sum since the best beginning, plus the best spans of the rows before up to there.

    Parameters
    ----------
    gain : sequence of S float64 arrays (T',)
    shortest : int
        Frames of a span at least; fewer where there are too few for all rows.

    Returns
    -------
    list of (start, end), S ranges of frames, `end` exclusive
    """
    frames = len(gain[0])
    shortest = max(min(shortest, frames // len(gain)), 1)
    numbers = np.arange(frames + 1)
    before = np.zeros(frames + 1)  # the best spans of the rows so far that ends at or before each frame
    links = []
    for row in gain:
        total = np.concatenate([[0.0], np.cumsum(np.maximum(row, -1e6))])
        opening = before - total
        best = np.maximum.accumulate(opening)
        begin = np.maximum.accumulate(np.where(opening >= best, numbers, 0))
        ending = np.full(frames + 1, -np.inf)
        ending[shortest:] = total[shortest:] + best[:-shortest]
        before = np.maximum.accumulate(ending)
        end = np.maximum.accumulate(np.where(ending >= before, numbers, 0))
        links.append((np.concatenate([np.zeros(shortest, np.int64), begin[:-shortest]]), end))
    found, at = [], frames
    for begin, end in reversed(links):
        last = int(end[at])
        at = int(begin[last])
        found.append((at, last))
    return found[::-1]
