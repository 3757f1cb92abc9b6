"""Any rig -> Motion: find the body in the take, stand it up, scale it, rebuild it on the 22 joints at 20 fps."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.motion import FPS, Motion
from encoders.skeleton import BONE_LENGTHS, INDEX
from indexer.axes import to_y_up
from indexer.body import build
from indexer.mapping import RigMap, map_rig
from indexer.readers.take import Take

#: Upper leg and shank of the target skeleton, metres.
LEG_LENGTH = float(
    sum(BONE_LENGTHS[INDEX[f"{side}_{joint}"]] for side in ("left", "right") for joint in ("knee", "ankle")) / 2
)


def retarget(
    take: Take,
    *,
    path: str | PathLike[str],
    joint_map: dict[str, str] | None = None,
    fps: float | None = None,
) -> Motion:
    """Bring a take to the 22 joints: metres, Y up, 20 fps, target bone lengths, lowest joint at height 0.

    Heading and place are kept.

    Parameters
    ----------
    take : Take
        As read.
    path : path
        Named in errors.
    joint_map : dict, optional
        Target joint to joint name in the file, over what is found by itself.
    fps : float, optional
        The take's true frame rate, instead of what it says.

    Raises
    ------
    UnknownRig
        Where hips, knees, ankles, shoulders, elbows, wrists or the head cannot be found.
    """
    rig = map_rig(take, path, joint_map)
    rate = fps or take.fps or FPS
    first = 1 if _begins_with_rest(take, rig) else 0
    marks, spine = _landmarks(take, rig, _grid(len(take.positions) - first, rate) + first)
    scale = LEG_LENGTH / _leg_length(marks)
    if not np.isfinite(scale):
        raise UnreadableMotion(path, "the legs have no length")
    marks, spine = to_y_up(marks, spine)
    joints = build(marks, spine, scale)
    joints[..., 1] -= joints[..., 1].min()
    return Motion(joints.astype(np.float32), FPS)


def _grid(frames: int, rate: float) -> NDArray[np.float64]:
    """Times of the 20 fps grid, counted in frames of the file."""
    count = int(np.floor((frames - 1) * FPS / rate + 1e-6)) + 1
    return np.arange(count) * (rate / FPS)


def _sample(positions: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
    low = np.minimum(at.astype(np.int64), len(positions) - 1)
    high = np.minimum(low + 1, len(positions) - 1)
    weight = (at - low).reshape(-1, *[1] * (positions.ndim - 1))
    return positions[low] * (1 - weight) + positions[high] * weight


def _landmarks(
    take: Take, rig: RigMap, at: NDArray[np.float64]
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.float64]]:
    """Landmark tracks (T, 3) and points along the back (T, S, 3) at given times; what is missing is placed between."""
    marks = {name: _sample(take.positions[:, j], at) for name, j in rig.joints.items()}
    spine = _sample(take.positions[:, rig.spine], at)
    shoulders = (marks["left_shoulder"] + marks["right_shoulder"]) / 2
    if "neck" not in marks:
        marks["neck"] = shoulders + (marks["head"] - shoulders) * 0.3
    if "head" not in marks:
        marks["head"] = marks["neck"] * 2 - shoulders
    return marks, spine


def _leg_length(marks: dict[str, NDArray[np.float64]]) -> float:
    lengths = [
        np.median(np.linalg.norm(marks[f"{side}_{a}"] - marks[f"{side}_{b}"], axis=-1))
        for side in ("left", "right")
        for a, b in (("hip", "knee"), ("knee", "ankle"))
    ]
    return float(sum(lengths) / 2)


def _begins_with_rest(take: Take, rig: RigMap) -> bool:
    """Does the first frame show the rest pose, which is no movement, while the second does not?"""
    if len(take.positions) < 3:
        return False
    used = list(rig.joints.values())
    figure = take.positions[:3, used] - take.positions[:3, used].mean(axis=1, keepdims=True)
    rest = take.rest[used] - take.rest[used].mean(axis=0)
    size = max(float(np.linalg.norm(rest, axis=-1).mean()), 1e-9)
    to_rest = np.linalg.norm(figure - rest, axis=-1).mean(axis=-1) / size
    step = np.linalg.norm(np.diff(figure, axis=0), axis=-1).mean(axis=-1) / size
    return bool(to_rest[0] < 0.03 and to_rest[1] > 0.08 and step[0] > 4 * step[1])
