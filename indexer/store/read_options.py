"""Recipe: what besides a file's content decides the motion it gives."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

#: Grows when files come to be read differently than before, so that all are read again.
READER_VERSION = 1


@dataclass(frozen=True)
class ReadOptions:
    """How a file was read.

    Attributes
    ----------
    fps : float or None
        The frame rate it was said to have.
    from_table : bool
        Whether a captions table said so.
    joint_map : tuple of (target joint, joint of the file)
        What was said of its joints.
    reading : int
        `READER_VERSION` at that time; -1 where it is not known.
    """

    fps: float | None = None
    from_table: bool = False
    joint_map: tuple[tuple[str, str], ...] = ()
    reading: int = READER_VERSION

    def text(self) -> str:
        """As it is stored."""
        return json.dumps([self.reading, self.fps, self.from_table, self.joint_map], ensure_ascii=False)

    @staticmethod
    def of(text: str) -> ReadOptions:
        """From what is stored."""
        try:
            reading, fps, from_table, joint_map = json.loads(text)
            return ReadOptions(fps, from_table, tuple((str(a), str(b)) for a, b in joint_map), reading)
        except (ValueError, TypeError):
            return ReadOptions(reading=-1)


@dataclass(frozen=True)
class Asked:
    """How files are to be read in a run: the options that were given, None for those that were not.

    A file is read as it was before where nothing else is asked, so that an option need not be given again.

    Attributes
    ----------
    retry : bool
        Read unchanged files again that could not be read.
    """

    fps: float | None = None
    joint_map: Mapping[str, str] | None = None
    retry: bool = False

    def recipe(self, rate: float | None, before: ReadOptions | None) -> ReadOptions:
        """The recipe for a file with a rate from a captions table, if any, and the recipe it was read by before."""
        before = before or ReadOptions()
        joint_map = before.joint_map if self.joint_map is None else tuple(sorted(self.joint_map.items()))
        if rate is not None:
            return ReadOptions(rate, True, joint_map, READER_VERSION)
        asked_before = None if before.from_table else before.fps
        return ReadOptions(self.fps or asked_before, False, joint_map, READER_VERSION)
