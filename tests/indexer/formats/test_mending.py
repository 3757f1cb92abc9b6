"""Damaged frames are filled in, fast movement is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.mending import mended
from indexer.take import Take


def take(positions: NDArray[np.float64]) -> Take:
    joints = positions.shape[1]
    return Take(tuple("abcde")[:joints], np.arange(joints) - 1, positions[0], positions, 30.0)


def moving(frames: int = 60) -> NDArray[np.float64]:
    """A body of five joints, a metre high, that walks on."""
    body = np.linspace([0, 0, 0], [0, 1, 0], 5)
    return body + np.arange(frames)[:, None, None] * [0.05, 0.0, 0.0]


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e8, -1e15, 30.0])
@pytest.mark.parametrize("joints", [[2], [0, 1, 2, 3, 4]])
@pytest.mark.parametrize("frames", [[10], [30, 31, 32], [20, 40]])
def test_absurd_frames_are_interpolated_and_counted(value: float, joints: list[int], frames: list[int]) -> None:
    positions = moving()
    positions[np.ix_(frames, joints, [2])] += value
    found = mended("a.npy", take(positions))
    np.testing.assert_allclose(found.positions, moving(), atol=1e-9)
    assert f"{len(frames)} frame" in found.warnings[0]
    assert f"at frame {frames[0] + 1}" in found.warnings[0]


@pytest.mark.parametrize("at", [0, -1])
def test_absurd_first_and_last_frames_hold_the_nearest_pose(at: int) -> None:
    positions = moving()
    positions[at] += 1e8
    assert mended("a.npy", take(positions)).positions[at, 0, 0] == moving()[1 if at == 0 else -2, 0, 0]


def test_fast_movement_cuts_and_starts_elsewhere_are_left_alone() -> None:
    fast = moving()
    fast[30, 4] += 3  # a hand of three body lengths
    cut = moving()
    cut[30:] += 1000.0  # another place from here on
    start = moving()
    start[0] += 100.0  # a rest pose elsewhere
    for positions in (fast, cut, start, moving(1), moving(3)):
        same = take(positions)
        assert mended("a.npy", same) is same


def test_too_many_damaged_frames_are_refused() -> None:
    positions = moving()
    positions[5:15] = np.nan
    with pytest.raises(UnreadableMotion, match=r"10 of 60 frames .* frame 6"):
        mended("a.npy", take(positions))
