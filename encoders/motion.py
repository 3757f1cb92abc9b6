"""Motion: what a body does, as 22 joints in metres, Y up, at a steady frame rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.drawing.player import player
from encoders.geometry import resample
from encoders.skeleton import JOINTS, MIRROR

FPS = 20.0


@dataclass(frozen=True, eq=False, repr=False)
class Motion:
    """A motion on the 22-joint skeleton. Motions of the same joints and frame rate are equal.

    Attributes
    ----------
    joints : float32 array (T, 22, 3)
        Positions in metres, Y up; read-only.
    fps : float
        Frames a second.
    """

    joints: NDArray[np.float32]
    fps: float = FPS

    def __post_init__(self) -> None:
        joints = np.array(self.joints, dtype=np.float32)
        if joints.ndim != 3 or joints.shape[1:] != (len(JOINTS), 3) or len(joints) == 0:
            raise ValueError(f"joints.shape={joints.shape} must be (T, {len(JOINTS)}, 3) with T >= 1")
        if not np.isfinite(joints).all():
            raise ValueError("joints must be finite")
        if not (np.isfinite(self.fps) and self.fps > 0):
            raise ValueError(f"fps={self.fps} must be positive")
        joints.flags.writeable = False
        object.__setattr__(self, "joints", joints)
        object.__setattr__(self, "fps", float(self.fps))

    def __len__(self) -> int:
        return len(self.joints)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Motion):
            return NotImplemented
        return self.fps == other.fps and np.array_equal(self.joints, other.joints)

    def __hash__(self) -> int:
        return hash((self.fps, len(self), float(self.joints[0].sum())))  # not of the bytes: 0.0 and -0.0 are equal

    def __repr__(self) -> str:
        return f"Motion({len(self)} frames, {self.duration:.1f} s at {self.fps:g} fps)"

    @property
    def duration(self) -> float:
        """Seconds, counting each frame for one frame's time."""
        return len(self.joints) / self.fps

    def crop(self, start: float = 0.0, end: float | None = None) -> Motion:
        """The frames from `start` to `end`, in seconds; at least one frame.

        Raises
        ------
        ValueError
            If the span is empty or does not touch the motion.
        """
        end = self.duration if end is None else min(end, self.duration)
        if not start < end or end <= 0:
            raise ValueError(f"span {start:g} to {end:g} s lies outside a motion of {self.duration:g} s")
        first, last = min(round(max(start, 0.0) * self.fps), len(self.joints) - 1), round(end * self.fps)
        return Motion(self.joints[first : max(last, first + 1)], self.fps)

    def resample(self, fps: float = FPS) -> Motion:
        """The same movement at another rate: joint positions interpolated linearly on the true time grid.

        Raises
        ------
        ValueError
            If the rate is not a positive number.
        """
        if fps == self.fps:
            return self
        return Motion(resample(self.joints, self.fps, fps), fps)

    def _repr_html_(self) -> str:
        """The motion, moving, in a notebook."""
        return player([(self.joints, self.fps, f"{self.duration:.1f} s")])

    def mirror(self) -> Motion:
        """Left and right swapped, x flipped."""
        return Motion(self.joints[:, MIRROR] * np.array([-1, 1, 1], np.float32), self.fps)
