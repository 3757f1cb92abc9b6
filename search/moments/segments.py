"""Segments: a whole motion divided among labels, with an empty label where none fits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_sentences
from encoders.errors import ArgumentError
from encoders.protocol import Encoder, unrelated_motions
from search.moments.queried_motion import QueriedMotion
from search.moments.window_scores import Vectors
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.query.vocabulary import vocabulary
from search.ranking.strength import Judge
from search.source import MotionSource

#: The label of what none of the labels fits.
UNKNOWN = ""

#: What changing the label costs, in seconds times cosine.
_SWITCH = 0.075
#: A label must score so much more than nine of ten unrelated motions score for it.
_MARGIN = 0.02
_BACKGROUND_PERCENTILE = 90


@dataclass(frozen=True)
class Segment:
    """A span in seconds, its label (`UNKNOWN` where none fits), its mean similarity to it, and how strong that is."""

    start: float
    end: float
    label: str
    score: float
    strength: str = ""


def segment_motion(encoder: Encoder, source: MotionSource, labels: Sequence[str] | None = None) -> list[Segment]:
    """Divide a motion among labels so that the segments cover it all, in order, without overlap.

    The similarity of each label over time, less what unrelated motion scores for it, goes through Viterbi's algorithm
    with a cost for each change.

    Parameters
    ----------
    labels : sequence of str, optional
        The shipped vocabulary if not given.

    Raises
    ------
    ArgumentError
        If there are no labels, or they are not a list of strings.
    """
    labels = vocabulary() if labels is None else checked_sentences("labels", labels)
    if not labels:
        raise ArgumentError("there are no labels to choose from")
    queries = encode_queries(encoder, labels)
    similarity = QueriedMotion(encoder, source, EncodedQuestion(queries, tuple(labels))).similarity
    excess = similarity - _unrelated(encoder, queries, similarity)[:, None] - _MARGIN
    path = best_path(np.vstack([np.zeros(excess.shape[1]), excess]), _SWITCH * encoder.fps)
    starts = np.flatnonzero(np.diff(path, prepend=-1))
    ends = np.append(starts[1:], len(path))
    used = np.unique(path[path > 0]) - 1
    judges = {label: Judge(encoder, EncodedQuestion(queries[[label]], (labels[label],))) for label in used}
    return [
        Segment(
            source.start + float(a / encoder.fps),
            source.start + (float(b / encoder.fps) if b < len(path) else source.duration),
            labels[path[a] - 1] if path[a] else UNKNOWN,
            float(similarity[path[a] - 1, a:b].mean()) if path[a] else 0.0,
            judges[path[a] - 1]([similarity[path[a] - 1, a:b].max()]) if path[a] else "",
        )
        for a, b in zip(starts, ends, strict=True)
    ]


def best_path(gains: NDArray[np.floating], switch: float) -> NDArray[np.int64]:
    """The state at each instant that gains most in sum, each change of state costing `switch` (Viterbi).

    Parameters
    ----------
    gains : array (S, T)

    Returns
    -------
    int64 array (T,)
    """
    states, count = gains.shape
    came_from = np.empty((count, states), np.int16)
    own = np.arange(states)
    value = np.asarray(gains[:, 0], np.float64)
    for t in range(1, count):  # each instant needs the one before
        leader = int(np.argmax(value))
        change = value[leader] - switch
        came_from[t] = np.where(value >= change, own, leader)
        value = np.maximum(value, change) + gains[:, t]
    path = np.empty(count, np.int64)
    path[-1] = int(np.argmax(value))
    for t in range(count - 1, 0, -1):
        path[t - 1] = came_from[t, path[t]]
    return path


def _unrelated(encoder: Encoder, queries: Vectors, similarity: Vectors) -> NDArray[np.floating]:
    """What unrelated motion scores for each label (L,): the model's background, else the take's own median."""
    motions = unrelated_motions(encoder)
    if motions is None:
        return np.asarray(np.median(similarity, axis=1))
    return np.asarray(np.percentile(queries @ motions.T, _BACKGROUND_PERCENTILE, axis=1))
