"""Joining in time: pieces of real motion one after the other, each placed where the one before leads.

At a join the later piece is turned about the vertical and moved over the ground until both agree there, never up or
down; both go on for a while beyond the join, as far as their clips have more, and are blended as rotations (Kovar et
al., "Motion graphs", SIGGRAPH 2002).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import length
from encoders.skeleton import INDEX
from search.compose.rotations import Rotated, about_vertical, concatenated

Array = NDArray[np.float64]

#: Longest blend, as a multiple of the usual one; half of one, in usual ones, for each metre between two poses.
_LONGEST, _SLOWNESS = 4, 8.0
_GROUND = np.array([1.0, 0.0, 1.0])
_LEFT = [INDEX["left_hip"], INDEX["left_shoulder"]]
_RIGHT = [INDEX["right_hip"], INDEX["right_shoulder"]]


@dataclass(frozen=True, eq=False)
class Piece:
    """What a stretch of frames shows.

    Attributes
    ----------
    source : Rotated
        The whole clip, of which more than the piece may be seen in joins.
    first : float
        Where in the clip, in frames, the piece begins.
    rate : float
        Frames of the clip for one of the piece.
    frames : int
        Frames of the piece.
    """

    source: Rotated
    first: float
    rate: float
    frames: int

    def sampled(self, start: int, end: int) -> Rotated:
        """Frames `start` to `end` of the piece; it goes on outside itself as far as the clip does."""
        return self.source.at(self.first + self.rate * np.arange(start, end, dtype=np.float64))


def joined(pieces: Sequence[Piece], overlap: int) -> Rotated:
    """The pieces one after the other, blended around each join.

    A blend takes `overlap` frames; more where the two poses lie far apart, and fewer where a piece is short.
    """
    longest = max(2 * longest_half(overlap), 1)
    done = pieces[0].sampled(0, pieces[0].frames + longest)
    frames = pieces[0].frames
    for before, piece in pairwise(pieces):
        most = min(longest, before.frames, piece.frames) // 2
        later, apart = aligned(piece.sampled(-most, piece.frames + longest), most, done, frames)
        half = min(half_blend(overlap, apart), most)
        later = later[most - half :]
        share = smooth((np.arange(2 * half) + 1) / (2 * half + 1))
        blend = done[frames - half : frames + half].blended(later[: 2 * half], share)
        done = concatenated([done[: frames - half], blend, later[2 * half :]])
        frames += piece.frames
    return done[:frames]


def half_blend(overlap: int, apart: float) -> int:
    """Frames on either side over which poses are blended whose joints are some metres apart."""
    return min(max(overlap // 2, round(_SLOWNESS * overlap * apart)), longest_half(overlap))


def longest_half(overlap: int) -> int:
    """The most frames of `half_blend`."""
    return _LONGEST * overlap // 2


def aligned(motion: Rotated, at: int, to: Rotated, frame: int) -> tuple[Rotated, float]:
    """A motion turned and moved over the ground so that its frame `at` stands and faces as a frame of another does.

    Returns
    -------
    The motion, and the metres by which the joints of these frames are apart then, on average.
    """
    goal, own = concatenated([to[frame : frame + 1], motion[at : at + 1]]).joints()
    yaw = float(heading(goal) - heading(own))
    turned = motion.moved(yaw, np.zeros(3))
    shift = (to.root[frame] - turned.root[at]) * _GROUND
    placed = about_vertical(own, yaw) + shift
    return turned.moved(0.0, shift), float(length(placed - goal).mean())


def heading(joints: Array) -> Array:
    """Angles (...,) about Y, from +Z towards +X, that bodies of joints (..., 22, 3) face."""
    across = (joints[..., _LEFT, :] - joints[..., _RIGHT, :]).sum(axis=-2)
    angle: Array = np.arctan2(-across[..., 2], across[..., 0])
    return angle


def smooth(share: Array) -> Array:
    """Shares from 0 to 1, eased at both ends: the mean of a straight line and of a smooth step."""
    s = np.clip(share, 0, 1)
    eased: Array = (s + s * s * (3 - 2 * s)) / 2
    return eased
