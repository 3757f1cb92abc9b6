"""Clip and Caption: what the library says of a motion."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Any

#: The clips that are there: the columns of `clips` and `files` may be asked for.
LIVE = "FROM clips JOIN files ON files.id = clips.file_id WHERE files.state = 'indexed'"

_COLUMNS = (
    "clips.id, files.path, files.root_id, clips.name, clips.duration, clips.fps, clips.frames, clips.format, "
    "clips.rig, clips.added"
)


@dataclass(frozen=True)
class Clip:
    """A motion of the library.

    Attributes
    ----------
    path : str
        Relative to `root`, with forward slashes.
    root : Path
        The indexed folder it lies in.
    root_name : str
        What `root` is called where absolute paths are not shown; see `root_names`.
    name : str
        The file's name without its ending.
    duration : float
        Seconds.
    fps, frames : float, int
        Of the stored motion.
    format : str
        The file's ending, without the dot.
    rig : str
        What the reader called the skeleton; empty where it said nothing.
    added : str
        When it was first indexed, UTC, ISO 8601.
    """

    id: int
    path: str
    root: Path
    root_name: str
    name: str
    duration: float
    fps: float
    frames: int
    format: str
    rig: str
    added: str

    @property
    def file(self) -> Path:
        """The source file."""
        return self.root / self.path

    def document(self, captions: Sequence[Caption] = ()) -> dict[str, Any]:
        """The clip as plain data with stable keys and rounded numbers; it contains no absolute path."""
        return {
            "id": self.id,
            "root": self.root_name,
            "path": self.path,
            "name": self.name,
            "duration": round(self.duration, 3),
            "fps": self.fps,
            "frames": self.frames,
            "format": self.format,
            "rig": self.rig,
            "added": self.added,
            "captions": [caption.document() for caption in captions],
        }


@dataclass(frozen=True)
class Caption:
    """What is said of a clip, or of the span from `start` to `end` in seconds."""

    text: str
    start: float | None = None
    end: float | None = None

    def document(self) -> dict[str, Any]:
        """The caption as plain data."""
        return {"text": self.text, "start": self.start, "end": self.end}


def select(db: sqlite3.Connection, roots: Mapping[int, Path], condition: str, values: Sequence[Any]) -> list[Clip]:
    """The clips that meet an SQL condition with its values bound, in order of their ids."""
    names = root_names(roots)
    rows = db.execute(f"SELECT {_COLUMNS} {LIVE} AND {condition} ORDER BY clips.id", values)
    return [Clip(clip_id, path, roots[root], names[root], *rest) for clip_id, path, root, *rest in rows]


def root_names(roots: Mapping[int, Path]) -> dict[int, str]:
    """A unique name for each root: that of its folder, numbered where an earlier one has it ("takes", "takes (2)")."""
    names: dict[int, str] = {}
    for key, path in sorted(roots.items()):
        folder = path.name or "root"
        numbered = (f"{folder} ({number})" for number in count(2))
        names[key] = next(name for name in chain([folder], numbered) if name not in names.values())
    return names
