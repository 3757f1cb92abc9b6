"""Stitched scores: how well each interval is recognised as its sentence once the others are laid over and beside it.

A cut that is near its sentence alone need not be so when an arm of it is somebody else's. So the cuts of an interval
are compared as they would come out, but for the feet, of which a score hardly knows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from search.compose.candidates import Candidate
from search.compose.joins import Piece, joined, longest_half
from search.compose.rotations import Rotated, concatenated
from search.compose.shown import Shown, frames_of, layers, stretches
from search.compose.stitching import overlaid
from search.compose.timeline import Timeline

Scores = NDArray[np.float64]


class StitchedScores:
    """Scores of the intervals of a time line for choices among the candidates offered; each is computed once.

    Parameters
    ----------
    offered : sequence of sequences of Candidate
        Of each interval.
    queries : array (N, D)
        Unit vector of each interval's sentence.
    transition : float
        Seconds in which one piece goes over into the next.
    """

    def __init__(
        self,
        timeline: Timeline,
        offered: Sequence[Sequence[Candidate]],
        queries: NDArray[np.float32],
        encoder: Encoder,
        transition: float,
    ) -> None:
        cuts = timeline.cuts()
        self._frames, self._stretches, self._layers = frames_of(timeline), stretches(cuts), layers(timeline, cuts)
        self._queries, self._encoder, self._overlap = queries, encoder, round(transition * FPS)
        self._margin = margin = longest_half(self._overlap)
        self._tracks = [
            [joined(Shown(one, first, end).pieces(first - margin, end + margin), self._overlap) for one in options]
            for options, (first, end) in zip(offered, self._frames, strict=True)
        ]
        self._known: dict[tuple[int, ...], float] = {}
        #: The intervals that are seen during each, itself among them.
        self.seen = [
            [j for j, (a, b) in enumerate(self._frames) if min(b, end) - max(a, first) > 0]
            for first, end in self._frames
        ]

    def of(self, interval: int, choices: Sequence[Sequence[int]]) -> Scores:
        """Scores (C,) of an interval for choices of a candidate for every interval."""
        keys = [(interval, *(choice[j] for j in self.seen[interval])) for choice in choices]
        new = {key: choice for key, choice in zip(keys, choices, strict=True) if key not in self._known}
        if new:
            crops = [self._crop(interval, choice) for choice in new.values()]
            joints = concatenated(crops).joints().astype(np.float32)
            pieces = np.split(joints, np.cumsum([len(crop) for crop in crops])[:-1])
            vectors = self._encoder.encode_motions([Motion(piece, FPS) for piece in pieces])
            self._known |= zip(new, (vectors @ self._queries[interval]).tolist(), strict=True)
        return np.array([self._known[key] for key in keys])

    def _crop(self, interval: int, choice: Sequence[int]) -> Rotated:
        first, end = self._frames[interval]
        pieces = [
            Piece(
                self._tracks[i][choice[i]], self._place(i, max(start, first)), 1.0, min(stop, end) - max(start, first)
            )
            for i, start, stop in self._stretches
            if max(start, first) < min(stop, end)
        ]
        crop = joined(pieces, self._overlap)
        for i, parts in self._layers:
            if i in self.seen[interval]:
                start, stop = (frame - first for frame in self._frames[i])
                crop = overlaid(crop, self._tracks[i][choice[i]], parts, (start, stop), self._margin, self._overlap)
        return crop

    def _place(self, interval: int, frame: int) -> int:
        """Where a frame of the time line is in the tracks of an interval."""
        return frame - self._frames[interval][0] + self._margin
