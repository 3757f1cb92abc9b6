"""The skeleton of the file that a motion was read from, in motion."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnknownRig
from encoders.geometry import rotation_between
from indexer.ingest.file_parts import read_part
from indexer.read_motion import Reading
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import RigMap, map_rig
from indexer.rigs.own_rig import as_own_rig
from indexer.rigs.retarget import frames_before_movement
from indexer.rigs.up_axis import up_axis
from indexer.take import UP_AXES, Take
from search.export.rig_motion import RigMotion

Array = NDArray[np.float64]

#: The directions of `UP_AXES`.
_AXES: Array = np.vstack([np.eye(3), -np.eye(3)])


@dataclass(frozen=True)
class SourceRig:
    """A file's take with its body and how it was read.

    Attributes
    ----------
    take : Take
        As read.
    rig : RigMap or None
        The body in it; None where a joint map is needed to find it.
    reading : Reading
        How it was read.
    origin : float
        The second of the file at which times begin: 0, or where the movement does in libraries of before.
    is_only : bool
        Whether the file holds no other motion.
    """

    take: Take
    rig: RigMap | None
    reading: Reading
    origin: float
    is_only: bool

    @classmethod
    def of(cls, path: Path, reading: Reading, duration: float) -> SourceRig:
        """The rig of a file, or of the part of it that `file#part` names, as it was read.

        Where that is not known, the `duration` of its motion tells the frame rate.

        Raises
        ------
        UnreadableMotion
            If it cannot be read.
        """
        file, take, is_only = read_part(path)
        rig = None
        with suppress(UnknownRig):
            rig = map_rig(take, file)
        if reading.source_fps:
            return cls(take, rig, reading, 0.0, is_only)
        fps = take.fps or 20.0
        own = as_own_rig(take)
        skipped = 0 if rig is None else frames_before_movement(own, rig if own is take else map_rig(own, file), fps)
        frames = len(take.positions) - skipped
        if abs(frames / fps - duration) > max(0.2, 2 / fps):  # it was read at another rate than the file states
            fps = frames / duration
        guessed = Reading(start=skipped / fps, source_fps=fps, source_frames=len(take.positions))
        return cls(take, rig, guessed, guessed.start, is_only)

    @property
    def fps(self) -> float:
        """Frames a second, as the motion was read with."""
        return self.reading.source_fps

    def span(self, start: float, end: float, duration: float) -> tuple[int, int]:
        """The first frame of a span in seconds, and how many it has; `duration` is that of the motion."""
        found = self.reading.frames(self.origin + start, self.origin + end, duration)
        first, last = (min(frame, len(self.take.positions) - 1) for frame in found or (0, 0))
        return first, last - first + 1

    def motion(self, first: int, count: int) -> RigMotion | None:
        """The skeleton of the body in `count` frames from frame `first` on; None where the file holds no rotations.

        Other trees of the file, such as cameras, are left out. Where the file says which axis is up it becomes Y, as
        BVH is read.
        """
        take = self.take
        rotations = None if take.rotations is None else take.rotations()
        if rotations is None or rotations.shape[:2] != take.positions.shape[:2]:
            return None
        kept = self._body()
        new = np.full(len(take.names) + 1, -1)
        new[kept] = np.arange(len(kept))
        turn = rotation_between(self._up_axis(), np.array([0.0, 1.0, 0.0])) if take.up else np.eye(3)
        frames = slice(first, first + count)
        return RigMotion(
            names=tuple(take.names[joint] for joint in kept),
            parents=new[take.parents[kept]],
            rest=take.rest[kept] @ turn.T,
            positions=take.positions[frames][:, kept] @ turn.T,
            rotations=turn @ rotations[frames][:, kept] @ turn.T,
            fps=self.fps,
        )

    def in_place(self, motion: RigMotion, first: int) -> RigMotion:
        """A cut of the take from frame `first` on, without the way the body travels over the floor."""
        if self.rig is None:
            roots = motion.positions[:, motion.parents < 0]
            return motion.in_place(self._up_axis(), roots[:, 0])
        marks = Landmarks.of(self.take.positions[first : first + len(motion)], self.rig)
        turn = rotation_between(self._up_axis(), np.array([0.0, 1.0, 0.0])) if self.take.up else np.eye(3)
        return motion.in_place(turn @ self._up_axis(), marks.middle("hip") @ turn.T)

    def _up_axis(self) -> Array:
        """The direction (3,) that is up in the file."""
        take, axis = as_own_rig(self.take), self.reading.up or self.take.up or "y"
        if not self.reading.up and self.rig is not None and not take.up_is_certain:
            marks, rest = (Landmarks.of(places, self.rig) for places in (self.take.positions, self.take.rest[None]))
            axis = up_axis(marks, rest, take.up).axis
        up: Array = _AXES[UP_AXES.index(axis)]
        return up

    def _body(self) -> NDArray[np.int64]:
        """The joints of the tree that holds the body."""
        parents = self.take.parents
        roots = np.arange(len(parents))
        for joint, parent in enumerate(parents):
            if parent >= 0:
                roots[joint] = roots[parent]
        if self.rig is None:
            return np.arange(len(parents))
        return np.flatnonzero(roots == roots[self.rig.joints["left_hip"]])
