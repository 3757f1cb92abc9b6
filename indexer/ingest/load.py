"""A motion file of any rig becomes a Motion."""

from __future__ import annotations

from os import PathLike

from encoders.arguments import checked_path
from encoders.motion import Motion
from indexer.argument_checks import checked_joint_map, checked_rate
from indexer.ingest.file_parts import read_part
from indexer.rigs.retarget import retarget


def load_motion(
    path: str | PathLike[str], *, fps: float | None = None, joint_map: dict[str, str] | None = None
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

    Raises
    ------
    ArgumentError
        If an argument is of a wrong type or out of range.
    UnreadableMotion
        If the file holds no motion that can be read, or several and none is named.
    UnknownRig
        If its skeleton cannot be mapped; names what is missing.
    """
    file, rate, names = checked_path("path", path), checked_rate(fps), checked_joint_map(joint_map)
    part = read_part(file, fps=rate)
    return retarget(part.take, path=part.file, joint_map=names)
