"""The 22 joints every motion is brought to: names, tree, sides and target bone lengths."""

from __future__ import annotations

import numpy as np

JOINTS = (
    "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle",
    "spine3", "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
)  # fmt: skip
INDEX = {name: i for i, name in enumerate(JOINTS)}

#: Parent of each joint, -1 for the root; SMPL order, so a parent always comes first.
PARENTS = np.array([-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19])

#: Joints that are as many bones away from the root, the nearest first; without the root.
LEVELS = tuple(slice(*span) for span in ((1, 4), (4, 7), (7, 10), (10, 15), (15, 18), (18, 20), (20, 22)))

#: Kinematic chains from the root (right leg, left leg, spine) and from spine3 (right arm, left arm).
CHAINS = ((0, 2, 5, 8, 11), (0, 1, 4, 7, 10), (0, 3, 6, 9, 12, 15), (9, 14, 17, 19, 21), (9, 13, 16, 18, 20))

#: ``joints[..., MIRROR, :]`` swaps left and right.
MIRROR = np.array([0, 2, 1, 3, 5, 4, 6, 8, 7, 9, 11, 10, 12, 14, 13, 15, 17, 16, 19, 18, 21, 20])

#: Direction of each bone in the reference pose (arms hanging), as HumanML3D defines it.
RAW_OFFSETS = np.array(
    [
        [0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, -1, 0], [0, 1, 0], [0, -1, 0], [0, -1, 0],
        [0, 1, 0], [0, 0, 1], [0, 0, 1], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, -1, 0], [0, -1, 0],
        [0, -1, 0], [0, -1, 0], [0, -1, 0], [0, -1, 0],
    ],
    dtype=np.float64,
)  # fmt: skip

#: Length in metres of the bone that ends at each joint: HumanML3D's example skeleton, which published weights expect.
BONE_LENGTHS = np.array(
    [
        0.0, 0.10307397, 0.10988337, 0.13156824, 0.3936232, 0.39018822, 0.14319022, 0.43243307, 0.42564335,
        0.05736474, 0.14338182, 0.14941907, 0.21936005, 0.13748677, 0.14338283, 0.10303922, 0.13161404, 0.12298438,
        0.25684, 0.26309174, 0.26601171, 0.2698764,
    ],
    dtype=np.float32,
)  # fmt: skip
