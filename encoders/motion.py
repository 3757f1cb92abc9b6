"""Motion: what a body does, as 22 joints in metres, Y up, at a steady frame rate."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

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

    Raises
    ------
    TypeError
        If the joints are no array of real numbers, or the frame rate is no number.
    ValueError
        If the joints have another shape or are not finite, or the frame rate is not positive.
    """

    joints: NDArray[np.float32]
    fps: float = FPS

    def __post_init__(self) -> None:
        joints, fps = joint_array(self.joints, np.float32), _positive(self.fps)
        joints.flags.writeable = False
        object.__setattr__(self, "joints", joints)
        object.__setattr__(self, "fps", fps)

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
        TypeError, ValueError
            If the rate is not a positive number.
        """
        fps = _positive(fps)
        if fps == self.fps:
            return self
        return Motion(resample(self.joints, self.fps, fps), fps)

    def _repr_html_(self) -> str:
        """The motion, moving, in a notebook."""
        return player([(self.joints, self.fps, f"{self.duration:.1f} s")])

    def mirror(self) -> Motion:
        """Left and right swapped, x flipped."""
        return Motion(self.joints[:, MIRROR] * np.array([-1, 1, 1], np.float32), self.fps)


def joint_array(joints: Any, dtype: DTypeLike) -> NDArray[Any]:
    """A copy of the joints (T, 22, 3) of a motion as an array of `dtype`.

    Raises
    ------
    TypeError
        If they are no array of integers or real numbers; one with masked values is none.
    ValueError
        If they have another shape, or are not finite.
    """
    given = np.asarray(joints)
    if given.dtype.kind not in "fiu" or isinstance(joints, np.ma.MaskedArray):
        kind = "masked values" if isinstance(joints, np.ma.MaskedArray) else given.dtype
        raise TypeError(f"joints must be an array of real numbers (T, {len(JOINTS)}, 3), not of {kind}")
    if given.ndim != 3 or given.shape[1:] != (len(JOINTS), 3) or len(given) == 0:
        raise ValueError(f"joints.shape={given.shape} must be (T, {len(JOINTS)}, 3) with T >= 1")
    with np.errstate(over="ignore"):
        array = np.array(given, dtype)
    if not np.isfinite(array).all():
        raise ValueError("joints must be finite")
    return array


def _positive(fps: Any) -> float:
    if isinstance(fps, bool) or not isinstance(fps, Real):
        raise TypeError(f"fps={fps!r} must be a number")
    rate = float(fps)
    if not (np.isfinite(rate) and rate > 0):
        raise ValueError(f"fps={fps} must be positive")
    return rate
