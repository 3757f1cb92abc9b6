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

    A document is a list of paths, numbers and objects, or an object that has such a list as `clips` or `hits`.

    Raises
    ------
    click.UsageError
        If it begins as JSON and is none, or names something else than clips.
    """
    document = _document(text)
    if document is None:
        return list(dict.fromkeys(_of_line(line) for line in text.splitlines() if line.strip()))
    return list(dict.fromkeys(_of_document(document)))


def _document(text: str) -> Any:
    """What a text is as JSON; None for lines, the first of which may be a name that begins with a bracket."""
    begins = text.lstrip()[:1]
    if begins not in ("{", "["):
        return None
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        if begins == "[":
            return None
        raise click.UsageError("what is piped in begins as JSON and is none") from None


def _of_line(line: str) -> str:
    cells = line.split("\t")
    number = next((cell for cell in cells if _NUMBER.fullmatch(cell)), None)
    return number or (cells[_CLIP] if len(cells) == _OF_HITS else cells[0].strip())


def _of_document(content: Any) -> Iterator[str]:
    if isinstance(content, list):
        yield from map(_of_record, content)
        return
    for name in ("clips", "hits"):
        yield from map(_of_record, _list(content, name))
    for stack in _list(content, "stacks"):
        yield from _of_document(stack)


def _list(content: Any, name: str) -> list[Any]:
    """A list within a JSON object; empty where there is none of the name."""
    found = content.get(name, []) if isinstance(content, dict) else None
    if not isinstance(found, list):
        raise click.UsageError(f"JSON that is piped in must have clips as a list, not {json.dumps(content)[:100]}")
    return found


def _of_record(record: Any) -> str:
    """The reference of a clip by its path or number, or by an object with one as path, id or clip."""
    if isinstance(record, dict):
        number = record.get("id", record.get("clip"))
        record = number if isinstance(number, int) else record.get("path")
    if isinstance(record, int) and not isinstance(record, bool):
        return f"#{record}"
    if isinstance(record, str) and record:
        return record
    raise click.UsageError(f"JSON that is piped in must name clips by path or number, not {json.dumps(record)[:100]}")


def read_clips(_: click.Context, __: click.Parameter, value: str | None) -> tuple[str, ...] | None:
    """The value of --clips: the references in a file, or with "-" of what is piped in."""
    if value is None:
        return None
    with click.open_file(value, encoding="utf-8-sig", errors="surrogateescape") as file:
        return tuple(clips_in(file.read()))
