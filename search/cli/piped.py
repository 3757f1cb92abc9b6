"""Clips that one command prints and the next one reads: lines or JSON of `list`, `search` and `duplicates`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import click

_NUMBER = re.compile(r"#\d+")
#: Cells of a line of `search`, `moments` or `similar`, and which of them names the clip.
_OF_HITS, _CLIP = 8, 5


def clips_in(text: str) -> list[str]:
    """References of the clips that a text names, each once: a JSON document, or a clip a line.

    Raises
    ------
    click.UsageError
        If it begins as JSON and is none, or names no clips.
    """
    if text.lstrip().startswith("{"):
        try:
            found = list(_of_document(json.loads(text)))
        except (ValueError, RecursionError):
            raise click.UsageError("what is piped in begins as JSON and is none") from None
    else:
        found = [_of_line(line) for line in text.splitlines() if line.strip()]
    return list(dict.fromkeys(found))


def _of_line(line: str) -> str:
    cells = line.split("\t")
    number = next((cell for cell in cells if _NUMBER.fullmatch(cell)), None)
    return number or (cells[_CLIP] if len(cells) == _OF_HITS else cells[0].strip())


def _of_document(content: Any) -> Iterator[str]:
    for record in content.get("clips", []) + content.get("hits", []):
        number = record.get("id", record.get("clip"))
        yield f"#{number}" if isinstance(number, int) else str(record.get("path", ""))
    for stack in content.get("stacks", []):
        yield from _of_document(stack)


def read_clips(_: click.Context, __: click.Parameter, value: str | None) -> tuple[str, ...] | None:
    """The value of --clips: the references in a file, or with "-" of what is piped in."""
    if value is None:
        return None
    with click.open_file(value, encoding="utf-8-sig", errors="surrogateescape") as file:
        return tuple(clips_in(file.read()))
