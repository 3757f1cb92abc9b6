"""A motion file of any rig becomes Motions."""

from __future__ import annotations

import os
import warnings
from dataclasses import replace
from hashlib import blake2b
from os import PathLike

from encoders.arguments import checked_path
from encoders.errors import MotionSeekWarning, UnreadableMotion
from encoders.motion import Motion
from indexer.argument_checks import checked_joint_map, checked_rate, checked_up
from indexer.ingest.file_parts import read_part, read_parts
from indexer.read_motion import Reading, ReadMotion
from indexer.rigs.retarget import retarget_with_reading
from indexer.take import Take


def load_motion(
    path: str | PathLike[str],
    *,
    fps: float | None = None,
    joint_map: dict[str, str] | None = None,
    up: str | None = None,
) -> Motion:
    """Read a motion file of any rig and bring it to the 22 joints at 20 frames a second.

    Parameters
    ----------
    path : path
        A file of one of the formats in `indexer.formats.table.FORMATS`; `file#name` for one of several animations or
        figures of a file.
    fps : float, optional
        The file's true frame rate, where it says none or a wrong one.
    joint_map : dict, optional
        Target joint to joint name in the file, over what is found by itself.
    up : str, optional
        The axis that is up, "x", "y", "z", "-x", "-y" or "-z", whatever the file says.

    Raises
    ------
    ArgumentError
        If an argument is of a wrong type or out of range.
    UnreadableMotion
        If the file holds no motion that can be read, or several and none is named.
    UnknownRig
        If its skeleton cannot be mapped; names what is missing.

    Warns
    -----
    MotionSeekWarning
        Of what was left out, mended or taken for granted.
    """
    file, rate, names = checked_path("path", path), checked_rate(fps), checked_joint_map(joint_map)
    axis, part = checked_up(up), read_part(file, fps=rate)
    take = part.take.with_up(axis)
    motion, reading = retarget_with_reading(take, path=part.file, joint_map=names)
    issue_warnings(os.fspath(path), reading)
    return motion


def issue_warnings(path: str, reading: Reading) -> None:
    """Say what was taken for granted in reading a file that no library holds, as `MotionSeekWarning`s."""
    for warning in reading.warnings:
        warnings.warn(f"{path}: {warning}", MotionSeekWarning, stacklevel=3)


def read_motions(
    path: str, fps: float | None = None, joint_map: dict[str, str] | None = None, up: str | None = None
) -> list[ReadMotion]:
    """Every motion of a file, at least one; those that hold no body are named in the first one's warnings.

    Parameters
    ----------
    path : str
    fps : float, optional
        The file's true frame rate.
    joint_map : dict, optional
        Target joint to joint name in the file; one that names joints which the file does not have is meant for other
        files and ignored.
    up : str, optional
        The axis that is up, whatever the file says.

    Raises
    ------
    UnreadableMotion
        See `load_motion`; with the first one's reason where no motion of the file holds a body.
    """
    parts = read_parts(path, fps=fps)
    found: list[ReadMotion] = []
    failed: list[tuple[str, UnreadableMotion]] = []
    for part, take in parts:
        try:
            found.append(_retargeted(path, take, joint_map, up, part))
        except UnreadableMotion as error:
            failed.append((part or take.name, error))
    if not found:
        raise failed[0][1]
    left_out = [f"{part or 'the first figure'} is left out: {error.reason}" for part, error in failed]
    return [replace(found[0], reading=found[0].reading.warned(*left_out)), *found[1:]]


def read_motion(
    path: str, fps: float | None = None, joint_map: dict[str, str] | None = None, up: str | None = None
) -> ReadMotion:
    """The one motion of a file, or the one that `file#part` names; see `read_motions`."""
    part = read_part(path, fps=fps)
    return _retargeted(str(part.file), part.take, joint_map, up, "")


def _retargeted(path: str, take: Take, joint_map: dict[str, str] | None, up: str | None, part: str) -> ReadMotion:
    """A take as a motion with its rig: root joint, number of joints and four digits that tell namings apart."""
    digest = blake2b("\0".join(take.names).encode("utf-8", "replace"), digest_size=2).hexdigest()
    rig = f"{take.names[0]}-{len(take.names)}-{digest}" if take.names else ""
    unknown = [name for name in (joint_map or {}).values() if name not in take.names]
    try:
        motion, reading = retarget_with_reading(take.with_up(up), path=path, joint_map=None if unknown else joint_map)
    except UnreadableMotion as error:
        if not unknown:
            raise
        raise UnreadableMotion(path, f"{error.reason} (the joint map given names {unknown[0]!r}, not in it)") from None
    return ReadMotion(motion, part, rig, reading if up is None else replace(reading, up_reason="given"))
