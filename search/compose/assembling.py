"""Assembling: the chosen cuts become one motion, joined where they follow each other, stitched where they overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.motion import FPS, Motion
from search.compose.candidates import Candidate
from search.compose.feet import planted, standing
from search.compose.joins import Piece, joined
from search.compose.rotations import Rotated
from search.compose.stitching import overlaid
from search.compose.timeline import Cut, Timeline

#: Seconds of a clip that are read around a cut, to be seen in the transitions.
_AROUND = 2.0


@dataclass(frozen=True, eq=False)
class Assembled:
    """A motion with the second at which its time line begins, and those at which a piece goes over into the next."""

    motion: Motion
    start: float
    joins: tuple[float, ...]


def assembled(timeline: Timeline, picked: Sequence[Candidate], before: Motion | None, transition: float) -> Assembled:
    """The motion of a time line whose intervals are shown by the candidates picked.

    Parameters
    ----------
    picked : sequence of Candidate
        One for each interval.
    before : Motion, optional
        What the motion begins with.
    transition : float
        Seconds in which one piece goes over into the next.
    """
    overlap, cuts = round(transition * FPS), timeline.cuts()
    shown = [
        _Shown.of(candidate, round(FPS * one.start)) for candidate, one in zip(picked, timeline.intervals, strict=True)
    ]
    pieces = [] if before is None else [Piece(Rotated.of(before.resample(FPS)), 0.0, 1.0, len(before.resample(FPS)))]
    offset = sum(piece.frames for piece in pieces)
    for base, start, end in _stretches(cuts):
        pieces += shown[base].pieces(round(FPS * start), round(FPS * end))
    body = joined(pieces, overlap)
    for i in sorted(range(len(shown)), key=lambda i: -len(timeline.intervals[i].parts)):
        parts = {part for cut in cuts for part, owner in cut.owners.items() if owner == i != cut.base}
        if parts:
            first, last = shown[i].frame - overlap // 2, round(FPS * timeline.intervals[i].end) + overlap // 2
            body = overlaid(body, joined(shown[i].pieces(first, last), overlap), parts, offset + first, overlap)
    joints = planted(body.joints(), np.concatenate([_rests(piece) for piece in pieces]), FPS)
    lengths = np.cumsum([piece.frames for piece in pieces])[:-1]
    return Assembled(
        Motion(joints.astype(np.float32), FPS), offset / FPS, tuple(float(frames) / FPS for frames in lengths)
    )


@dataclass(frozen=True, eq=False)
class _Shown:
    """A candidate from frame `frame` of the time line on: its clip around the cut, and where in it the cut begins."""

    candidate: Candidate
    frame: int
    clip: Rotated
    first: float

    @classmethod
    def of(cls, candidate: Candidate, frame: int) -> _Shown:
        begin = max(candidate.start - _AROUND, 0.0)
        clip = candidate.source.read(begin, min(candidate.end + _AROUND, candidate.source.duration))
        return cls(candidate, frame, Rotated.of(clip.resample(FPS)), (candidate.start - begin) * FPS)

    def pieces(self, start: int, end: int) -> list[Piece]:
        """Frames `start` to `end` of the time line, one piece for each time that the cut is shown."""
        start, end, times = start - self.frame, end - self.frame, self.candidate.repeats
        once = self.candidate.duration * FPS / self.candidate.rate
        pieces = []
        for time in range(times):
            begin = start if time == 0 else max(start, round(time * once))
            stop = end if time == times - 1 else min(end, round((time + 1) * once))
            if begin < stop:
                at = self.first + (begin - time * once) * self.candidate.rate
                pieces.append(Piece(self.clip, at, self.candidate.rate, stop - begin))
        return pieces


def _stretches(cuts: Sequence[Cut]) -> list[tuple[int, float, float]]:
    """The intervals that lead, in order, each with the start and end of the stretch in which it does."""
    found: list[tuple[int, float, float]] = []
    for cut in cuts:
        same = bool(found) and found[-1][0] == cut.base
        start = found.pop()[1] if same else cut.start
        found.append((cut.base, start, cut.end))
    return found


def _rests(piece: Piece) -> NDArray[np.bool_]:
    """Whether each foot rests (T, 2) in the clip that a piece shows."""
    at = np.clip(np.rint(piece.first + piece.rate * np.arange(piece.frames)), 0, len(piece.source) - 1)
    rests: NDArray[np.bool_] = standing(piece.source.joints(), FPS)[at.astype(int)]
    return rests
