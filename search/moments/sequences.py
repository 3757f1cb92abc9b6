"""Steps in order, found as consecutive spans of one take."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.bundle.windows import window_starts
from encoders.protocol import Encoder
from search.moments.boundaries import best_spans, frame_curve, gains
from search.moments.localisation import REACH, Moment, Region, fitness, frames_in, stretch
from search.moments.window_scores import Scored, Vectors, join, score_windows
from search.query.steps import in_order

#: Lengths in seconds of the windows from which steps are chosen; from one to the next it is a tenth of their length in
#: even frames, at least two.
_LENGTHS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0)
#: The shortest step, in seconds.
_LEAST = 0.5


def candidates(encoder: Encoder, features: Vectors, fps: float, queries: Vectors) -> Scored:
    """Windows of a take from which steps are chosen, compared with the steps' queries (S, D)."""
    frames = len(features)
    sizes = [size for size in (round(seconds * fps) for seconds in _LENGTHS) if size <= frames] or [frames]
    scored = [
        score_windows(encoder, features, fps, window_starts(frames, size, max(size // 20 * 2, 2)), size, queries)
        for size in sizes
    ]
    return join([*scored, *_longer(scored[-1])])


def _longer(windows: Scored) -> list[Scored]:
    """Spans of one and a half and of two windows, longer than the model takes in whole: the mean of both windows."""
    found = []
    for shift in (0.5, 1.0):
        later = np.searchsorted(windows.starts, windows.starts + shift * windows.lengths - 1e-6)
        fits = later < len(windows.starts)
        scores = np.float32(0.5) * (windows.scores[:, fits] + windows.scores[:, later[fits]])
        found.append(Scored(windows.starts[fits], windows.ends[later[fits]], scores))
    return found


def best_chain(windows: Scored) -> list[Moment]:
    """The best window of each step, each beginning after the one before has ended; none where no chain fits.

    Parameters
    ----------
    windows : Scored
        Candidates and their similarity to each step.
    """
    found = in_order(windows.starts, windows.ends, fitness(windows.scores, windows.lengths))
    return [
        Moment(float(windows.starts[i]), float(windows.ends[i]), float(windows.scores[step, i]))
        for step, i in enumerate(found[0] if found else ())
    ]


def refine_chain(
    encoder: Encoder, region: Region, fps: float, queries: Vectors, chain: Sequence[Moment], levels: Sequence[float]
) -> list[Moment]:
    """The chain with its boundaries where similarity over time rises and falls, still in order.

    Parameters
    ----------
    queries : float32 array (S, D)
        One a step.
    levels : sequence of float
        What motion that does not fit scores for each step.
    """
    start, end = max(chain[0].start - REACH, 0.0), chain[-1].end + REACH
    part, offset = stretch(region, fps, start, end)
    similarity = frame_curve(encoder, part, fps, queries)
    reach = round(REACH * fps)
    rows = []
    for values, step, level in zip(similarity, chain, levels, strict=True):
        first, last = frames_in(step, offset, fps, len(part))
        gain = gains(values, level, first, last)
        gain[: max(first - reach, 0)] = gain[last + reach :] = -np.inf
        rows.append(gain)
    return [
        Moment(offset + a / fps, offset + b / fps, float(values[a:b].mean()), float(values[a:b].max()))
        for values, (a, b) in zip(similarity, best_spans(rows, round(_LEAST * fps)), strict=True)
    ]


def whole(chain: Sequence[Moment]) -> Moment:
    """The span from the first step's start to the last one's end, with the mean of their similarities."""
    score, height = (float(np.mean(values)) for values in zip(*((s.score, s.height) for s in chain), strict=True))
    return Moment(chain[0].start, chain[-1].end, score, height)
