"""The pose in which a skeleton was bound to its mesh: it shows a rig's build better than the pose it was saved in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_SAME, _ALIKE = 1e-3, 0.02  # shares by which transforms and lengths of bones may differ

Array = NDArray[np.float64]


def bind_pose(now: Array, inverse: Array, parents: Sequence[int], places: Sequence[Array]) -> Array:
    """World matrices (J, 4, 4) of joints in the bind pose.

    A skin holds where its joints were relative to the mesh or to a world that may since have been turned and scaled.
    Where that is now is taken from the first of `places`, or else from the uppermost joint, that keeps the lengths of
    bones. `now` where none does, or where the joints stand in the bind pose as they are.

    Parameters
    ----------
    now : float array (J, 4, 4)
        World matrices of the joints as they were saved.
    inverse : float array (J, 4, 4)
        Inverse matrices of the bind pose.
    parents : sequence of int
        Parent of each joint among them, -1 for none.
    places : sequence of float array (4, 4)
        World matrices in which the bind pose may be meant.
    """
    moved = now @ inverse
    if not np.isfinite(moved).all() or np.abs(moved - moved[:1]).max() <= _SAME * np.abs(moved[0]).max():
        return now
    try:
        bind = np.linalg.inv(inverse)
    except np.linalg.LinAlgError:
        return now
    top = next((joint for joint, parent in enumerate(parents) if parent < 0), 0)
    length = _length(now, parents)
    for place in (*places, moved[top]):
        placed: Array = place @ bind
        if abs(_length(placed, parents) - length) <= _ALIKE * length:
            return placed
    return now


def _length(matrices: Array, parents: Sequence[int]) -> float:
    """How long all bones are together."""
    bones = [matrices[i, :3, 3] - matrices[j, :3, 3] for i, j in enumerate(parents) if j >= 0]
    return float(sum(np.linalg.norm(bone) for bone in bones))
