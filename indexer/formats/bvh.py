"""BVH: a tree of joints with offsets and channels, then one line of channel values a frame."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import partial
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.kinematics import Axes, Pose, tips, turn
from indexer.formats.numbers import parse_numbers
from indexer.take import Take

MAX_JOINTS = 4096
MAX_CHANNELS = 12
_BLOCK = 4096  # frames whose poses fit the processor's cache, and bound the memory they need

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_TOKEN = re.compile(
    rf"""[\s,;]*(?:
      (?P<close>\}})
    | (?P<open>\{{)
    | offset [\s,:]+ (?P<offset>{_NUMBER}(?:[\s,]+{_NUMBER}){{2}})
    | channels [\s,:]* (?P<count>\d+) (?P<channels>(?:[\s,]+[xyz](?:position|rotation|translation|pos|rot))*)
    | end [ \t_]* site (?P<site>[^\r\n{{]*)
    | (?:root|joint) \b [ \t,]* (?P<joint>[^\r\n{{]*)
    )""",
    re.IGNORECASE | re.VERBOSE,
)
_SEPARATOR = re.compile(r"[\s,]+")
_FRAMES = re.compile(r"[\s,]*frames[ \t]*:?[\s,]*(?P<count>[-+]?\d+)", re.IGNORECASE)
_FRAME_TIME = re.compile(
    rf"[\s,]*frame[ \t_]*time[ \t]*:?[\s,]*(?P<time>{_NUMBER}|[-+]?nan|[-+]?inf\w*)", re.IGNORECASE
)
_MOTION = re.compile(rb"^[ \t]*motion[ \t,]*\r?$|\}[\s,]*motion\b", re.IGNORECASE | re.MULTILINE)


@dataclass
class _Joint:
    name: str
    parent: int
    is_site: bool = False
    offset: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    channels: list[tuple[str, str]] = field(default_factory=list)  # ("p" or "r", axis), in the order written


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read a BVH file; end sites become joints named after their parent with `_end`.

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
        Where the text is no complete BVH; the reason says what and where.
    """
    split = _MOTION.search(data)
    if split is None:
        raise UnreadableMotion(path, "the BVH has no MOTION section: the file may be cut short")
    joints = _with_tips(_hierarchy(path, data[: split.start() + (data[split.start() : split.start() + 1] == b"}")]))
    count, frame_time, numbers = _motion_header(path, data, split.end())
    if fps is None:
        if not (np.isfinite(frame_time) and 1e-5 < frame_time <= 10):
            raise UnreadableMotion(path, f"Frame Time {frame_time:g} is no frame rate; give the true one with fps")
        fps = _rate(frame_time)
    frames = _frames(path, data, numbers, sum(len(joint.channels) for joint in joints), count)
    return [_take(joints, frames, fps)]


def _hierarchy(path: str | PathLike[str], header: bytes) -> list[_Joint]:
    text = _decode(header)
    start = re.match(r"\ufeff?\s*hierarchy\b", text, re.IGNORECASE)
    if start is None:
        raise UnreadableMotion(path, "the file does not begin with HIERARCHY")
    joints: list[_Joint] = []
    stack: list[int] = []
    waiting: int | None = None
    at = start.end()
    end = len(text.rstrip(" \t\r\n,;"))
    while at < end:
        token = _TOKEN.match(text, at)
        if token is None:
            raise UnreadableMotion(path, f"the hierarchy cannot be read at {_place(text, at)}")
        at = token.end()
        if token["joint"] is not None or token["site"] is not None:
            if waiting is not None:
                raise UnreadableMotion(path, f"an opening brace is missing before {_place(text, token.start())}")
            parent = stack[-1] if stack else -1
            is_site = token["joint"] is None
            if is_site and parent < 0:
                raise UnreadableMotion(path, "an End Site stands outside any joint")
            name = f"{joints[parent].name}_end" if is_site else token["joint"].strip(" \t\r,:\"'")
            waiting = len(joints)
            joints.append(_Joint(name or f"joint{waiting}", parent, is_site))
            if len(joints) > MAX_JOINTS:
                raise UnreadableMotion(path, f"more than {MAX_JOINTS} joints: this is no skeleton of a person")
        elif token["open"]:
            if waiting is None:
                raise UnreadableMotion(path, f"an opening brace without a joint at {_place(text, token.start())}")
            stack.append(waiting)
            waiting = None
        elif not stack:
            raise UnreadableMotion(path, f"the hierarchy is out of order at {_place(text, token.start())}")
        elif token["close"]:
            stack.pop()
        elif token["offset"] is not None:
            joints[stack[-1]].offset = np.array([float(v) for v in _SEPARATOR.split(token["offset"])])
        else:
            channels = _channel_names(token["channels"])
            if len(channels) != int(token["count"]) or len(channels) > MAX_CHANNELS:
                raise UnreadableMotion(path, f"CHANNELS {token['count']} names {len(channels)} channels")
            joints[stack[-1]].channels = channels
    if stack or waiting is not None:
        raise UnreadableMotion(path, f"the hierarchy is not closed: {len(stack)} closing braces are missing")
    if not joints:
        raise UnreadableMotion(path, "the hierarchy holds no joints")
    return joints


def _with_tips(joints: list[_Joint]) -> list[_Joint]:
    """The joints, and an end site for each last one that turns but has none."""
    parents = np.array([joint.parent for joint in joints])
    rest = np.zeros((len(joints), 3))
    for i, joint in enumerate(joints):
        rest[i] = joint.offset + (rest[joint.parent] if joint.parent >= 0 else 0)
    added = [
        _Joint(f"{joints[leaf].name}_end", leaf, True, step)
        for leaf, step in tips(parents, rest)
        if joints[leaf].channels
    ]
    return joints + added


def _channel_names(text: str) -> list[tuple[str, str]]:
    """Kind ("p" or "r") and axis of each channel."""
    words = [word.lower() for word in _SEPARATOR.split(text) if word]
    return [("r" if word[1:].startswith("r") else "p", word[0]) for word in words]


def _place(text: str, at: int) -> str:
    rest = text[at:].lstrip()
    line = text.count("\n", 0, len(text) - len(rest)) + 1
    return f"line {line}: {rest.splitlines()[0][:60]!r}" if rest else f"line {line}"


def _decode(header: bytes) -> str:
    try:
        return header.decode("utf-8")
    except UnicodeDecodeError:
        return header.decode("latin-1")


def _motion_header(path: str | PathLike[str], data: bytes, at: int) -> tuple[int | None, float, int]:
    """Declared frame count (None if missing), frame time, and where the numbers begin."""
    text = data[at : at + 1000].decode("latin-1")
    frames = _FRAMES.match(text)
    time = _FRAME_TIME.match(text, frames.end() if frames else 0)
    if time is None:
        raise UnreadableMotion(path, "the MOTION section names no Frame Time")
    count = int(frames["count"]) if frames else None
    return count, float(time["time"]), at + time.end()


def _rate(frame_time: float) -> float:
    """Frames a second; a whole number where the few digits that frame times are written with allow it."""
    fps = 1 / frame_time
    return float(round(fps)) if abs(round(fps) - fps) < 3e-4 * fps else fps


def _frames(
    path: str | PathLike[str], data: bytes, at: int, channels: int, declared: int | None
) -> NDArray[np.float64]:
    """The channel values, (T, channels)."""
    if channels == 0:
        raise UnreadableMotion(path, "no joint has channels, so nothing moves")
    try:
        values = parse_numbers(data[at:])
    except ValueError as error:
        raise UnreadableMotion(path, f"the motion is not all numbers: {error}") from None
    count, left = divmod(len(values), channels)
    if left:
        raise UnreadableMotion(
            path, f"frame {count + 1} is cut short: {left} of {channels} numbers; the file may be damaged"
        )
    if count == 0:
        raise UnreadableMotion(path, "the file holds no frames")
    if declared is not None and declared > count:
        raise UnreadableMotion(path, f"it announces {declared} frames but holds {count}: the file is cut short")
    if not np.isfinite(values).all():
        frame = int(np.flatnonzero(~np.isfinite(values))[0] // channels) + 1
        raise UnreadableMotion(path, f"frame {frame} holds values that are no numbers")
    return values.reshape(count, channels)


def _take(joints: list[_Joint], frames: NDArray[np.float64], fps: float) -> Take:
    """Rest pose and, by forward kinematics, the pose of each frame."""
    rest = np.zeros((len(joints), 3))
    firsts = np.cumsum([0, *(len(joint.channels) for joint in joints)])
    columns = np.ascontiguousarray(frames.T)
    bases = []
    for i, joint in enumerate(joints):
        rest[i] = joint.offset + (rest[joint.parent] if joint.parent >= 0 else 0)
        bases.append(_base(joint, columns[firsts[i] : firsts[i + 1]]))
    positions = np.empty((len(joints), 3, len(frames)))
    for start in range(0, len(frames), _BLOCK):
        block = slice(start, start + _BLOCK)
        poses: list[Pose] = []
        for i, joint in enumerate(joints):
            parent = poses[joint.parent] if joint.parent >= 0 else Pose.identity(positions[i, 0, block].size)
            poses.append(_pose(parent, joint, bases[i], columns[firsts[i] : firsts[i + 1], block]))
            positions[i, :, block] = poses[i].position
    parents = np.array([joint.parent for joint in joints])
    names = tuple(joint.name for joint in joints)
    rotations = partial(_rotations, joints, columns)
    return Take(names, parents, rest, positions.transpose(2, 0, 1), fps, rotations=rotations)


def _rotations(joints: list[_Joint], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations of the joints in the world (T, J, 3, 3)."""
    rotations = np.empty((columns.shape[1], len(joints), 3, 3))
    done: list[Axes] = []
    first = 0
    for i, joint in enumerate(joints):
        axes = done[joint.parent] if joint.parent >= 0 else Pose.identity(columns.shape[1]).axes
        for kind, axis in joint.channels:
            if kind == "r":
                axes = turn(axes, "xyz".index(axis), np.deg2rad(columns[first]))
            first += 1
        done.append(axes)
        rotations[:, i] = np.stack(axes, axis=-1).transpose(1, 0, 2)
    return rotations


def _base(joint: _Joint, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """What position channels are added to, (3,): 0 where they hold the whole translation, as they should.

    Some programs write only what is added to the offset; on a joint with a parent the channels then stay nearer to
    zero than to the offset.
    """
    base: NDArray[np.float64] = joint.offset.copy()
    moves = [(k, "xyz".index(axis)) for k, (kind, axis) in enumerate(joint.channels) if kind == "p"]
    if moves:
        rows, axes = (list(x) for x in zip(*moves, strict=True))
        middle = np.median(values[rows], axis=1)
        if joint.parent < 0 or np.linalg.norm(middle) >= np.linalg.norm(middle - base[axes]):
            base[axes] = 0
    return base


def _pose(parent: Pose, joint: _Joint, base: NDArray[np.float64], values: NDArray[np.float64]) -> Pose:
    """A joint's pose in the world: each channel (T,) turns or moves it in the order it is written."""
    place = np.repeat(base[:, None], values.shape[1], axis=1)
    axes = parent.axes
    for (kind, axis), value in zip(joint.channels, values, strict=True):
        if kind == "p":
            place["xyz".index(axis)] += value
        else:
            axes = turn(axes, "xyz".index(axis), np.deg2rad(value))
    return Pose(axes, parent.place(place))
