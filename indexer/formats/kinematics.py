"""Forward kinematics, all frames at once: a pose is three axes and a position, each (3, T)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Axes = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


class Pose(NamedTuple):
    """A joint's frame in the world: columns of its rotation and its position."""

    axes: Axes
    position: NDArray[np.float64]

    @classmethod
    def identity(cls, frames: int) -> Pose:
        """The world itself."""
        x, y, z = (np.repeat(axis[:, None], frames, axis=1) for axis in np.eye(3))
        return cls((x, y, z), np.zeros((3, frames)))

    def place(self, local: NDArray[np.float64]) -> NDArray[np.float64]:
        """World position (3, T) of a point (3,) or (3, T) given in this frame."""
        x, y, z = self.axes
        placed: NDArray[np.float64] = self.position + x * local[0] + y * local[1] + z * local[2]
        return placed

    def below(self, local: Pose) -> Pose:
        """The pose in the world of one given in this frame, whose axes may be scaled."""
        x, y, z = (self.place(axis) - self.position for axis in local.axes)
        return Pose((x, y, z), self.place(local.position))


def turn(axes: Axes, axis: int, angle: NDArray[np.float64]) -> Axes:
    """Frames turned about one of their own axes (0, 1, 2) by `angle` (T,) radians: R <- R @ R_axis(angle).

    Such a turn only mixes the two other columns, which is why the columns are kept apart.
    """
    cos, sin = np.cos(angle), np.sin(angle)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turned = list(axes)
    turned[first] = axes[first] * cos + axes[second] * sin
    turned[second] = axes[second] * cos - axes[first] * sin
    return turned[0], turned[1], turned[2]


def quaternion_axes(quaternions: NDArray[np.float64]) -> Axes:
    """The axes (3, T) of rotations from unit quaternions (4, T) in the order x, y, z, w."""
    x, y, z, w = quaternions
    return (
        np.array([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)]),
        np.array([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)]),
        np.array([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]),
    )


def turned(axes: Axes, matrix: NDArray[np.float64]) -> Axes:
    """Frames turned by one rotation (3, 3) of their own: R <- R @ matrix."""
    x, y, z = (matrix.T @ np.reshape(axes, (3, -1))).reshape(3, 3, -1)
    return x, y, z


def from_rest(axes: Sequence[Axes], rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations (T, J, 3, 3) of joints from the rest pose, without what scales and shears them.

    Parameters
    ----------
    axes : sequence of three float arrays (3, T)
        Where the axes of each joint point in the world.
    rest : float array (J, 3, 3)
        The same in the rest pose, as columns.
    """
    now = np.stack([np.stack(joint, axis=-1).transpose(1, 0, 2) for joint in axes], axis=1)
    both = [x / np.maximum(np.linalg.norm(x, axis=-2, keepdims=True), 1e-12) for x in (now, rest)]
    left, _, right = np.linalg.svd(both[0] @ np.swapaxes(both[1], -1, -2))  # the nearest rotations
    left[..., 2] *= np.sign(np.linalg.det(left @ right))[..., None]
    rotations: NDArray[np.float64] = left @ right
    return rotations


def tips(parents: NDArray[np.int64], rest: NDArray[np.float64]) -> list[tuple[int, NDArray[np.float64]]]:
    """Bones that go on straight from the leaves of a skeleton, as long as the bones that lead there.

    A leaf that turns but has no end site, as elbow or knee where hands and feet are left out, still says where the
    bone goes that follows.

    Parameters
    ----------
    parents : int array (J,)
        Parent of each joint, -1 for a root; parents before children.
    rest : float array (J, 3)
        Joint positions of the rest pose.

    Returns
    -------
    list of (leaf, step (3,))
        Joint numbers, and the way from there to the new tip in the rest pose; none where no bone leads to a leaf.
    """
    steps = np.where(parents[:, None] < 0, 0.0, rest - rest[parents])
    for joint, parent in enumerate(parents):
        if parent >= 0 and not steps[joint].any():
            steps[joint] = steps[parent]
    leaves = sorted(set(range(len(parents))) - set(parents.tolist()))
    return [(leaf, steps[leaf]) for leaf in leaves if steps[leaf].any()]
