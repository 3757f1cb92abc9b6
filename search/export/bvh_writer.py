"""Writing BVH: cuts of a file in its own rig, and motions on the 22 joints."""

from __future__ import annotations

import re
from itertools import chain, islice
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from encoders.errors import QueryError, UnknownRig, UnreadableMotion
from encoders.geometry import rotation_between
from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, JOINTS, PARENTS
from indexer.formats import bvh as reader
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import map_rig
from indexer.rigs.retarget import frames_before_movement

Array = NDArray[np.float64]

_FRAMES = re.compile(rb"(?P<name>^\s*Frames\s*:?\s*)(?P<value>\d+)", re.IGNORECASE | re.MULTILINE)
_TIME = re.compile(rb"(?P<name>^\s*Frame\s+Time\s*:?\s*)(?P<value>[\d.eE+-]+)", re.IGNORECASE | re.MULTILINE)
_HEADER_LINES = 50_000
#: Frames searched for a calibration pose before the movement.
_OPENING = 1000
_CENTIMETRES = 100.0

#: Bones of the written rig in its rest pose, a T-pose: directions that differ from straight up.
_DIRECTIONS = {
    "left_hip": (1, 0, 0), "right_hip": (-1, 0, 0), "left_foot": (0, 0, 1), "right_foot": (0, 0, 1),
    "left_collar": (1, 0, 0), "right_collar": (-1, 0, 0), "left_shoulder": (1, 0, 0), "right_shoulder": (-1, 0, 0),
    "left_elbow": (1, 0, 0), "right_elbow": (-1, 0, 0), "left_wrist": (1, 0, 0), "right_wrist": (-1, 0, 0),
    "left_knee": (0, -1, 0), "right_knee": (0, -1, 0), "left_ankle": (0, -1, 0), "right_ankle": (0, -1, 0),
}  # fmt: skip
_TIP = 0.1  # metres: length of the last bones

_OFFSETS: Array = np.array([_DIRECTIONS.get(name, (0, 1, 0)) for name in JOINTS]) * BONE_LENGTHS[:, None].astype(float)
_CHILDREN = [np.flatnonzero(joint == PARENTS) for joint in range(len(JOINTS))]


def cut(path: Path, out: IO[bytes], start: float, end: float, *, duration: float) -> tuple[int, float]:
    """Copy a BVH file's hierarchy and the lines of its frames from `start` to `end`, in seconds of its motion.

    Parameters
    ----------
    duration : float
        Seconds of the whole motion as the library has it: tells the true frame rate where the file states a wrong one.

    Returns
    -------
    frames : int
    fps : float

    Raises
    ------
    UnreadableMotion
        If the file cannot be read.
    QueryError
        If its frames are not one a line.
    """
    with path.open("rb") as file:
        header, frames, fps = _header(path, file)
        lines = (line for line in file if line.strip())
        opening = list(islice(lines, _OPENING))
        skipped = _skipped(path, header, opening, fps)
        if abs((frames - skipped) / fps - duration) > max(0.2, 2 / fps):
            fps = (frames - skipped) / duration
        first = skipped + round(start * fps)
        count = min(max(round((end - start) * fps), 1), frames - first)
        kept = [line.rstrip(b"\r\n") for line in islice(chain(opening, lines), first, first + count)]
    if len(kept) != count or len({len(line.split()) for line in kept}) != 1:
        raise QueryError(f"{path}: its frames are not one a line, so no lines can be cut out; write .npz instead")
    out.write(_with_frames(header, count, fps) + b"\n".join(kept) + b"\n")
    return count, fps


def _header(path: Path, file: IO[bytes]) -> tuple[bytes, int, float]:
    """Everything up to the frames, the frames it announces and the frames a second."""
    header = b""
    for line in islice(file, _HEADER_LINES):
        header += line
        time = _TIME.match(line)
        if time:
            frames = _FRAMES.search(header)
            if frames is None or not 0 < float(time["value"]) < 10:
                break
            return header, int(frames["value"]), 1 / float(time["value"])
    raise UnreadableMotion(path, "the MOTION section states no frames and frame time, so no lines can be cut out")


def _with_frames(header: bytes, count: int, fps: float) -> bytes:
    header = _FRAMES.sub(lambda found: found["name"] + b"%d" % count, header)
    return _TIME.sub(lambda found: found["name"] + b"%.8g" % (1 / fps), header)


def _skipped(path: Path, header: bytes, opening: list[bytes], fps: float) -> int:
    """Frames before the motion begins, where the file opens with a pose that is none; reading leaves them out."""
    (take,) = reader.read(path, _with_frames(header, len(opening), fps) + b"".join(opening))
    try:
        rig = map_rig(take, path)
    except UnknownRig:
        return 0
    return frames_before_movement(Landmarks.of(take.positions, rig), Landmarks.of(take.rest[None], rig), fps)


def write(out: IO[bytes], motion: Motion) -> None:
    """Write a motion on the 22-joint rig, in centimetres, every joint with a position so that no bone is forced.

    Each joint is turned so that the bones below it fit best: one bone by the smallest turn, several by Kabsch's method.
    """
    joints = motion.joints.astype(np.float64)
    turns = _global_turns(joints)
    parents = PARENTS[1:]
    local_turns, places = turns.copy(), joints.copy()
    local_turns[:, 1:] = np.swapaxes(turns[:, parents], -1, -2) @ turns[:, 1:]
    places[:, 1:] = np.einsum("tjab,tja->tjb", turns[:, parents], joints[:, 1:] - joints[:, parents])
    values = np.concatenate([places * _CENTIMETRES, np.degrees(_angles(local_turns))], axis=-1)
    values = values[:, _WRITTEN].reshape(len(joints), -1)
    out.write("\n".join(["HIERARCHY", *_node(0, 0), "MOTION", ""]).encode())
    out.write(f"Frames: {len(joints)}\nFrame Time: {1 / motion.fps:.8g}\n".encode())
    np.savetxt(out, values, fmt="%.6f")


def _global_turns(joints: Array) -> Array:
    """Rotations (T, 22, 3, 3) that take each joint's bones from the rest pose to where they are."""
    turns = np.empty((*joints.shape, 3))
    for joint, children in enumerate(_CHILDREN):
        parent = PARENTS[joint]
        above = np.broadcast_to(np.eye(3), (len(joints), 3, 3)) if parent < 0 else turns[:, parent]
        bones = joints[:, children] - joints[:, [joint]]
        if len(children) == 0:
            turns[:, joint] = above
        elif len(children) == 1:
            turns[:, joint] = rotation_between(above @ _OFFSETS[children[0]], bones[:, 0]) @ above
        else:
            turns[:, joint] = _kabsch(_OFFSETS[children], bones)
    return turns


def _kabsch(rest: Array, bones: Array) -> Array:
    """The rotations (T, 3, 3) that bring bones (C, 3) of the rest pose nearest to bones (T, C, 3)."""
    u, _, vt = np.linalg.svd(np.einsum("tca,cb->tab", bones, rest))
    u[..., 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    turned: Array = u @ vt
    return turned


def _angles(turns: Array) -> Array:
    """Angles about Z, X and Y (..., 3) of rotations Rz Rx Ry (..., 3, 3)."""
    z = np.arctan2(-turns[..., 0, 1], turns[..., 1, 1])
    x = np.arcsin(np.clip(turns[..., 2, 1], -1, 1))
    y = np.arctan2(-turns[..., 2, 0], turns[..., 2, 2])
    return np.stack([z, x, y], axis=-1)


def _node(joint: int, depth: int) -> list[str]:
    """The lines of a joint and those below it."""
    tab, inner = "  " * depth, "  " * (depth + 1)
    offset = _OFFSETS[joint] * _CENTIMETRES if depth else np.zeros(3)
    lines = [
        f"{tab}{'JOINT' if depth else 'ROOT'} {JOINTS[joint]}",
        f"{tab}{{",
        f"{inner}OFFSET {offset[0]:.6f} {offset[1]:.6f} {offset[2]:.6f}",
        f"{inner}CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
    ]
    if len(_CHILDREN[joint]) == 0:
        tip = np.array(_DIRECTIONS.get(JOINTS[joint], (0, 1, 0))) * _TIP * _CENTIMETRES
        place = f"{inner}  OFFSET {tip[0]:.6f} {tip[1]:.6f} {tip[2]:.6f}"
        lines += [f"{inner}End Site", f"{inner}{{", place, f"{inner}}}"]
    for child in _CHILDREN[joint]:
        lines += _node(int(child), depth + 1)
    return [*lines, f"{tab}}}"]


def _written(joint: int) -> list[int]:
    return [joint, *(below for child in _CHILDREN[joint] for below in _written(int(child)))]


#: The joints in the order the hierarchy is written.
_WRITTEN = _written(0)
