"""Clips one after the other: root position and heading aligned, the seams blended."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.skeleton import INDEX

_BLEND = 6  # frames of a seam
_ACROSS = [INDEX[name] for name in ("right_hip", "left_hip", "right_shoulder", "left_shoulder")]


def concatenate_clips(clips: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Joints (T, 22, 3) of clips one after the other: each starts where, and facing as, the previous one ended.

    As in TEACH (Athanasiou et al., 3DV 2022): position and heading are aligned, then a few frames blended.
    """
    whole = [np.asarray(clips[0], np.float32)]
    for clip in clips[1:]:
        last = whole[-1][-1]
        moved = _face(np.asarray(clip, np.float32), _heading(last))
        moved = moved + np.array([last[0, 0] - moved[0, 0, 0], 0, last[0, 2] - moved[0, 0, 2]], np.float32)
        frames = min(_BLEND, len(moved))
        weight = np.linspace(1, 0, frames + 2, dtype=np.float32)[1:-1, None, None]
        moved[:frames] += weight * (last - moved[0])
        whole.append(moved)
    return np.concatenate(whole)


def _heading(pose: NDArray[np.float32]) -> float:
    """Angle about Y of the direction that a pose (22, 3) faces, radians."""
    right_hip, left_hip, right_shoulder, left_shoulder = pose[_ACROSS]
    across = (left_hip - right_hip) + (left_shoulder - right_shoulder)
    return float(np.arctan2(-across[2], across[0]))


def _face(joints: NDArray[np.float32], heading: float) -> NDArray[np.float32]:
    """The clip rotated about Y so that its first frame has this heading."""
    turn = heading - _heading(joints[0])
    c, s = np.cos(turn), np.sin(turn)
    return joints @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]], np.float32)
