"""ReadMotion: a motion out of a file, with what was taken for granted in reading it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from encoders.motion import Motion


@dataclass(frozen=True)
class Reading:
    """How a motion was read.

    Attributes
    ----------
    take : str
        What the file calls it: the name of an animation, the number of a figure; empty where it has no name.
    up : str
        The axis of the file that was taken as up, one of `indexer.take.UP_AXES`; empty where it is not known.
    up_reason : str
        Why.
    start : float
        Seconds of the file that were cut off before the motion: its time 0 is this time of the file.
    source_fps, source_frames : float, int
        Frames a second and number of frames of the file; 0 where they are not known.
    warnings : tuple of str
        What was left out, mended or taken for granted.
    """

    take: str = ""
    up: str = ""
    up_reason: str = ""
    start: float = 0.0
    source_fps: float = 0.0
    source_frames: int = 0
    warnings: tuple[str, ...] = ()

    def warned(self, *more: str) -> Reading:
        """The same with more warnings."""
        return replace(self, warnings=(*self.warnings, *more))

    def record(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)

    @staticmethod
    def of(record: dict[str, Any]) -> Reading:
        """What `record` gave."""
        return Reading(**record | {"warnings": tuple(record["warnings"])})


@dataclass(frozen=True)
class ReadMotion:
    """One of the motions of a file.

    Attributes
    ----------
    motion : Motion
    part : str
        What names it among several of its file, as `file#part`; empty for the only or the first one.
    rig : str
        A name for its skeleton.
    reading : Reading
    """

    motion: Motion
    part: str = ""
    rig: str = ""
    reading: Reading = Reading()
