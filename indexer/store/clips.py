"""Clip and Caption: what the library knows of a motion."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Any

from indexer.part_names import with_part
from indexer.read_motion import Reading
from indexer.store.files import ARRAY

#: The clips that can be found; conditions may use the columns of `clips` and `files`.
LIVE = "FROM clips JOIN files ON files.id = clips.file_id WHERE files.state = 'indexed'"

#: How clips can be sorted, as SQL orders.
ORDERS = {
    "name": "clips.name COLLATE NOCASE, clips.id",
    "longest": "clips.duration DESC, clips.id",
    "shortest": "clips.duration, clips.id",
    "newest": "clips.added DESC, clips.id DESC",
}

_COLUMNS = (
    "clips.id, clips.clip_path, files.root_id, clips.name, clips.duration, clips.fps, clips.frames, "
    "clips.format, clips.rig, clips.added, clips.part, clips.take, clips.up, clips.up_reason, clips.start, "
    "clips.source_fps, clips.source_frames, clips.warnings"
)


@dataclass(frozen=True)
class Clip:
    """A motion of the library.

    Attributes
    ----------
    path : str
        Relative to `root`, with forward slashes, and with `#part` where the file gives several; the id of a clip that
        was added as an array.
    root : Path
        The indexed folder it lies in; for a clip that was added as an array a folder that does not exist.
    root_name : str
        What `root` is called where absolute paths are not shown; see `root_names`.
    name : str
        The file's name without its ending, with the part, or the last part of the id.
    duration : float
        Seconds.
    fps, frames : float, int
        Of the stored motion.
    format : str
        The file's ending, without the dot; "array" for a clip that was added as one.
    rig : str
        A name for the skeleton of the file; empty where it has none.
    added : str
        When it was first indexed, UTC, ISO 8601.
    part : str
        What tells it from other clips of its file; empty for the only or the first one.
    take, up, up_reason, start, source_fps, source_frames, warnings
        How it was read; see `indexer.read_motion.Reading`.
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
    part: str = ""
    take: str = ""
    up: str = ""
    up_reason: str = ""
    start: float = 0.0
    source_fps: float = 0.0
    source_frames: int = 0
    warnings: tuple[str, ...] = ()

    @property
    def file(self) -> Path | None:
        """The source file; None for a clip that was added as an array."""
        return None if self.format == ARRAY else self.root / self.path.removesuffix(with_part("", self.part))

    @property
    def reading(self) -> Reading:
        """How it was read."""
        return Reading(
            self.take, self.up, self.up_reason, self.start, self.source_fps, self.source_frames, self.warnings
        )

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
            **self.reading.document(),
            "captions": [caption.document() for caption in captions],
        }


@dataclass(frozen=True)
class Caption:
    """A description of a clip, or of its span from `start` to `end` in seconds of its file."""

    text: str
    start: float | None = None
    end: float | None = None

    def document(self) -> dict[str, Any]:
        """The caption as plain data."""
        return {"text": self.text, "start": self.start, "end": self.end}


def select(
    db: sqlite3.Connection, roots: Mapping[int, Path], condition: str, values: Sequence[Any], *, limit: int = -1
) -> list[Clip]:
    """The clips that meet an SQL condition with its values bound, in order of their ids; at most `limit`."""
    names = root_names(roots)
    query = f"SELECT {_COLUMNS} {LIVE} AND ({condition}) ORDER BY clips.id LIMIT ?"
    rows = db.execute(query, (*values, limit))
    return [
        Clip(clip_id, path, roots[root], names[root], *[*columns, tuple(json.loads(warnings))])
        for clip_id, path, root, *columns, warnings in rows
    ]


def root_names(roots: Mapping[int, Path]) -> dict[int, str]:
    """A unique name for each root: that of its folder, numbered where an earlier one has it ("takes", "takes (2)")."""
    names: dict[int, str] = {}
    for key, path in sorted(roots.items()):
        folder = path.name or "root"
        numbered = (f"{folder} ({number})" for number in count(2))
        names[key] = next(name for name in chain([folder], numbered) if name not in names.values())
    return names
