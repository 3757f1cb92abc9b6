"""`motionseek search`: clips that match a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from search.cli import options
from search.cli.sentence_command import SentenceCommand


@click.command(cls=SentenceCommand)
@click.argument("sentence")
@click.option(
    "--like", metavar="CLIP", help="A file or clip that the clips shall be like, too: 'like this but slower'."
)
@click.option(
    "--weight", type=options.Number(0, 1), help="How much counts SENTENCE, the rest being --like. [default: 0.5]"
)
@options.hits
@options.min_strength
@options.filters
@click.option("--exact", is_flag=True, help="Compare every vector; large libraries are searched by clusters.")
@options.export
@options.export_as
@options.force
@options.library
@options.as_json
def search(
    sentence: str,
    like: str | None,
    weight: float | None,
    k: int,
    min_strength: str | None,
    exact: bool,
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
      motionseek search "walks without swinging the arms"
      motionseek search "kicks -left"
      motionseek search "sits down" --json | jq '.hits[].path'
      motionseek search "a cartwheel" -k 20 --export cartwheels
      motionseek search "like this but slower" --like kicks/roundhouse.bvh
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.query.mixed import WEIGHT, difference_of

    if weight is not None and like is None:
        raise click.UsageError("--weight needs --like CLIP")
    options.refuse_export(export_folder, force)
    with options.open_library(folder) as library:
        with working("searching"):
            source = None if like is None else options.named_source(like, library)
            share = WEIGHT if weight is None else weight
            found = library.search(
                sentence, k, like=source, weight=share, min_strength=min_strength, exact=exact, **filters
            )
        terminal.hits(found, sentence, library, as_json=as_json, sentences=[sentence])
        terminal.remark([sentence if like is None else difference_of(sentence)], library.bundle)
        if not found:
            terminal.note(terminal.no_clips(library, filters))
        options.export_hits(found, export_folder, export_format, library=library, force=force)
