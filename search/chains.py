"""Steps in order, found as consecutive spans of one take."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from search.dense import Encoder, Scored, Vectors, every, join, score_windows
from search.moments import Moment, score_take
from search.refine import LENGTHS, fitness
from search.steps import in_order

#: Takes up to so many feature frames are searched densely; longer ones by their coarse windows.
_DENSE_FRAMES = 3000
_STRIDE = 2


def candidates(encoder: Encoder, features: Vectors, fps: float, queries: Vectors) -> Scored:
    """Windows of a take from which steps are chosen, compared with the steps' queries (S, D)."""
    frames = len(features)
    if frames > _DENSE_FRAMES:
        return join(score_take(encoder, features, fps, queries))
    sizes = [size for size in (round(seconds * fps) for seconds in LENGTHS) if size <= frames] or [frames]
    return join([score_windows(encoder, features, fps, every(frames, size, _STRIDE), size, queries) for size in sizes])


def best_chain(windows: Scored) -> tuple[list[Moment], float] | None:
    """The best span of each step, each beginning after the one before has ended, and the value of the whole.

    Parameters
    ----------
    windows : Scored
        Candidates and their similarity to each step.
    """
    found = in_order(windows.starts, windows.ends, fitness(windows))
    if found is None:
        return None
    chosen, value = found
    return [
        Moment(float(windows.starts[i]), float(windows.ends[i]), float(windows.scores[step, i]))
        for step, i in enumerate(chosen)
    ], value


def whole(chain: Sequence[Moment]) -> Moment:
    """The span from the first step's start to the last one's end, with the mean of their similarities."""
    return Moment(chain[0].start, chain[-1].end, float(np.mean([step.score for step in chain])))
