"""Time lines of sentences as STMC's data set has them, the motions generated for them, and a real clip of each text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from encoders.errors import QueryError
from encoders.motion import FPS, Motion
from indexer.datasets.archive_tables import read_columns
from indexer.ingest.load import load_motion
from search.compose import timeline
from search.judging.motion_table import JudgedMotion, read_folder


@dataclass(frozen=True)
class Prompt:
    """A sentence of a time line and the frames, at 20 a second, in which it should be shown."""

    text: str
    start: int
    end: int


@dataclass(frozen=True)
class TimelineMotion:
    """A time line with the motion that was generated for it."""

    motion: JudgedMotion
    prompts: tuple[Prompt, ...]

    @property
    def boundaries(self) -> list[int]:
        """Frames inside the motion at which a sentence begins or ends."""
        places = {place for prompt in self.prompts for place in (prompt.start, prompt.end)}
        return sorted(place for place in places if 0 < place < len(self.motion.motion))


def read_timelines(path: Path, folder: Path) -> list[TimelineMotion]:
    """The time lines of a file (`search.compose.timeline`), and for each the motion of the folder.

    A motion has the name of its time line; where those have none, motions follow in the order of their names. As
    published, a frame is the whole part of 20 seconds.

    Raises
    ------
    QueryError
        If the file holds no time line or a wrong one, motions and time lines do not match, or a motion ends before a
        sentence of its time line begins.
    """
    lines = timeline.read_timelines(path)
    motions = {one.name: one for one in read_folder(folder)}
    if len(motions) != len(lines):
        raise QueryError(f"{folder}: holds {len(motions)} motions for the {len(lines)} time lines of {path}")
    in_order = [line.name for line in lines] in ([str(i + 1) for i in range(len(lines))], [""])
    keys = list(motions) if in_order and lines[0].name not in motions else [line.name for line in lines]
    twice = [key for key in keys if keys.count(key) > 1]
    if twice:
        raise QueryError(f"{path}: time line {twice[0]!r} is there twice")
    strange = [key for key in keys if key not in motions]
    if strange:
        raise QueryError(f"{folder}: no motion {strange[0]!r}, which is a time line of {path}")
    found = [TimelineMotion(motions[key], _prompts(line)) for key, line in zip(keys, lines, strict=True)]
    for one in found:
        length = len(one.motion.motion)
        late = [prompt for prompt in one.prompts if prompt.start >= length]
        if late:
            raise QueryError(
                f"{folder}: {one.motion.name} ends after {length / FPS:.2f} s, before {late[0].text!r} begins"
            )
    return found


def _prompts(line: timeline.Timeline) -> tuple[Prompt, ...]:
    return tuple(Prompt(one.text, int(FPS * one.start), int(FPS * one.end)) for one in line.intervals)


def read_references(path: Path) -> dict[str, Motion]:
    """A real clip of each text: a table with the columns text and path, and start and end (seconds) where it is a part.

    Raises
    ------
    QueryError
        If the table cannot be used.
    UnreadableMotion
        If a file cannot be read.
    """
    clips: dict[str, Motion] = {}
    for row in read_columns(path, ("text", "path")):
        motion = load_motion(path.parent / row["path"])
        try:
            start, end = (float(row[key]) if row.get(key) else None for key in ("start", "end"))
            clip = motion.crop(start or 0.0, end)
        except ValueError as error:
            raise QueryError(f"{path}: {row['path']}: {error}") from None
        if row["text"] in clips:
            raise QueryError(f"{path}: has two clips of {row['text']!r}; one is compared")
        clips[row["text"]] = clip
    return clips


def check_references(references: Mapping[str, Motion], timelines: list[TimelineMotion]) -> None:
    """Raise QueryError where a text of a time line has no real clip."""
    missing = {prompt.text for one in timelines for prompt in one.prompts} - references.keys()
    if missing:
        raise QueryError(f"no reference for {len(missing)} texts of the time lines, such as {min(missing)!r}")
