"""A skeleton in motion with rotations, as files of animation hold it; cut, resampled, kept in place."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import interpolate, length
from search.export.quaternions import slerp, to_matrices, to_quaternions

Array = NDArray[np.float64]

#: Of the skeleton's extent: a joint that strays farther from its place on its parent has moved.
_STILL = 2e-5


@dataclass(frozen=True)
class RigMotion:
    """A skeleton in motion.

    Attributes
    ----------
    names : tuple of str
        Joint names, parents before children.
    parents : int array (J,)
        Parent of each joint, -1 for a root.
    rest : float array (J, 3)
        Joint positions of the rest pose.
    positions : float array (T, J, 3)
        Joint positions in the world, in the units of `rest`.
    rotations : float array (T, J, 3, 3)
        Rotations in the world that turn the bones of the rest pose into those of a frame.
    fps : float
        Frames a second.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int64]
    rest: Array
    positions: Array
    rotations: Array
    fps: float

    def __len__(self) -> int:
        return len(self.positions)

    @cached_property
    def turns(self) -> Array:
        """Rotations (T, J, 3, 3) in the frames of the parents."""
        turns: Array = self.rotations.copy()
        inner = np.flatnonzero(self.parents >= 0)
        above = self.rotations[:, self.parents[inner]]
        turns[:, inner] = np.swapaxes(above, -1, -2) @ self.rotations[:, inner]
        return turns

    @cached_property
    def places(self) -> Array:
        """Positions (T, J, 3) in the frames of the parents."""
        places: Array = self.positions.copy()
        inner = np.flatnonzero(self.parents >= 0)
        bones = self.positions[:, inner] - self.positions[:, self.parents[inner]]
        places[:, inner] = np.einsum("tjba,tjb->tja", self.rotations[:, self.parents[inner]], bones)
        return places

    @cached_property
    def offsets(self) -> Array:
        """Where joints (J, 3) are on their parents at rest: by the rest pose, else where they mostly are."""
        at_rest = self.rest.copy()
        inner = np.flatnonzero(self.parents >= 0)
        at_rest[inner] -= self.rest[self.parents[inner]]
        usual = np.median(self.places, axis=0)
        other = (length(usual - at_rest) > self._still) & (self.parents >= 0)
        return np.where(other[:, None], usual, at_rest)

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """Which joints (J,) move on their parents, so that their positions must be written; roots always."""
        strays = length(self.places - self.offsets).max(axis=0)
        moving: NDArray[np.bool_] = (strays > self._still) | (self.parents < 0)
        return moving

    @cached_property
    def children(self) -> list[list[int]]:
        """The children of each joint."""
        children: list[list[int]] = [[] for _ in self.names]
        for joint, parent in enumerate(self.parents):
            if parent >= 0:
                children[parent].append(joint)
        return children

    @property
    def _still(self) -> float:
        """A distance that is none, in the units of `rest`."""
        far = float(np.abs(self.positions).max())  # positions may come from single precision
        return _STILL * float(np.ptp(self.rest, axis=0).max()) + 4 * float(np.finfo(np.float32).eps) * far

    def cut(self, first: int, count: int) -> RigMotion:
        """`count` frames from frame `first` on."""
        frames = slice(first, first + count)
        return replace(self, positions=self.positions[frames], rotations=self.rotations[frames])

    def scaled(self, factor: float) -> RigMotion:
        """The same in other units."""
        return replace(self, rest=self.rest * factor, positions=self.positions * factor)

    def resampled(self, fps: float) -> RigMotion:
        """The motion at another frame rate: joints turn evenly from frame to frame, and bones keep their lengths."""
        if fps == self.fps:
            return self
        count = int(np.floor((len(self) - 1) * fps / self.fps + 1e-6)) + 1
        at = np.arange(count, dtype=np.float64) * (self.fps / fps)
        turns = to_matrices(slerp(to_quaternions(self.turns), at))
        places = interpolate(self.places, at)
        rotations, positions = turns, places
        for joint, parent in enumerate(self.parents):
            if parent >= 0:
                rotations[:, joint] = rotations[:, parent] @ turns[:, joint]
                bones = (rotations[:, parent] @ places[:, joint, :, None])[..., 0]
                positions[:, joint] = positions[:, parent] + bones
        return replace(self, positions=positions, rotations=rotations, fps=fps)

    def in_place(self, up: Array, hips: Array) -> RigMotion:
        """The motion without the way that the hips (T, 3) travel square to `up` (3,).

        Joints that never move, such as an origin above the hips, stay where they are.
        """
        way = hips - hips[0]
        way = way - up * (way @ up)[:, None]
        moves = np.ptp(self.positions, axis=0).max(axis=-1) > self._still
        return replace(self, positions=self.positions - way[:, None] * moves[:, None])
