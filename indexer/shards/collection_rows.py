"""What a collection of Milvus knows of a clip: the fields of its row, and a clip out of them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from encoders.bundle.windows import LENGTHS, Windows
from encoders.errors import ArgumentError
from indexer.part_names import with_part
from indexer.shards.shard import clip_number, slot_of
from indexer.store.clips import Caption, Clip
from indexer.store.marks.marks_table import NO_MARKS, Marks
from indexer.store.spelling import folded
from indexer.vectors.milvus.collection_schema import FIELDS, Row

#: Bytes of the captions and warnings of a clip; Milvus takes 64 kB with all the rest, so further ones are left out.
_MOST_BYTES = 48_000
_IN_DOCUMENT = ("fps", "frames", "added", "part", "take", "up", "up_reason", "start", "source_fps", "source_frames")


@dataclass(frozen=True)
class DistantClip(Clip):
    """A clip of a collection: its file lies with the library that it came from, wherever that is.

    Attributes
    ----------
    captions : tuple of Caption
    marks : Marks
    version : int
        Another one whenever anything of it has changed.
    """

    captions: tuple[Caption, ...] = ()
    marks: Marks = field(default=NO_MARKS)
    version: int = 0

    @property
    def file(self) -> Path | None:
        """None: it is not here."""
        return None


def fields_of(clip: Clip, captions: Sequence[Caption], marks: Marks, splits: Sequence[str]) -> Row:
    """The fields of a clip but for its version and span; see `FIELDS`.

    Raises
    ------
    ArgumentError
        If a text is longer than a field, or no text that can be written.
    """
    file = clip.path.removesuffix(with_part("", clip.part))
    said = [[caption.text, caption.start, caption.end] for caption in captions]
    document = {name: getattr(clip, name) for name in _IN_DOCUMENT}
    document |= {"captions": _bounded(said), "warnings": _bounded(list(clip.warnings))}
    fields: Row = {
        "clip": clip_number(clip.root_name, clip.path),
        "slot": slot_of(file),
        "duration": clip.duration,
        "root": clip.root_name,
        "path": clip.path,
        "folded": folded(clip.path),
        "name": clip.name,
        "rig": clip.rig,
        "format": clip.format,
        "captioned": bool(captions),
        "starred": marks.starred,
        "splits": list(splits),
        "tags": [*map(folded, marks.tags)],
        "collections": [*map(folded, marks.collections)],
        "document": document | {"tags": list(marks.tags), "collections": list(marks.collections)},
    }
    for name, (kind, most) in FIELDS.items():
        for text in fields.get(name, []) if kind == "ARRAY" else [fields.get(name, "")] if kind == "VARCHAR" else []:
            _check(name, text, most)
    return fields


def clip_of(row: Row) -> DistantClip:
    """The clip of a row of the partition of clips."""
    document = row["document"]
    known = {name: document[name] for name in _IN_DOCUMENT}
    return DistantClip(
        id=int(row["clip"]),
        path=row["path"],
        root=Path(row["root"]),
        root_name=row["root"],
        name=row["name"],
        duration=row["duration"],
        format=row["format"],
        rig=row["rig"],
        warnings=tuple(document["warnings"]),
        captions=tuple(dict.fromkeys(Caption(*said) for said in document["captions"])),
        marks=Marks(row["starred"], tuple(document["tags"]), tuple(document["collections"])),
        version=int(row["version"]),
        **known,
    )


def _check(name: str, text: str, most: int) -> None:
    try:
        size = len(text.encode("utf-8"))
    except UnicodeEncodeError:
        raise ArgumentError(f"its {name} is no text that Milvus takes; rename it") from None
    if size > most:
        raise ArgumentError(f"its {name} has {size} bytes, and Milvus takes {most}; shorten it")


def _bounded(items: list[Any]) -> list[Any]:
    """The first of them that take no more than half of `_MOST_BYTES`."""
    kept: list[Any] = []
    left = _MOST_BYTES // 2
    for item in items:
        left -= len(json.dumps(item, ensure_ascii=False).encode("utf-8", "replace"))
        if left < 0:
            break
        kept.append(item)
    return kept


def windows_of(rows: Sequence[Row]) -> list[Windows]:
    """The windows of one clip, shortest length first, of their rows in any order."""
    found: dict[float, list[Row]] = {}
    for row in sorted(rows, key=lambda row: (row["length"], row["start"])):
        found.setdefault(min(LENGTHS, key=lambda grid: abs(grid - row["length"])), []).append(row)
    return [
        Windows(
            length,
            np.array([row["start"] for row in some], np.float32),
            np.array([row["end"] for row in some], np.float32),
            np.array([row["vector"] for row in some], np.float16),
        )
        for length, some in found.items()
    ]
