"""A body that stands, to be moved by hand."""

from __future__ import annotations

import numpy as np

from encoders.skeleton import BONE_LENGTHS, INDEX, PARENTS, RAW_OFFSETS


def standing(frames: int) -> np.ndarray:
    """Joints (frames, 22, 3) of a body that stands still above the origin, faces +Z, its toes on the floor."""
    joints = np.zeros((22, 3))
    for joint, parent in enumerate(PARENTS[1:], start=1):
        joints[joint] = joints[parent] + RAW_OFFSETS[joint] * BONE_LENGTHS[joint]
    toes = [INDEX["left_foot"], INDEX["right_foot"]]
    joints[:, 1] -= joints[toes, 1].min()
    joints[toes, 1] = 0
    return np.repeat(joints[None], frames, axis=0)
