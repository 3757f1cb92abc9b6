"""A motion as rotations: where the root is, how each joint is turned on its parent, and the bones in between.

Rotations blend as bodies move, and a part that is taken over brings what hangs on it along; positions do neither.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import apply, interpolate
from encoders.motion import Motion
from encoders.skeleton import JOINTS, LEVELS, PARENTS
from search.export.posed_rig import joint_rotations
from search.export.quaternions import between, slerp, to_matrices, to_quaternions

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rotated:
    """A motion of T frames.

    Attributes
    ----------
    root : array (T, 3)
        Places of the pelvis in metres, Y up.
    turns : array (T, 22, 4)
        Unit quaternions (x, y, z, w) of each joint on its parent, of the pelvis in the world.
    bones : array (T, 22, 3)
        The bone that ends at each joint, in the frame of its parent.
    """

    root: Array
    turns: Array
    bones: Array

    def __len__(self) -> int:
        return len(self.root)

    @classmethod
    def of(cls, motion: Motion) -> Rotated:
        """The same motion; `joints` gives it back."""
        joints = motion.joints.astype(np.float64)
        world = joint_rotations(joints)
        above = np.concatenate([np.broadcast_to(np.eye(3), (len(joints), 1, 3, 3)), world[:, PARENTS[1:]]], axis=1)
        back = above.swapaxes(-1, -2)
        ways = joints - np.concatenate([joints[:, :1], joints[:, PARENTS[1:]]], axis=1)
        return cls(joints[:, 0], to_quaternions(back @ world), apply(back, ways))

    def joints(self) -> Array:
        """Positions (T, 22, 3) in metres."""
        local = to_matrices(self.turns)
        world = np.empty_like(local)
        places = np.empty((len(self), len(JOINTS), 3))
        world[:, 0], places[:, 0] = local[:, 0], self.root
        for level in LEVELS:
            above = world[:, PARENTS[level]]
            world[:, level] = above @ local[:, level]
            places[:, level] = places[:, PARENTS[level]] + apply(above, self.bones[:, level])
        return places

    def at(self, frames: Array) -> Rotated:
        """The motion at places (N,), counted in frames; before its first and after its last it stands still."""
        places = np.clip(frames, 0, len(self) - 1)
        if not (places % 1).any():
            return self[places.astype(np.int64)]
        return Rotated(interpolate(self.root, places), slerp(self.turns, places), interpolate(self.bones, places))

    def moved(self, yaw: float, shift: Array) -> Rotated:
        """Turned about the vertical by an angle, then shifted (3,)."""
        half = np.array([0.0, np.sin(yaw / 2), 0.0, np.cos(yaw / 2)])
        turns = self.turns.copy()
        turns[:, 0] = multiplied(np.broadcast_to(half, turns[:, 0].shape), turns[:, 0])
        return Rotated(about_vertical(self.root, yaw) + shift, turns, self.bones)

    def blended(self, other: Rotated, share: Array) -> Rotated:
        """A share (T,) of the way to another motion of as many frames."""
        at = share[:, None]
        return Rotated(
            self.root + at * (other.root - self.root),
            between(self.turns, other.turns, at),
            self.bones + at[..., None] * (other.bones - self.bones),
        )

    def with_joints_of(self, other: Rotated, joints: list[int], share: Array) -> Rotated:
        """With a share (T,) of the way to another motion, for some joints on their parents only."""
        turns, bones = self.turns.copy(), self.bones.copy()
        turns[:, joints] = between(self.turns[:, joints], other.turns[:, joints], share[:, None])
        bones[:, joints] += share[:, None, None] * (other.bones[:, joints] - self.bones[:, joints])
        return Rotated(self.root, turns, bones)

    def __getitem__(self, frames: slice | NDArray[np.int64]) -> Rotated:
        return Rotated(self.root[frames], self.turns[frames], self.bones[frames])


def about_vertical(points: Array, yaw: float) -> Array:
    """Points (..., 3) turned about the vertical through the origin, from +Z towards +X."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turned: Array = points @ np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
    return turned


def concatenated(pieces: list[Rotated]) -> Rotated:
    """Motions one after the other."""
    return Rotated(*(np.concatenate([getattr(p, name) for p in pieces]) for name in ("root", "turns", "bones")))


def multiplied(a: Array, b: Array) -> Array:
    """Products (..., 4) of quaternions: the turn `b`, then the turn `a`."""
    ax, ay, az, aw = np.moveaxis(a, -1, 0)
    bx, by, bz, bw = np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
        axis=-1,
    )
