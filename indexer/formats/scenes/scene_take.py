"""A take of joints that are posed frame by frame as transforms."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence

import numpy as np
from numpy.typing import NDArray

from indexer.formats.kinematics import Pose, from_rest, tips
from indexer.take import Take

#: Frames times joints of all takes of a file, which a few bytes of keys can ask for: a gigabyte.
MAX_PLACES = 40_000_000
MAX_JOINTS = 4096
_BLOCK = 4096  # frames whose poses fit the processor's cache, and bound the memory they need

Array = NDArray[np.float64]


def scene_take(
    names: Sequence[str],
    parents: NDArray[np.int64],
    rest: Array,
    turned: Container[int],
    posed: Callable[[Array], Sequence[Pose]],
    times: Array,
    *,
    fps: float,
    name: str,
    up: str | None,
) -> Take:
    """Sample joints, and a tip straight on from each last one that turns.

    Parameters
    ----------
    names, parents : sequence of str, int array (J,)
        Joints, parents before children.
    rest : float array (J, 4, 4)
        World matrices of the rest pose.
    turned : container of int
        Joints that turn.
    posed : callable
        World poses of the J joints at times (T,).
    times : float array (T,)
        When to sample.
    fps, name, up
        See `Take`.
    """
    ends = [(leaf, step) for leaf, step in tips(parents, rest[:, :3, 3]) if leaf in turned]
    steps = [np.linalg.pinv(rest[leaf, :3, :3]) @ step for leaf, step in ends]
    positions = np.empty((len(names) + len(ends), 3, len(times)))
    for start in range(0, len(times), _BLOCK):
        block = slice(start, start + _BLOCK)
        poses = posed(times[block])
        for joint, pose in enumerate(poses):
            positions[joint, :, block] = pose.position
        for row, ((leaf, _), step) in enumerate(zip(ends, steps, strict=True), start=len(names)):
            positions[row, :, block] = poses[leaf].place(step)
    tip_places = np.array([rest[leaf, :3, 3] + step for leaf, step in ends]).reshape(-1, 3)

    def rotations() -> Array:
        poses = posed(times)
        owners = [*range(len(names)), *(leaf for leaf, _ in ends)]
        return from_rest([pose.axes for pose in poses], rest[:, :3, :3])[:, owners]

    return Take(
        (*names, *(f"{names[leaf]}_end" for leaf, _ in ends)),
        np.concatenate([parents, np.array([leaf for leaf, _ in ends], np.int64)]),
        np.concatenate([rest[:, :3, 3], tip_places]),
        positions.transpose(2, 0, 1),
        fps,
        name=name,
        up=up,
        rotations=rotations,
    )
