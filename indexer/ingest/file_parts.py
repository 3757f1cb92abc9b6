"""The parts of a file, read: each of its animations, and each figure in them. Their names: `indexer.part_names`."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import NamedTuple

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_takes, split_name
from indexer.part_names import is_meant, with_part
from indexer.rigs.figures import figures
from indexer.take import Take


def read_parts(path: str | PathLike[str], *, fps: float | None = None) -> list[tuple[str, Take]]:
    """Every part of a file with its name, at least one; names differ.

    Raises
    ------
    UnreadableMotion
        If it holds no motion that can be read.
    """
    takes = read_takes(path, fps=fps)
    only = takes[0].name if len(takes) == 1 else ""
    return [(figure.name.removeprefix(only).lstrip("#"), figure) for take in takes for figure in figures(take)]


class FilePart(NamedTuple):
    """A part of a file, and whether the file has no other."""

    file: Path
    take: Take
    is_only: bool


def read_part(path: str | PathLike[str], *, fps: float | None = None) -> FilePart:
    """The part that a path such as `file#animation` names, or the only one.

    Raises
    ------
    UnreadableMotion
        Also where the file holds several and none is named, or none of that name.
    """
    file, name = split_name(path)
    parts = read_parts(file, fps=fps)
    for part, take in parts:
        if is_meant(name, part, take.name):
            return FilePart(file, take, len(parts) == 1)
    names = ", ".join(with_part(file.name, part) for part, _ in parts) if len(parts) > 1 else ""
    what = f"no take {name!r}" if name else "several takes"
    raise UnreadableMotion(file, f"it holds {what}" + (f"; name one of them: {names}" if names else ""))


def read_take(path: str | PathLike[str], *, fps: float | None = None) -> Take:
    """The take alone that `read_part` gives."""
    return read_part(path, fps=fps).take
