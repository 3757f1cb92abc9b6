"""Curves: a movement as a few smooth channels over time, from which a body is posed by inverse kinematics.

They describe a canonical body of about 1.7 m in the performer's own frame: the movement starts at the origin facing
+Z, Y is up, left is +X. All channels lie in one array (F, 45), so that joining, warping and mirroring are single
operations; the named properties are writable views of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.motion import FPS

Array = NDArray[np.float64]

STAND = 0.90  #: height of the hip centre above the ground, standing relaxed
ANKLE = 0.085  #: height of the ankle above the ground, foot flat
HIP = 0.095  #: half the distance between the feet, standing relaxed
LEFT, RIGHT = 0, 1
SIDE_INDEX = {"left": LEFT, "right": RIGHT}

LEGS = frozenset({"legs"})
ARMS = frozenset({"left_arm", "right_arm"})
TORSO = frozenset({"spine", "head"})
BODY = frozenset({"legs", "spine", "head", "left_arm", "right_arm"})

_LEGS = [*range(0, 7), *range(13, 25)]
#: Channels that each part of the body owns.
PART_CHANNELS: dict[str, NDArray[np.int64]] = {
    "legs": np.array(_LEGS),
    "spine": np.arange(7, 10),
    "head": np.arange(10, 13),
    "left_arm": np.arange(25, 35),
    "right_arm": np.arange(35, 45),
}
CHANNELS = 45
_PAIRED = np.array([*range(0, 13), *range(19, 25), *range(13, 19), *range(35, 45), *range(25, 35)])
_MIRROR_SIGN = np.ones(CHANNELS)
_MIRROR_SIGN[[0, 3, 5, 6, 8, 9, 11, 12, 13, 17, 18, 19, 23, 24, 31, 41]] = -1

#: Wrist of a relaxed hanging arm: outward, upward, forward of its own shoulder, in arm lengths.
HANGING = (0.13, -0.965, 0.08)


class Curves:
    """Channels of F frames; see the properties. Angles in radians, positions in metres.

    Attributes
    ----------
    data : float array (F, 45)
        All channels.
    spans : list of (int, int)
        First and past-the-last frame of each action; idle lead-in and lead-out excluded.
    parts : frozenset of str
        The body parts that the movement occupies: "legs" (with translation and heading), "spine", "head",
        "left_arm", "right_arm". Other parts may be taken over by a simultaneous action.
    """

    def __init__(self, data: Array, spans: Sequence[tuple[int, int]], parts: frozenset[str] = BODY) -> None:
        self.data = data
        self.spans = list(spans)
        self.parts = parts

    def __len__(self) -> int:
        return len(self.data)

    @property
    def root(self) -> Array:
        """Hip centre, (F, 3); at height `STAND` when standing."""
        return self.data[:, 0:3]

    @property
    def heading(self) -> Array:
        """Where the body faces, (F,): 0 is +Z, positive turns to the left (+X)."""
        return self.data[:, 3]

    @property
    def pelvis(self) -> Array:
        """Pelvis relative to the heading, (F, 3): pitch forward, roll to the left, yaw to the left."""
        return self.data[:, 4:7]

    @property
    def spine(self) -> Array:
        """Chest relative to the pelvis, (F, 3): bend forward, to the left, twist to the left."""
        return self.data[:, 7:10]

    @property
    def head(self) -> Array:
        """Head relative to the chest, (F, 3): nod forward (down), tilt to the left, turn to the left."""
        return self.data[:, 10:13]

    @property
    def feet(self) -> Array:
        """Ankles in the world, (F, 2, 3), left then right."""
        return self.data[:, 13:25].reshape(-1, 2, 6)[..., 0:3]

    @property
    def foot_pitch(self) -> Array:
        """Toes up positive, (F, 2)."""
        return self.data[:, 13:25].reshape(-1, 2, 6)[..., 3]

    @property
    def foot_yaw(self) -> Array:
        """Where the toes point in the world, (F, 2), as `heading`."""
        return self.data[:, 13:25].reshape(-1, 2, 6)[..., 4]

    @property
    def knee(self) -> Array:
        """Swing of the knee about the line from hip to ankle, (F, 2), positive to the left (+X)."""
        return self.data[:, 13:25].reshape(-1, 2, 6)[..., 5]

    @property
    def hands(self) -> Array:
        """Wrists from their own shoulders, (F, 2, 3): outward, upward, forward, arm lengths; in the chest's frame."""
        return self.data[:, 25:45].reshape(-1, 2, 10)[..., 0:3]

    @property
    def elbow(self) -> Array:
        """Swing of the elbow about the line from shoulder to wrist, (F, 2), positive outward and up."""
        return self.data[:, 25:45].reshape(-1, 2, 10)[..., 3]

    @property
    def hang(self) -> Array:
        """How much `hands` follow gravity instead of the chest's lean, (F, 2), 0 to 1."""
        return self.data[:, 25:45].reshape(-1, 2, 10)[..., 4]

    @property
    def reach(self) -> Array:
        """Wrists in the world, (F, 2, 3); blended by `reach_weight`."""
        return self.data[:, 25:45].reshape(-1, 2, 10)[..., 6:9]

    @property
    def reach_weight(self) -> Array:
        """Blend from `hands` (0) to `reach` (1), (F, 2)."""
        return self.data[:, 25:45].reshape(-1, 2, 10)[..., 5]

    @property
    def shrug(self) -> Array:
        """Shoulder raised, (F, 2), radians of the collar bone."""
        return self.data[:, 25:45].reshape(-1, 2, 10)[..., 9]

    def mirrored(self) -> Curves:
        """Left and right swapped."""
        swap = {"left_arm": "right_arm", "right_arm": "left_arm"}
        parts = frozenset(swap.get(part, part) for part in self.parts)
        return Curves(self.data[:, _PAIRED] * _MIRROR_SIGN, self.spans, parts)


def standing(frames: int, parts: frozenset[str] = BODY) -> Curves:
    """A body standing relaxed at the origin, arms hanging; its span is the whole clip."""
    return Curves(np.repeat(_STANDING, frames, axis=0), [(0, frames)], parts)


def _standing_row() -> Array:
    curves = Curves(np.zeros((1, CHANNELS)), [])
    curves.root[:, 1] = STAND
    curves.feet[:] = [[HIP, ANKLE, 0.0], [-HIP, ANKLE, 0.0]]
    curves.foot_yaw[:] = [0.12, -0.12]
    curves.hands[:] = HANGING
    curves.hang[:] = 0.8
    return curves.data


_STANDING = _standing_row()


def frames_of(seconds: float) -> int:
    """Number of frames of a duration, at least two."""
    return max(2, round(seconds * FPS))


def ease(x: ArrayLike) -> Array:
    """Smoothstep: 0 below 0, 1 above 1, zero slope at either end."""
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))


def keys(frames: int, poses: Sequence[tuple[float, ArrayLike]]) -> Array:
    """Interpolate key values with a rest at each: (F, ...) from pairs of (share of the duration in 0..1, value).

    Constant before the first and after the last; two equal values in a row hold the pose.
    """
    times = np.array([time for time, _ in poses])
    values = np.array([value for _, value in poses], dtype=np.float64)
    now = np.arange(frames) / max(frames - 1, 1)
    after = np.clip(np.searchsorted(times, now, side="right"), 1, len(times) - 1)
    before = after - 1
    share = ease((now - times[before]) / np.maximum(times[after] - times[before], 1e-9))
    share = share.reshape(-1, *([1] * (values.ndim - 1)))
    return np.asarray(values[before] * (1 - share) + values[after] * share)


def hold(frames: int, rise: float = 0.25, fall: float = 0.25) -> Array:
    """0 to 1 and back, (F,): rising over the first share of the duration, falling over the last."""
    now = np.arange(frames) / max(frames - 1, 1)
    return ease(now / max(rise, 1e-6)) * ease((1 - now) / max(fall, 1e-6))


def cycles(frames: int, count: float, phase: float = 0.0) -> Array:
    """Sine of `count` periods over the duration, (F,); phase in periods."""
    return np.sin(2 * np.pi * (np.linspace(0.0, count, frames) + phase))


def blend(low: ArrayLike, high: ArrayLike, weight: Array) -> Array:
    """Linear blend of two values by a weight over time: (F, ...)."""
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    weight = (
        weight.reshape(-1, *([1] * max(low.ndim, high.ndim))) if low.ndim < 2 and high.ndim < 2 else weight[:, None]
    )
    return low * (1 - weight) + high * weight
