"""`motionseek search`: clips that match a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from search.cli import options
from search.cli.sentence_command import SentenceCommand


@click.command(cls=SentenceCommand)
@click.argument("sentence")
@options.hits
@options.min_strength
@options.filters
@options.export
@options.export_as
@options.force
@options.library
@options.as_json
def search(
    sentence: str,
    k: int,
    min_strength: str | None,
    export_folder: Path | None,
    export_format: str,
    force: bool,
    folder: str | None,
    as_json: bool,
    **filters: Any,
) -> None:
    """Find the clips that match SENTENCE, each with its best span.

    \b
    Examples:
      motionseek search "a person limps to the left"
      motionseek search "throws a ball" -k 3 --min-duration 5 --path 'baseball/*'
      motionseek search "sits down" --json | jq '.hits[].path'
      motionseek search "a cartwheel" -k 20 --export cartwheels
    """
    from search.cli import terminal
    from search.cli.progress import working

    options.refuse_export(export_folder, force)
    with options.open_library(folder) as library:
        with working("searching"):
            found = library.search(sentence, k, min_strength=min_strength, **filters)
        terminal.hits(found, sentence, library, as_json=as_json, sentences=[sentence])
        terminal.remark([sentence], library.bundle)
        if not found:
            terminal.note(terminal.no_clips(library, filters))
        options.export_hits(found, export_folder, export_format, library=library, force=force)
