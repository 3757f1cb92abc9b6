"""QueriedMotion: one question against one motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.moments.window_scores import Vectors, WindowScores, similarity_over_time
from search.query.question import EncodedQuestion
from search.source import MotionSource
from search.spans import Moment

#: Seconds above which a motion is long, and the frames from one value to the next that is then shown of its curve.
_LONG, _SHOWN_EVERY = 300.0, 4


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
        own, unrelated = self.windows[0].scores.min(axis=0), self.question.unrelated(self.encoder)
        level = float(np.median(own))
        return level if unrelated is None else min(level, float(np.median(unrelated.min(axis=0))))

    @cached_property
    def step_levels(self) -> list[float]:
        """The `background_level` of each query by itself (Q,)."""
        levels, unrelated = np.median(self.windows[0].scores, axis=1), self.question.unrelated(self.encoder)
        lower = levels if unrelated is None else np.minimum(levels, np.median(unrelated, axis=1))
        return [float(level) for level in lower]

    @cached_property
    def similarity(self) -> Vectors:
        """Similarity over time (Q, T'), one value for each feature frame."""
        frames = max(round(float(self.windows[0].ends[-1]) * self.fps), 1)
        return similarity_over_time(self.windows, (np.arange(frames, dtype=np.float64) + 0.5) / self.fps)

    def peaks(self, moment: Moment) -> tuple[float, ...]:
        """The highest similarity to each query (Q,) within a moment of this motion."""
        if len(self.queries) == 1:
            return (moment.peak_score,)
        first = int(moment.start * self.fps)
        return tuple(self.similarity[:, first : max(round(moment.end * self.fps), first + 1)].max(axis=1).tolist())

    def curve(self) -> tuple[NDArray[np.float64], Vectors]:
        """Similarity over time to show; of a long motion every fourth value.

        Returns
        -------
        times : float64 array (T,)
            Seconds of the motion's file.
        similarity : float32 array (Q, T)
        """
        times = self.source.start + (np.arange(self.similarity.shape[1], dtype=np.float64) + 0.5) / self.fps
        every = _SHOWN_EVERY if self.source.duration > _LONG else 1
        return times[::every], self.similarity[:, ::every]
