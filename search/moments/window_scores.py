"""Windows of a motion compared with queries, and the similarity over time that they give, in bounded memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import interpolate
from encoders.protocol import Encoder

Vectors = NDArray[np.float32]
Frames = NDArray[np.int64]

#: The shortest lengths of the grid whose similarities are averaged at each instant: 1.6 and 3.2 s.
_CURVE_LENGTHS = 2
#: Windows whose vectors are held at once.
_CHUNK = 4096


@dataclass(frozen=True)
class WindowScores:
    """Windows of a motion, most often of one length, and their similarity to each query.

    Attributes
    ----------
    starts, ends : float64 arrays (N,)
        Seconds.
    scores : float32 array (Q, N)
    """

    starts: NDArray[np.float64]
    ends: NDArray[np.float64]
    scores: Vectors

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Seconds (N,)."""
        return self.ends - self.starts


def join(parts: Sequence[WindowScores]) -> WindowScores:
    """All windows of all parts."""
    return WindowScores(
        np.concatenate([p.starts for p in parts]),
        np.concatenate([p.ends for p in parts]),
        np.concatenate([p.scores for p in parts], axis=1),
    )


def score_windows(encoder: Encoder, features: Vectors, starts: Frames, length: int, queries: Vectors) -> WindowScores:
    """Windows of one length compared with queries.

    Parameters
    ----------
    features : float32 array (T', F)
        Of the motion.
    starts : int64 array (N,)
        First feature frames.
    length : int
        Feature frames.
    queries : float32 array (Q, D)
        Unit vectors.
    """
    scores = np.empty((len(queries), len(starts)), np.float32)
    for first in range(0, len(starts), _CHUNK):
        chunk = slice(first, first + _CHUNK)
        scores[:, chunk] = queries @ encoder.encode_windows(features, starts[chunk], length).T
    return WindowScores(starts / encoder.fps, (starts + length) / encoder.fps, scores)


def similarity_at(windows: WindowScores, times: NDArray[np.float64]) -> Vectors:
    """Similarity over time (Q, T): that of the window centred at each time, interpolated between the centres.

    Parameters
    ----------
    windows : WindowScores
        Of one length, in order.
    times : float64 array (T,)
        Seconds.
    """
    centres = (windows.starts + windows.ends) / 2
    return interpolate(windows.scores, np.interp(times, centres, np.arange(len(centres))), axis=1)


def similarity_over_time(windows: Sequence[WindowScores], times: NDArray[np.float64]) -> Vectors:
    """Similarity (Q, T) at times in seconds (T,): the mean of the curves of the two shortest lengths of the grid.

    Parameters
    ----------
    windows : sequence of WindowScores
        Of each length of the grid, the shortest first.
    """
    curves = [similarity_at(of_length, times) for of_length in windows[:_CURVE_LENGTHS]]
    return np.asarray(np.mean(curves, axis=0), np.float32)
