"""Any rig -> Motion: find the body in the take, stand it up, scale it, rebuild it on the 22 joints at 20 fps."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.motion import FPS, Motion
from encoders.skeleton import BONE_LENGTHS, INDEX
from indexer.axes import upright
from indexer.body import build
from indexer.calibration import calibrate
from indexer.figure import SIDES, Figure, angle_between
from indexer.mapping import map_rig
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
    figure, rest = Figure.of(take.positions, rig), Figure.of(take.rest[None], rig)
    if begins_with_pose(figure, rest):
        figure, rest = figure[1:], figure[:1]
    figure = figure.sampled(_grid(len(figure), rate))
    length = figure.leg_length()
    if not length > 0:
        raise UnreadableMotion(path, "the legs have no length")
    figure = figure.transformed(upright(figure))
    joints = build(figure, LEG_LENGTH / length, calibrate(figure, rest))
    joints[..., 1] -= joints[..., 1].min()
    return Motion(joints.astype(np.float32), FPS)


def _grid(frames: int, rate: float) -> NDArray[np.float64]:
    """Times of the 20 fps grid, counted in frames of the file."""
    count = int(np.floor((frames - 1) * FPS / rate + 1e-6)) + 1
    return np.arange(count) * (rate / FPS)


def begins_with_pose(figure: Figure, rest: Figure) -> bool:
    """Does the first frame show a rest pose or T-pose, which is no movement, while the second does not?"""
    if len(figure) < 3:
        return False
    start = figure[:3].points() - figure[:3].middle("hip")[:, None]
    size = figure.leg_length()
    to_rest = np.linalg.norm(start - (rest.points() - rest.middle("hip")[:, None]), axis=-1).mean(axis=-1) / size
    step = np.linalg.norm(np.diff(start, axis=0), axis=-1).mean(axis=-1) / size
    jumps = bool(step[0] > 0.05 and step[0] > 4 * step[1])
    return jumps and (bool(to_rest[0] < 0.03) or is_t_pose(figure[:1]))


def is_t_pose(figure: Figure) -> bool:
    """A body (T = 1) that stands straight, arms stretched out sideways."""
    trunk = figure.marks["neck"] - figure.middle("hip")
    bones = [(figure.bone(f"{s}_hip", f"{s}_ankle"), -trunk) for s in SIDES]
    bones += [
        (figure.bone(f"{s}_{a}", f"{s}_{b}"), sign * figure.across("hip"))
        for s, sign in zip(SIDES, (1, -1), strict=True)
        for a, b in (("shoulder", "elbow"), ("elbow", "wrist"))
    ]
    return all(float(angle_between(bone, expected)[0]) < 25 for bone, expected in bones)
