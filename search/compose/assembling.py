"""Assembling: the chosen cuts become one motion, joined where they follow each other, stitched where they overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.motion import FPS, Motion
from search.compose.candidates import Candidate
from search.compose.feet import planted, standing
from search.compose.joins import Piece, joined, longest_half
from search.compose.rotations import Rotated
from search.compose.shown import Shown, frames_of, layers, stretches
from search.compose.stitching import overlaid
from search.compose.timeline import Timeline


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
    shown = [Shown(one, *span) for one, span in zip(picked, frames_of(timeline), strict=True)]
    pieces = [] if before is None else [Piece(Rotated.of(before.resample(FPS)), 0.0, 1.0, len(before.resample(FPS)))]
    offset = sum(piece.frames for piece in pieces)
    for base, start, end in stretches(cuts):
        pieces += shown[base].pieces(start, end)
    body, margin = joined(pieces, overlap), longest_half(overlap)
    for i, parts in layers(timeline, cuts):
        layer = joined(shown[i].pieces(shown[i].frame - margin, shown[i].end + margin), overlap)
        body = overlaid(body, layer, parts, (offset + shown[i].frame, offset + shown[i].end), margin, overlap)
    joints = planted(body.joints(), np.concatenate([_rests(piece) for piece in pieces]), FPS)
    lengths = np.cumsum([piece.frames for piece in pieces])[:-1]
    return Assembled(
        Motion(joints.astype(np.float32), FPS), offset / FPS, tuple(float(frames) / FPS for frames in lengths)
    )


def _rests(piece: Piece) -> NDArray[np.bool_]:
    """Whether each foot rests (T, 2) in the clip that a piece shows."""
    at = np.clip(np.rint(piece.first + piece.rate * np.arange(piece.frames)), 0, len(piece.source) - 1)
    rests: NDArray[np.bool_] = standing(piece.source.joints(), FPS)[at.astype(int)]
    return rests
