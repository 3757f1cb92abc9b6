"""QueriedMotion: one question against one motion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import LENGTHS, WINDOWS_A_LENGTH
from encoders.protocol import Encoder, unrelated_motions
from search.moments.window_scores import STRIDE, Vectors, WindowScores, frame_curve, similarity_at
from search.query.question import EncodedQuestion
from search.source import MotionSource

#: Seconds above which a motion is long: in a library only the parts of it around candidates are read.
_LONG = 300.0
#: Seconds of motion read on either side of a part of a long clip: features at an instant depend on their surroundings.
_MARGIN = 8.0
#: Parts of a long clip begin at multiples of this, in seconds: their features are then those of the whole clip.
_PART_GRID = 1.0


@dataclass(frozen=True, eq=False)
class QueriedMotion:
    """A question against one motion: its windows' scores, its background level and similarity over time.

    Attributes
    ----------
    encoder : Encoder
    source : MotionSource
    question : EncodedQuestion
        Where it has several vectors that are not steps, a span must fit them all and scores as its worst.
    """

    encoder: Encoder
    source: MotionSource
    question: EncodedQuestion

    @property
    def queries(self) -> Vectors:
        """The unit query vectors (Q, D)."""
        return self.question.vectors

    @property
    def fps(self) -> float:
        """Feature frames a second."""
        return self.encoder.fps

    @property
    def is_long(self) -> bool:
        """Whether similarity is taken from the windows of the library's grid instead of every frame."""
        return self.source.duration > _LONG

    @cached_property
    def windows(self) -> list[WindowScores]:
        """The scores of the windows of the library's grid, the shortest length first."""
        return [
            WindowScores(
                w.starts.astype(np.float64), w.ends.astype(np.float64), self.queries @ w.vectors.astype(np.float32).T
            )
            for w in self.source.windows(self.encoder)
        ]

    @cached_property
    def background_level(self) -> float:
        """What motion scores that does not fit: the median of this motion or of unrelated motion, whichever is lower.

        This motion's own would mislead where one action fills it.
        """
        own, unrelated = self.windows[0].scores.min(axis=0), self._unrelated
        level = float(np.median(own))
        return level if unrelated is None else min(level, float(np.median(unrelated.min(axis=0))))

    @cached_property
    def step_levels(self) -> list[float]:
        """The `background_level` of each query by itself (Q,)."""
        alone = (replace(self.question, vectors=query[None]) for query in self.queries)
        return [replace(self, question=question).background_level for question in alone]

    @cached_property
    def _unrelated(self) -> Vectors | None:
        """Similarity (Q, M) of the model's unrelated motions; None where the model carries none."""
        motions = unrelated_motions(self.encoder)
        return None if motions is None else np.asarray(self.queries @ motions.T)

    def stretch(self, start: float, end: float) -> tuple[Vectors, float]:
        """The features from `start` to `end`, in seconds, as far as the motion goes, and the second they begin at.

        They begin at a multiple of `STRIDE` frames of the motion, so that a curve is the same wherever a stretch is
        cut. Of a long clip of a library only the part around it is read.
        """
        features, offset = self._part(start, end)
        first = min(max(round((start - offset) * self.fps), 0), len(features) - 1)
        first -= min((round(offset * self.fps) + first) % STRIDE, first)
        last = min(max(round((end - offset) * self.fps), first + 1), len(features))
        return features[first:last], offset + first / self.fps

    def _part(self, start: float, end: float) -> tuple[Vectors, float]:
        """Features that hold the span, and the second they begin at."""
        if not self.is_long or self.source.library is None:
            return self.source.features(self.encoder), 0.0
        first = max(start - _MARGIN, 0.0) // _PART_GRID * _PART_GRID
        return self.encoder.features(self.source.read(first, end + _MARGIN)), first

    def frame_curve(self, features: Vectors) -> Vectors:
        """Similarity over time (Q, T') of a stretch (T', F)."""
        return frame_curve(self.encoder, features, self.queries)

    def curve(self) -> tuple[NDArray[np.float64], Vectors]:
        """Similarity over time of the whole motion; of a long one, that of its shortest windows.

        Returns
        -------
        times : float64 array (T,)
            Seconds of the motion's file.
        similarity : float32 array (Q, T)
        """
        if self.is_long:
            times = np.arange(0, self.source.duration, LENGTHS[0] / WINDOWS_A_LENGTH, dtype=np.float64)
            return self.source.start + times, similarity_at(self.windows[0], times)
        similarity = self.frame_curve(self.source.features(self.encoder))
        times = (np.arange(similarity.shape[1], dtype=np.float64) + 0.5) / self.fps
        return self.source.start + times, similarity
