"""Time lines: sentences, each with the seconds in which it happens and the body parts that do it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

from encoders.arguments import shown
from encoders.errors import QueryError
from search.compose.body_parts import ALL, PARTS, parts_named, parts_of

#: Seconds of a time line, of an interval at least, and intervals: one take's work.
LONGEST, SHORTEST, MOST = 600.0, 0.5, 200
#: Seconds in which one piece goes over into the next, and a body part into another: STMC's overlap; and the longest
#: that can be asked for.
TRANSITION, MAX_TRANSITION = 0.5, 3.0
#: Bytes of a file that holds time lines.
_LARGEST = 8 << 20


@dataclass(frozen=True)
class Pin:
    """The clip that is to show a sentence: its number, and the middle of the span, in seconds of its file."""

    clip_id: int
    at: float


@dataclass(frozen=True)
class Interval:
    """A sentence, its seconds, and the body parts that show it; no parts: they are told by its words.

    Where it is pinned to a clip, no other is chosen.
    """

    text: str
    start: float
    end: float
    parts: frozenset[str] = frozenset()
    pin: Pin | None = None

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.end - self.start

    def __str__(self) -> str:
        return f"{self.text!r} ({self.start:g} to {self.end:g} s)"


@dataclass(frozen=True)
class Cut:
    """A stretch in which the same intervals are active: numbers of the one that leads, and of the one of each part."""

    start: float
    end: float
    base: int
    owners: dict[str, int]


@dataclass(frozen=True)
class Timeline:
    """Intervals in order of their starts, the first at 0; see `Timeline.of`.

    `moved` is by how many seconds they were moved so that the first begins at 0.
    """

    intervals: tuple[Interval, ...]
    name: str = ""
    moved: float = field(default=0.0, compare=False)

    @classmethod
    def of(cls, intervals: Sequence[Interval], name: str = "") -> Timeline:
        """The time line of intervals, begun at 0, body parts filled in from the words where none are given.

        Raises
        ------
        QueryError
            If there are none or too many, one is too short, the whole is too long, nothing happens for a time, or two
            at the same time need the same body part.
        """
        place = f"time line {name}: " if name else ""
        if not 0 < len(intervals) <= MOST:
            raise QueryError(f"{place}{len(intervals)} sentences; give 1 to {MOST}")
        for one in intervals:
            if not any(character.isalnum() for character in one.text):
                raise QueryError(f"{place}a sentence is empty, from {one.start:g} to {one.end:g} s")
            if not (math.isfinite(one.start) and math.isfinite(one.end)) or one.duration < SHORTEST or one.start < 0:
                raise QueryError(f"{place}{one} must start at 0 s or later and last {SHORTEST:g} s at least")
        first = min(one.start for one in intervals)
        shifted = [replace(one, start=one.start - first, end=one.end - first) for one in intervals]
        ordered = sorted(shifted, key=lambda one: (one.start, -one.end))
        if max(one.end for one in ordered) > LONGEST:
            raise QueryError(f"{place}longer than {LONGEST:g} s; compose it in pieces")
        reached = 0.0
        for one in ordered:
            if one.start > reached + 1e-6:
                raise QueryError(
                    f"{place}nothing happens from {reached:g} to {one.start:g} s; fill it, or move what follows"
                )
            reached = max(reached, one.end)
        return cls(tuple(_with_parts(ordered, place)), name, first)

    @classmethod
    def of_steps(cls, steps: Sequence[tuple[str, float]], meanwhile: Sequence[Interval] = ()) -> Timeline:
        """The time line of sentences that follow one another, each with its seconds, and of others during them."""
        ends = [0.0]
        for _, seconds in steps:
            ends.append(ends[-1] + seconds)
        following = [Interval(text, start, end) for (text, _), (start, end) in zip(steps, pairwise(ends), strict=True)]
        return cls.of([*following, *meanwhile])

    @property
    def duration(self) -> float:
        """Seconds."""
        return max(one.end for one in self.intervals)

    def cuts(self) -> list[Cut]:
        """The stretches between starts and ends, each with the intervals that show its parts.

        As STMC and SINC have it: the interval with the legs leads, else the one with most parts; it has all parts that
        no other names.
        """
        edges = sorted({edge for one in self.intervals for edge in (one.start, one.end)})
        cuts = []
        for start, end in pairwise(edges):
            active = [i for i, one in enumerate(self.intervals) if one.start <= start and one.end >= end]
            base = max(active, key=lambda i: ("legs" in self.intervals[i].parts, len(self.intervals[i].parts), -i))
            owners = dict.fromkeys(PARTS, base)
            for i in sorted(active, key=lambda i: -len(self.intervals[i].parts)):
                owners |= {part: i for part in self.intervals[i].parts if i != base}
            cuts.append(Cut(start, end, base, owners))
        return cuts


def _with_parts(intervals: list[Interval], place: str) -> list[Interval]:
    """The intervals with body parts: given ones, else what the words tell where others go on at the same time.

    A sentence of the whole body leaves to the others what they name.
    """
    beside = [
        [j for j, other in enumerate(intervals) if j != i and _overlap(one, other)] for i, one in enumerate(intervals)
    ]
    told = [one.parts or (parts_of(one.text) if others else ALL) for one, others in zip(intervals, beside, strict=True)]
    found = []
    for one, parts, others in zip(intervals, told, beside, strict=True):
        theirs = frozenset[str]().union(*(told[j] for j in others))
        found.append(replace(one, parts=parts - theirs if not one.parts and parts == ALL and theirs != ALL else parts))
    for a, b in combinations(found, 2):
        if _overlap(a, b) and a.parts & b.parts:
            raise QueryError(
                f"{place}{a} and {b} both need {' and '.join(sorted(a.parts & b.parts))}; "
                "let one follow the other, or give each its own parts"
            )
    return found


def _overlap(a: Interval, b: Interval) -> bool:
    return min(a.end, b.end) - max(a.start, b.start) > 1e-6


def read_timelines(path: Path) -> list[Timeline]:
    """The time lines of a file: `.json`, or text in the published multi-track form.

    In text a line is `sentence # start # end # body part # ...`, in seconds, body parts optional; time lines are parted
    by blank lines or headed by `## NAME`. In JSON a time line is a list of {"text", "start", "end", "parts"}, and a
    file one such list, or an object of them by name.

    Raises
    ------
    QueryError
        If the file cannot be read or holds none; names the line that is wrong.
    """
    try:
        if path.stat().st_size > _LARGEST:
            raise QueryError(f"{path}: larger than {_LARGEST >> 20} MB; no time line is")
        text = path.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise QueryError(f"{path}: cannot be read as time lines ({error})") from error
    found = _from_json(text, path) if path.suffix.lower() == ".json" else _from_text(text, path)
    if not found:
        raise QueryError(f"{path}: holds no time line; a line is 'sentence # start # end', in seconds")
    return [Timeline.of(intervals, name) for name, intervals in found]


def _from_text(text: str, path: Path) -> list[tuple[str, list[Interval]]]:
    blocks: list[tuple[str, list[Interval]]] = []
    is_open = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("##"):
            blocks.append((line.strip("# \t"), []))
            is_open = True
        elif not line.strip():
            is_open = is_open and not blocks[-1][1]  # blank lines may follow a name
        else:
            if not is_open:
                blocks.append((str(len(blocks) + 1), []))
            blocks[-1][1].append(_interval(line, f"{path}, line {number}"))
            is_open = True
    return [block for block in blocks if block[1]]


def _interval(line: str, place: str) -> Interval:
    text, *cells = (cell.strip() for cell in line.split("#"))
    try:
        start, end = float(cells[0]), float(cells[1])
    except (IndexError, ValueError):
        raise QueryError(f"{place}: {shown(line)} is no 'sentence # start # end', in seconds") from None
    return _checked(text, start, end, [cell for cell in cells[2:] if cell], place)


def _from_json(text: str, path: Path) -> list[tuple[str, list[Interval]]]:
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise QueryError(f"{path}: no JSON ({error})") from None
    named = content if isinstance(content, dict) else {"": content}
    return [
        (name, [_record(row, f"{path}, {name or 'time line'}") for row in _rows(rows, path)])
        for name, rows in named.items()
    ]


def _rows(rows: Any, path: Path) -> list[Any]:
    if not isinstance(rows, list):
        raise QueryError(f'{path}: a time line is a list of {{"text": ..., "start": ..., "end": ...}}')
    return rows


def _record(row: Any, place: str) -> Interval:
    try:
        text, start, end, parts = str(row["text"]), float(row["start"]), float(row["end"]), list(row.get("parts") or [])
    except (TypeError, KeyError, ValueError, AttributeError):
        raise QueryError(f"{place}: {shown(row)} lacks text, start and end in seconds") from None
    return _checked(text, start, end, [str(part) for part in parts], place)


def _checked(text: str, start: float, end: float, parts: list[str], place: str) -> Interval:
    if not 0 <= start < end:
        raise QueryError(f"{place}: {text!r} must end after it starts, and start at 0 s or later")
    try:
        return Interval(text, start, end, parts_named(parts))
    except QueryError as error:
        raise QueryError(f"{place}: {error}") from None
