"""ASF/AMC: a skeleton file (.asf) and motions (.amc) that belong to it, found beside each other.

A motion may state its frame rate, as SAMPLES-PER-SECOND, but few do: it is 120 by default (`default_fps` in
`indexer.formats.table`), or given; see `indexer.store.read_options` for what takes precedence.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.acclaim.amc_frames import AmcFrames, read_frames
from indexer.formats.acclaim.asf import Bone, Skeleton, read_skeleton
from indexer.formats.kinematics import Pose, turn, turned
from indexer.formats.opening import beside
from indexer.take import Take

#: Frames a second that a header may state.
_RATES = 2.0, 1e4

_BLOCK = 1024  # frames whose poses fit the processor's cache, and bound the memory they need

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
    frames = read_frames(path, data)
    skeleton = _skeleton(path, data, list(frames.values))
    if fps is None and frames.fps is not None:
        if not _RATES[0] <= frames.fps <= _RATES[1]:
            raise UnreadableMotion(
                path, f"SAMPLES-PER-SECOND {frames.fps:g} is no frame rate of a recording; give the true one with fps"
            )
        fps = frames.fps
    return [_take(path, skeleton, frames, fps)]


def _skeleton(path: str | PathLike[str], data: bytes, bones: list[str]) -> Skeleton:
    """The skeleton beside the motion that has all its bones."""
    candidates = _candidates(Path(path), data)
    if not candidates:
        raise UnreadableMotion(path, "its skeleton is missing: put the .asf file that belongs to it in the same folder")
    reasons: list[str] = []
    cause: BaseException | None = None
    for candidate in candidates:
        try:
            skeleton = read_skeleton(candidate)
        except UnreadableMotion as error:
            reasons.append(f"{candidate.name}: {error.reason}")
            cause = cause or error.__cause__
            continue
        lacking = [bone for bone in bones if bone not in skeleton.bones]
        if not lacking:
            return skeleton
        reasons.append(f"the skeleton {candidate.name} has no bone {lacking[0][:40]!r}: not the one of this motion")
    raise UnreadableMotion(path, reasons[0]) from cause


def _candidates(path: Path, data: bytes) -> list[Path]:
    """Skeletons beside a motion, the likeliest first: same name, same subject, named in the header, any."""
    skeletons = [other for other in beside(path) if other.suffix.lower() == ".asf"]
    named = _NAMED_SKELETON.search(data[:2000])
    header = named[1].decode("latin-1").strip().lower() if named else ""
    stem = path.stem.lower()

    def rank(other: Path) -> tuple[int, int]:
        name = other.stem.lower()
        if stem == name or re.match(re.escape(name) + r"[^a-z0-9]", stem):
            return 0, -len(name)
        return (1, 0) if other.name.lower() == header else (2, 0)

    return sorted(skeletons, key=rank)


def _take(path: str | PathLike[str], skeleton: Skeleton, frames: AmcFrames, fps: float | None) -> Take:
    """Rest pose and, by forward kinematics, the pose of each frame."""
    radians = skeleton.radians if frames.is_radians is None else frames.is_radians
    values = _values(path, skeleton, frames)
    names: list[str] = []
    parents: list[int] = []
    rest: list[NDArray[np.float64]] = []
    tips: dict[str, NDArray[np.float64]] = {}
    owners: list[tuple[Bone, bool]] = []
    number: dict[str, int] = {}
    for bone in skeleton.order:
        start = tips[bone.parent] if bone.parent else bone.offset
        tips[bone.name] = tips[bone.parent] + bone.offset if bone.parent else bone.offset
        number[bone.name] = len(names)
        for is_tip in (False, True) if bone.is_last else (False,):
            owners.append((bone, is_tip))
            names.append(f"{bone.name}_end" if is_tip else bone.name)
            parents.append(number[bone.name] if is_tip else number.get(bone.parent, -1))
            rest.append(tips[bone.name] if is_tip else start)
    count = next(iter(values.values())).shape[1]
    positions = np.empty((len(owners), 3, count))
    for block, moved in _poses(skeleton, values, radians):
        for i, (bone, is_tip) in enumerate(owners):
            pose, tip = moved[bone.name]
            positions[i, :, block] = tip if is_tip else pose.position

    def rotations() -> NDArray[np.float64]:
        turns = np.empty((count, len(owners), 3, 3))
        for block, moved in _poses(skeleton, values, radians):
            for i, (bone, _) in enumerate(owners):
                turns[block, i] = np.stack(turned(moved[bone.name].pose.axes, bone.axes.T), axis=-1).transpose(1, 0, 2)
        return turns

    places = positions.transpose(2, 0, 1)
    return Take(
        tuple(names), np.array(parents), np.array(rest), places, fps, warnings=frames.warnings, rotations=rotations
    )


def _values(path: str | PathLike[str], skeleton: Skeleton, frames: AmcFrames) -> dict[str, NDArray[np.float64]]:
    """What moves each bone in every frame, (n, T)."""
    count = next(iter(frames.values.values())).shape[1]
    values: dict[str, NDArray[np.float64]] = {}
    for bone in skeleton.order:
        values[bone.name] = frames.values.get(bone.name, np.zeros((len(bone.dof), count)))
        if len(values[bone.name]) != len(bone.dof):
            found = len(values[bone.name])
            raise UnreadableMotion(path, f"{bone.name} has {found} values a frame, its skeleton {len(bone.dof)}")
    return values


class _Moved(NamedTuple):
    """A bone where it begins, and its tip (3, T)."""

    pose: Pose
    tip: NDArray[np.float64]


def _poses(
    skeleton: Skeleton, values: dict[str, NDArray[np.float64]], radians: bool
) -> Iterator[tuple[slice, dict[str, _Moved]]]:
    """The bones in motion, some frames at a time.

    That is the Acclaim convention: a bone turns about its own axes, then its parent's turns follow. The pose of a bone
    is that of its own axes, which differ from the bone's frame by `bone.axes`.
    """
    count = next(iter(values.values())).shape[1]
    for start in range(0, count, _BLOCK):
        block = slice(start, min(start + _BLOCK, count))
        moved: dict[str, _Moved] = {}
        for bone in skeleton.order:
            if bone.parent:
                origin, to_start = (
                    Pose(moved[bone.parent].pose.axes, moved[bone.parent].tip),
                    skeleton.bones[bone.parent].axes.T,
                )
            else:
                origin, to_start = Pose.identity(block.stop - start), np.eye(3)
            moved[bone.name] = _Moved(*_move(origin, to_start, bone, values[bone.name][:, block], radians))
        yield block, moved


def _move(
    start: Pose, to_start: NDArray[np.float64], bone: Bone, values: NDArray[np.float64], radians: bool
) -> tuple[Pose, NDArray[np.float64]]:
    """A bone's pose, where it begins, and its tip (3, T); `to_start` (3, 3) turns into the axes of its start."""
    shift = np.zeros((3, values.shape[1]))
    length: NDArray[np.float64] | float = 1.0
    angles: list[tuple[int, NDArray[np.float64]]] = []
    for dof, value in zip(bone.dof, values, strict=True):
        if dof[0] == "r":
            angles.append(("xyz".index(dof[1]), value if radians else np.deg2rad(value)))
        elif dof[0] == "t":
            shift["xyz".index(dof[1])] += value
        else:
            length = 1 + value / max(float(np.linalg.norm(bone.offset)), 1e-9)
    own = bone.axes
    axes = turned(start.axes, to_start @ own)
    for axis, angle in reversed(angles):
        axes = turn(axes, axis, angle)
    if not bone.parent:
        base = shift + bone.offset[:, None]
        return Pose(axes, base), base
    place = start.place(to_start @ shift) if shift.any() else start.position
    offset = own.T @ bone.offset
    pose = Pose(axes, place)
    return pose, pose.place(offset if isinstance(length, float) else offset[:, None] * length)
