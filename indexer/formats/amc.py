"""ASF/AMC: a skeleton file (.asf) and motions (.amc) that belong to it, found beside each other.

Neither states a frame rate: it is 120 by default (`default_fps` in `indexer.formats.table`), or given; see
`indexer.store.read_options` for what takes precedence.
"""

from __future__ import annotations

import re
from itertools import chain
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.asf import Bone, Skeleton, read_skeleton
from indexer.formats.kinematics import Axes, Pose, turn
from indexer.formats.numbers import parse_numbers
from indexer.take import Take

MAX_WORD = 64

_NAMED_SKELETON = re.compile(rb"([^\\/\s:][^\\/\r\n:]*\.asf)\s*$", re.IGNORECASE | re.MULTILINE)


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read an AMC file with the ASF that lies beside it.

    Each joint stands where its bone begins and has the bone's name, as in BVH; the tip of a last bone is the
    bone's name with `_end`.

    Raises
    ------
    UnreadableMotion
        Where there is no skeleton beside the file, or the two do not fit each other.
    """
    body, unit = _split(data)
    words = _words(path, body)
    layout = _layout(path, words)
    skeleton = _skeleton(path, data, [name for name, _ in layout])
    radians = skeleton.radians if unit is None else unit == "radians"
    return [_take(path, skeleton, _channels(path, words, layout), radians, fps)]


def _split(data: bytes) -> tuple[bytes, str | None]:
    """The frames' text and the angle unit the header names, if any."""
    lines = data.removeprefix(b"\xef\xbb\xbf").splitlines(keepends=True)
    unit = None
    for i, line in enumerate(lines):
        word = line.strip().lower()
        if word and not word.startswith((b"#", b":")):
            return b"".join(lines[i:]), unit
        if word in (b":degrees", b":radians"):
            unit = word[1:].decode()
    return b"", unit


def _words(path: str | PathLike[str], body: bytes) -> list[bytes]:
    words = body.split()
    if not words:
        raise UnreadableMotion(path, "the file holds no frames")
    if not words[0].isdigit():
        raise UnreadableMotion(path, f"a frame number is expected where {words[0][:40]!r} stands")
    if len(max(words, key=len)) > MAX_WORD:
        raise UnreadableMotion(path, f"the motion holds a word longer than {MAX_WORD} characters: no AMC")
    return words


def _is_number(word: bytes) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return not word.lower().strip(b"+-").startswith((b"nan", b"inf"))


def _layout(path: str | PathLike[str], words: list[bytes]) -> list[tuple[str, int]]:
    """Bone names and counts of values in the first frame."""
    layout: list[tuple[str, int]] = []
    for i, word in enumerate(words[1:], start=1):
        if not _is_number(word):
            layout.append((word.decode("latin-1"), 0))
        elif not layout:
            raise UnreadableMotion(path, "the first frame names no bone before its numbers")
        elif i + 1 < len(words) and not _is_number(words[i + 1]) and words[i + 1].decode("latin-1") == layout[0][0]:
            break  # this number is the next frame's
        else:
            layout[-1] = (layout[-1][0], layout[-1][1] + 1)
    return layout


def _channels(
    path: str | PathLike[str], words: list[bytes], layout: list[tuple[str, int]]
) -> dict[str, NDArray[np.float64]]:
    """Values (n, T) of each bone."""
    width = 1 + sum(1 + count for _, count in layout)
    frames, left = divmod(len(words), width)
    if left:
        raise UnreadableMotion(path, f"frame {frames + 1} is not laid out as the first one: the file may be cut short")
    places = 1 + np.cumsum([0, *(1 + count for _, count in layout)])
    columns: list[list[bytes]] = []
    for at, (name, count) in zip(places, layout, strict=False):
        wrong = next((frame for frame, word in enumerate(words[at::width]) if word != words[at]), None)
        if wrong is not None:
            raise UnreadableMotion(path, f"frame {wrong + 1} is not laid out as the first one: no {name}")
        columns += [words[at + k :: width] for k in range(1, count + 1)]
    try:
        values = parse_numbers(b" ".join(chain.from_iterable(columns))).reshape(-1, frames)
    except ValueError as error:
        raise UnreadableMotion(path, f"the motion is not all numbers: {error}") from None
    if not np.isfinite(values).all():
        raise UnreadableMotion(path, "the motion holds values that are no numbers")
    ends = np.cumsum([count for _, count in layout])
    return {name: values[end - count : end] for (name, count), end in zip(layout, ends, strict=True)}


def _skeleton(path: str | PathLike[str], data: bytes, bones: list[str]) -> Skeleton:
    """The skeleton beside the motion that has all its bones."""
    candidates = _candidates(Path(path), data)
    if not candidates:
        raise UnreadableMotion(path, "its skeleton is missing: put the .asf file that belongs to it in the same folder")
    lacking: list[str] = []
    for candidate in candidates:
        skeleton = read_skeleton(candidate)
        lacking = [bone for bone in bones if bone not in skeleton.bones]
        if not lacking:
            return skeleton
    raise UnreadableMotion(
        path, f"the skeleton {candidates[-1].name} has no bone {lacking[0]!r}: not the one of this motion"
    )


def _candidates(path: Path, data: bytes) -> list[Path]:
    """Skeletons beside a motion, the likeliest first: same name, same subject, named in the header, any."""
    beside = sorted(p for p in path.parent.iterdir() if p.suffix.lower() == ".asf" and p.is_file())
    named = _NAMED_SKELETON.search(data[:2000])
    header = named[1].decode("latin-1").strip().lower() if named else ""
    stem = path.stem.lower()

    def rank(other: Path) -> tuple[int, int]:
        name = other.stem.lower()
        if stem == name or re.match(re.escape(name) + r"[^a-z0-9]", stem):
            return 0, -len(name)
        return (1, 0) if other.name.lower() == header else (2, 0)

    return sorted(beside, key=rank)


def _take(
    path: str | PathLike[str],
    skeleton: Skeleton,
    channels: dict[str, NDArray[np.float64]],
    radians: bool,
    fps: float | None,
) -> Take:
    """Forward kinematics of the Acclaim convention: a bone turns about its own axes, then its parent's turns follow."""
    frames = next(iter(channels.values())).shape[1]
    names: list[str] = []
    parents: list[int] = []
    rest: list[NDArray[np.float64]] = []
    positions: list[NDArray[np.float64]] = []
    number: dict[str, int] = {}
    poses: dict[str, Pose] = {}
    tips: dict[str, NDArray[np.float64]] = {}

    def add(name: str, parent: int, at_rest: NDArray[np.float64], place: NDArray[np.float64]) -> None:
        names.append(name)
        parents.append(parent)
        rest.append(at_rest)
        positions.append(place.T)

    for bone in skeleton.order:
        start = poses[bone.parent] if bone.parent else Pose.identity(frames)
        start_rest = tips[bone.parent] if bone.parent else bone.offset
        values = channels.get(bone.name, np.zeros((len(bone.dof), frames)))
        if len(values) != len(bone.dof):
            raise UnreadableMotion(path, f"{bone.name} has {len(values)} values a frame, its skeleton {len(bone.dof)}")
        pose, tip = _move(start, bone, values, radians)
        number[bone.name] = len(names)
        add(bone.name, number.get(bone.parent, -1), start_rest, pose.position)
        poses[bone.name] = Pose(pose.axes, tip)
        tips[bone.name] = start_rest + (bone.offset if bone.parent else 0)
        if bone.is_last:
            add(f"{bone.name}_end", number[bone.name], tips[bone.name], tip)
    owners = [name if name in poses else names[parent] for name, parent in zip(names, parents, strict=True)]

    def rotations() -> NDArray[np.float64]:
        return np.stack([np.stack(poses[owner].axes, axis=-1).transpose(1, 0, 2) for owner in owners], axis=1)

    return Take(tuple(names), np.array(parents), np.array(rest), np.stack(positions, axis=1), fps, rotations=rotations)


def _move(start: Pose, bone: Bone, values: NDArray[np.float64], radians: bool) -> tuple[Pose, NDArray[np.float64]]:
    """A bone's frame, where it begins, and its tip, (3, T)."""
    shift = np.zeros((3, values.shape[1]))
    length = 1.0
    angles: list[tuple[int, NDArray[np.float64]]] = []
    for dof, value in zip(bone.dof, values, strict=True):
        if dof[0] == "r":
            angles.append(("xyz".index(dof[1]), value if radians else np.deg2rad(value)))
        elif dof[0] == "t":
            shift["xyz".index(dof[1])] += value
        else:
            length = 1 + value / max(float(np.linalg.norm(bone.offset)), 1e-9)
    axes = _turn_all(start.axes, bone)
    for axis, angle in reversed(angles):
        axes = turn(axes, axis, angle)
    axes = _turn_all_back(axes, bone)
    if not bone.parent:
        base = shift + bone.offset[:, None]
        return Pose(axes, base), base
    pose = Pose(axes, start.place(shift))
    return pose, pose.place(bone.offset[:, None] * length)


def _turn_all(axes: Axes, bone: Bone) -> Axes:
    for axis, angle in reversed(bone.axis):
        axes = turn(axes, axis, np.array(angle))
    return axes


def _turn_all_back(axes: Axes, bone: Bone) -> Axes:
    for axis, angle in bone.axis:
        axes = turn(axes, axis, np.array(-angle))
    return axes
