"""Feet on the ground: sliding while they stand, and bodies below the floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.skeleton import INDEX

Array = NDArray[np.float64]

#: Metres above its lowest place in which a foot stands, metres a second beyond which it slides, frames over which its
#: speed is averaged: GMD's.
CONTACT_HEIGHT, SLIDING, AVERAGED = 0.05, 0.5, 5
#: Metres below the floor that do not count: PhysDiff's.
TOLERANCE = 0.005
#: Metres a second below which a foot rests.
_RESTING = 0.15
_TOES = [INDEX["left_foot"], INDEX["right_foot"]]


def floor_height(joints: Array, fps: float) -> float:
    """The height at which feet rest: the median of the lower foot's over frames in which it hardly moves.

    Readers of motion files put the lowest joint of a take at zero, so a file's own floor is not known. Where no foot
    ever rests it is the lowest height of a foot.
    """
    feet = joints[:, _TOES]
    lower = feet[..., 1].argmin(axis=1)
    heights = feet[..., 1].min(axis=1)
    steps = np.linalg.norm(np.diff(feet, axis=0), axis=-1) * fps
    speed = np.take_along_axis(steps, lower[1:, None], axis=1)[:, 0]
    resting = heights[1:][speed < _RESTING]
    return float(np.median(resting)) if len(resting) else float(heights.min())


def foot_sliding(joints: NDArray[np.floating], fps: float) -> tuple[float, float]:
    """Millimetres a frame that standing feet move along the floor, and percent of frames in which one slides.

    The first is "skate" of PhysDiff (Yuan et al., ICCV 2023): the mean horizontal step, at 20 frames a second, of
    feet that touch the ground in two frames in a row; nan where none does. The second is the foot skating ratio of GMD
    (Karunratanakul et al., ICCV 2023), as its code has it: a toe joint is within 5 cm of the floor in two frames in
    a row, and faster than 0.5 m/s between them and on average over the five steps around. The floor is the feet's
    lowest place, as in HumanML3D. Both count feet that swing low over the floor, so compare with real motion.

    Parameters
    ----------
    joints : array (T, 22, 3)
    fps : float
    """
    positions = np.asarray(joints, np.float64)
    if len(positions) < 2:
        raise ValueError("sliding needs two frames")
    feet = positions[:, _TOES]
    near = feet[..., 1] - feet[..., 1].min() < CONTACT_HEIGHT
    standing = near[1:] & near[:-1]
    speeds = np.linalg.norm(np.diff(feet[..., ::2], axis=0), axis=-1) * fps
    reach = AVERAGED // 2
    padded = np.pad(speeds, ((reach, reach), (0, 0)))
    average = sum(padded[shift : shift + len(speeds)] for shift in range(AVERAGED)) / AVERAGED
    skate = 1000 / 20 * float(speeds[standing].mean()) if standing.any() else float("nan")
    sliding = standing & (speeds > SLIDING) & (average > SLIDING)
    return skate, 100 * float(sliding.any(axis=1).mean())


def penetration(joints: NDArray[np.floating], fps: float) -> float:
    """Millimetres that the lowest joint is below the floor, mean over frames; after PhysDiff (ICCV 2023).

    PhysDiff takes the lowest vertex of a mesh; less than 5 mm do not count.
    """
    positions = np.asarray(joints, np.float64)
    depth = floor_height(positions, fps) - positions[..., 1].min(axis=1)
    return 1000 * float(np.where(depth > TOLERANCE, depth, 0).mean())
