"""`motionseek search`: clips that fit a sentence."""

from __future__ import annotations

from typing import Any

import click

from search.cli import options


@click.command()
@click.argument("sentence")
@options.hits
@options.filters
@options.library
@options.as_json
def search(sentence: str, k: int, folder: str | None, as_json: bool, **filters: Any) -> None:
    """Find the clips that fit SENTENCE, each with the span that does.

    \b
    Examples:
      motionseek search "a person limps to the left"
      motionseek search "throws a ball" -k 3 --min-duration 5 --path 'baseball/*'
      motionseek search "sits down" --json | jq '.hits[].path'
    """
    from search.cli import terminal

    with options.open_library(folder) as library:
        found = library.search(sentence, k, **filters)
        terminal.hits(found, sentence, as_json=as_json)
        if not found:
            terminal.note(nothing(library, filters))


def nothing(library: Any, filters: dict[str, Any]) -> str:
    """Why there is no answer."""
    if len(library) == 0:
        return "the library is empty; put motion files into its folder and run 'motionseek index' again"
    if any(value is not None for value in filters.values()):
        return "no clip passes the filters"
    return "nothing found"
