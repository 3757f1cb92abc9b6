"""The names of the parts of a file: its animations, and the figures in each.

The only part of a file, and the first figure where the figures are all there is, is named by the file alone; others
are `file#animation`, `file#2` for the second figure, or `file#animation#2`.
"""

from __future__ import annotations

from collections.abc import Iterator


def with_part(name: str, part: str) -> str:
    """The path or name of a file as that of one of its parts."""
    return f"{name}#{part}" if part else name


def splits(path: str) -> Iterator[tuple[str, str]]:
    """The ways to read a path as a file and a part of it, longer files first; both may contain a #."""
    return ((path[:at], path[at + 1 :]) for at in range(len(path) - 1, 0, -1) if path[at] == "#")


def is_meant(given: str, part: str, take: str) -> bool:
    """Whether a name means a part of a file, by the part's own name or by `take`, what the file calls it.

    The first figure may be called by its number, too.
    """
    plain = "" if given == "1" else given.removesuffix("#1")
    return part in (given, plain) or (take != "" and take in (given, plain))
