"""ReadMotion: a motion out of a file, with what was taken for granted in reading it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from encoders.motion import Motion


def extent(start: float, duration: float) -> str:
    """Where a motion lies in its file, for messages: `4 s`, or `0.5 to 4.5 s` where it does not begin with the file."""
    return f"{start:g} to {start + duration:g} s" if start else f"{duration:g} s"


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

    def document(self) -> dict[str, Any]:
        """What people are told of it, with rounded numbers; None where it is not known."""
        return {
            "up": self.up or None,
            "up_reason": self.up_reason or None,
            "start": round(self.start, 3),
            "source_fps": round(self.source_fps, 4) or None,
            "source_frames": self.source_frames or None,
            "warnings": list(self.warnings),
        }

    def frames(self, start: float, end: float, duration: float) -> tuple[int, int] | None:
        """The first and the last frame of the file, counted from 0, in a span of it; None where its rate is not known.

        Parameters
        ----------
        start, end : float
            Seconds of the file.
        duration : float
            Seconds of the motion: a span up to its end goes up to the file's last frame.
        """
        if not self.source_frames:
            return None
        last = self.source_frames - 1
        first = min(round(start * self.source_fps), last)
        if end < self.start + duration - 1e-6:
            last = min(max(round(end * self.source_fps) - 1, first), last)
        return first, last

    def record(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)

    @staticmethod
    def of(record: dict[str, Any]) -> Reading:
        """What `record` gave."""
        return Reading(**record | {"warnings": tuple(record["warnings"])})


#: Of a motion that no file holds.
NOT_KNOWN = Reading()


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
    reading: Reading = NOT_KNOWN
