"""How far a body jumps from one frame to the next, where one action becomes another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from search.plausibility.body_frame import local_pose


def transition_distances(joints: NDArray[np.floating], frames: Sequence[int]) -> NDArray[np.float64]:
    """Mean distance (N,) in cm of the joints between frames t - 1 and t, each pose in the body's own frame.

    STMC (CVPRW 2024): place and heading of the root are taken out. Real motion has such distances, too: STMC
    measures its own at `quarters`. At 20 frames a second; less than real motion's is not better.

    Raises
    ------
    ValueError
        If a frame has none before it or lies outside the motion (T, 22, 3).
    """
    return 100 * _steps(local_pose(np.asarray(joints, np.float64)), frames)


def world_distances(joints: NDArray[np.floating], frames: Sequence[int]) -> NDArray[np.float64]:
    """The same in metres and in the world: the transition distance of TEACH (3DV 2022)."""
    return _steps(np.asarray(joints, np.float64), frames)


def quarters(frames: int) -> list[int]:
    """The frames at 1/4, 1/2 and 3/4 of a motion, where STMC measures real motion; those with one before them."""
    return [place for place in (frames // 4, frames // 2, 3 * frames // 4) if place > 0]


def _steps(positions: NDArray[np.float64], frames: Sequence[int]) -> NDArray[np.float64]:
    places = np.asarray(frames, np.int64)
    if len(places) and not (places.min() > 0 and places.max() < len(positions)):
        raise ValueError(
            f"transitions at frames {list(frames)} must lie inside {len(positions)} frames, after the first"
        )
    return np.asarray(np.linalg.norm(positions[places] - positions[places - 1], axis=-1).mean(axis=-1))
