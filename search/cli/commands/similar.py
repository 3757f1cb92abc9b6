"""`motionseek similar`: clips that are similar to a clip."""

from __future__ import annotations

from typing import Any

import click

from search.cli import options


@click.command()
@click.argument("ref", metavar="CLIP")
@options.start
@options.end
@click.option("--moments", is_flag=True, help="Find spans within clips instead of whole clips.")
@options.hits
@options.min_strength
@options.filters
@options.fps
@options.up
@options.library
@options.as_json
def similar(
    ref: str,
    start: float | None,
    end: float | None,
    moments: bool,
    k: int,
    min_strength: str | None,
    fps: float | None,
    up: str | None,
    folder: str | None,
    as_json: bool,
    **filters: Any,
) -> None:
    """Find the clips most similar to CLIP.

    CLIP is a file, or a clip of the library by path, name or number. With --start and --end, the clips most similar to
    that span are found.

    \b
    Examples:
      motionseek similar kicks/roundhouse.bvh
      motionseek similar long_take.bvh --start 12 --end 14.5 --moments
    """
    from search.cli import terminal
    from search.cli.progress import working

    with options.open_library(folder) as library:
        with working("comparing"):
            source = options.named_source(ref, library, fps=fps, up=up)
            found = library.similar(source, k, start, end, moments=moments, min_strength=min_strength, **filters)
        terminal.hits(found, ref, library, as_json=as_json)
        if not found:
            terminal.note(terminal.no_clips(library, filters))
