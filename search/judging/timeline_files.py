"""Time lines of sentences as STMC's data set has them, the motions generated for them, and a real clip of each text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from encoders.errors import QueryError
from encoders.motion import FPS, Motion
from indexer.datasets.archive_tables import read_columns
from indexer.ingest.load import load_motion
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
    """Time lines, and for each the motion of the folder.

    A line of the file is `sentence # start # end # body part # ...` in seconds; time lines are parted by blank lines,
    or headed by `## NAME`. A motion has the name of its time line; where those have none, motions follow in the order
    of their names. As published, a time line is shifted to begin at 0, and a frame is the whole part of 20 seconds.

    Raises
    ------
    QueryError
        If the file holds no time line or a line that is none, motions and time lines do not match, or a motion ends
        before a sentence of its time line begins.
    """
    lines = _timelines(path)
    motions = {one.name: one for one in read_folder(folder)}
    if len(motions) != len(lines):
        raise QueryError(f"{folder}: holds {len(motions)} motions for the {len(lines)} time lines of {path}")
    strange = [name for name, _ in lines if name and name not in motions]
    if strange:
        raise QueryError(f"{folder}: no motion {strange[0]!r}, which is a time line of {path}")
    keys = [name or key for (name, _), key in zip(lines, motions, strict=True)]
    found = [TimelineMotion(motions[key], prompts) for key, (_, prompts) in zip(keys, lines, strict=True)]
    for one in found:
        length = len(one.motion.motion)
        late = [prompt for prompt in one.prompts if prompt.start >= length]
        if late:
            raise QueryError(
                f"{folder}: {one.motion.name} ends after {length / FPS:.2f} s, before {late[0].text!r} begins"
            )
    return found


def _timelines(path: Path) -> list[tuple[str, tuple[Prompt, ...]]]:
    """Name, empty where it has none, and prompts of each time line."""
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise QueryError(f"{path}: cannot be read as time lines ({error})") from error
    blocks: list[tuple[str, list[tuple[str, float, float]]]] = []
    is_open = False
    for number, line in enumerate(lines, 1):
        if line.startswith("##"):
            name = line.strip("# \t")
            if name in (known for known, _ in blocks):
                raise QueryError(f"{path}: line {number}: time line {name!r} is there twice")
            blocks.append((name, []))
            is_open = True
        elif line.strip():
            if not is_open:
                blocks.append(("", []))
            blocks[-1][1].append(_prompt(line, f"{path}: line {number}"))
            is_open = True
        else:
            is_open = bool(blocks) and not blocks[-1][1]  # blank lines may follow a name
    blocks = [block for block in blocks if block[1]]
    if not blocks:
        raise QueryError(f"{path}: holds no time line; a line is 'sentence # start # end'")
    named = sum(bool(name) for name, _ in blocks)
    if 0 < named < len(blocks):
        raise QueryError(f"{path}: {named} of {len(blocks)} time lines have a name; all must, or none")
    return [(name, _shifted(prompts)) for name, prompts in blocks]


def _prompt(line: str, place: str) -> tuple[str, float, float]:
    cells = [cell.strip() for cell in line.split("#")]
    try:
        text, start, end = cells[0], float(cells[1]), float(cells[2])
    except (IndexError, ValueError):
        raise QueryError(f"{place}: {line[:60]!r} is no 'sentence # start # end' in seconds") from None
    if not text or not 0 <= start < end < 1e6:
        raise QueryError(f"{place}: {line[:60]!r} needs a sentence, and an end after its start")
    return text, start, end


def _shifted(block: list[tuple[str, float, float]]) -> tuple[Prompt, ...]:
    first = min(start for _, start, _ in block)
    return tuple(Prompt(text, int(FPS * (start - first)), int(FPS * (end - first))) for text, start, end in block)


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
