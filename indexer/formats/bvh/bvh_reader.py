"""BVH: a tree of joints with offsets and channels, then one line of channel values a frame."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.bvh.bvh_frames import read_frames
from indexer.formats.bvh.bvh_hierarchy import Joint, read_hierarchy, rest_positions
from indexer.formats.kinematics import Pose, turn
from indexer.take import Take

_MOTION = re.compile(rb"^[ \t]*motion[ \t,]*\r?$|\}[\s,]*motion\b", re.IGNORECASE | re.MULTILINE)

#: Joints for each channel, and in all, that a file may ask positions of: a few lines must not become gigabytes.
_JOINTS_PER_CHANNEL, _FREE = 8, 4_000_000

_BLOCK = 1024  # frames whose poses fit the processor's cache, and bound the memory they need

#: Frame times between which a rate may lie; 1 second is what programs write that know none.
_FRAME_TIMES = 1e-5, 0.5


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read a BVH file; end sites become joints named after their parent with `_end`.

    Damaged frames are NaN, which `indexer.formats.mending` sees to.

    Parameters
    ----------
    path : path
        Named in errors.
    data : bytes
        The file.
    fps : float, optional
        Frames a second, instead of what the file says.

    Raises
    ------
    UnreadableMotion
        Where the text is no BVH or holds no whole frame; the reason says what and where.
    """
    split = _MOTION.search(data)
    if split is None:
        raise UnreadableMotion(path, "the BVH has no MOTION section: the file may be cut short")
    joints = read_hierarchy(path, data[: split.start() + (data[split.start() : split.start() + 1] == b"}")])
    channels = sum(len(joint.channels) for joint in joints)
    frames = read_frames(path, data, split.end(), channels)
    if fps is None:
        shortest, longest = _FRAME_TIMES
        if not shortest < frames.frame_time <= longest and len(frames.values) > 1:
            raise UnreadableMotion(
                path, f"Frame Time {frames.frame_time:g} is no frame rate of a recording; give the true one with fps"
            )
        fps = _rate(frames.frame_time)
    if len(joints) * len(frames.values) > _FREE + _JOINTS_PER_CHANNEL * frames.values.size:
        raise UnreadableMotion(path, f"{len(joints)} joints with {channels} channels are no skeleton of a person")
    return [_take(joints, frames.values, fps, frames.warnings)]


def _rate(frame_time: float) -> float:
    """Frames a second; a whole number where the few digits that frame times are written with allow it."""
    fps = 1 / frame_time
    return float(round(fps)) if abs(round(fps) - fps) < 3e-4 * fps else fps


def _take(joints: list[Joint], frames: NDArray[np.float64], fps: float, warnings: tuple[str, ...]) -> Take:
    """Rest pose and, by forward kinematics, the pose of each frame."""
    columns = np.ascontiguousarray(frames.T)
    positions = np.empty((len(joints), 3, len(frames)))
    for block, poses in _poses(joints, columns):
        for i, pose in enumerate(poses):
            positions[i, :, block] = pose.position
    return Take(
        tuple(joint.name for joint in joints),
        np.array([joint.parent for joint in joints]),
        rest_positions(joints),
        positions.transpose(2, 0, 1),
        fps,
        warnings=warnings,
        rotations=partial(_rotations, joints, columns),
    )


def _rotations(joints: list[Joint], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations of the joints in the world (T, J, 3, 3)."""
    rotations = np.empty((columns.shape[1], len(joints), 3, 3))
    for block, poses in _poses(joints, columns):
        for i, pose in enumerate(poses):
            rotations[block, i] = np.stack(pose.axes, axis=-1).transpose(1, 0, 2)
    return rotations


def _poses(joints: list[Joint], columns: NDArray[np.float64]) -> Iterator[tuple[slice, list[Pose]]]:
    """The poses of all joints, some frames at a time, out of channel values (C, T)."""
    firsts = np.cumsum([0, *(len(joint.channels) for joint in joints)])
    bases = _bases(joints, columns, firsts)
    is_used = (columns != 0).any(axis=1)
    for start in range(0, columns.shape[1], _BLOCK):
        block = columns[:, start : start + _BLOCK]
        world = Pose.identity(block.shape[1])
        poses: list[Pose] = []
        for i, joint in enumerate(joints):
            place = bases[i]
            parent = poses[joint.parent] if joint.parent >= 0 else world
            axes = parent.axes
            for k, (kind, axis) in enumerate(joint.channels, start=firsts[i]):
                if is_used[k] and kind == "r":
                    axes = turn(axes, axis, np.deg2rad(block[k]))
                elif is_used[k]:
                    if place.ndim == 1:
                        place = np.repeat(place[:, None], block.shape[1], axis=1)
                    place[axis] += block[k]
            poses.append(Pose(axes, parent.place(place) if place.any() else parent.position))
        yield slice(start, start + _BLOCK), poses


def _bases(joints: list[Joint], columns: NDArray[np.float64], firsts: NDArray[np.int64]) -> list[NDArray[np.float64]]:
    """What the position channels of each joint are added to, (3,): 0 where they hold the whole translation.

    They should. Some programs write only what is added to the offset; most of their joints' channels then stay nearer
    to zero than to the offsets. A root's are never additions.
    """
    bases = [joint.offset.copy() for joint in joints]
    moves = [[(k, axis) for k, (kind, axis) in enumerate(joint.channels) if kind == "p"] for joint in joints]
    whole = columns[:, ~np.isnan(columns[0])]
    from_zero = from_offset = 0.0
    for joint, moved, first in zip(joints, moves, firsts[:-1], strict=True):
        size = float(np.linalg.norm(joint.offset))
        if moved and joint.parent >= 0 and size:
            middle = np.median(whole[[first + k for k, _ in moved]], axis=1)
            from_zero += min(float(np.linalg.norm(middle)) / size, 1.0)
            from_offset += min(float(np.linalg.norm(middle - joint.offset[[axis for _, axis in moved]])) / size, 1.0)
    for joint, moved, base in zip(joints, moves, bases, strict=True):
        if joint.parent < 0 or from_zero >= from_offset:
            base[[axis for _, axis in moved]] = 0
    return bases
