"""`motionseek list`: the clips of a library."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from search.cli import options

if TYPE_CHECKING:
    from indexer.store.clips import Caption, Clip
    from search.library import Library


@click.command()
@click.argument("place", metavar="[FOLDER]", required=False, type=click.Path(exists=True, file_okay=False))
@click.option(
    "--sort",
    type=click.Choice(["name", "longest", "shortest", "newest"]),
    help="The order; that of their numbers if not given.",
)
@options.filters
@options.library
@options.as_json
def list(place: str | None, sort: str | None, folder: str | None, as_json: bool, **filters: Any) -> None:
    """List the clips of the library of FOLDER in order of their numbers.

    Without FOLDER, lists those of the nearest library here or in a parent folder.

    When piped, each clip is one line of its number, root, path, duration, frame rate, format, rig and first caption,
    separated by tabs. A number such as '#12' names the clip in every other command.

    \b
    Examples:
      motionseek list my_mocap/
      motionseek list --uncaptioned --min-duration 60 --sort longest
      motionseek list --json | jq -r '.clips[].absolute_path'
    """
    from search.cli import terminal

    with options.open_library(options.one_of(place, folder)) as library:
        clips = _clips(library, sort, filters)
        if as_json:
            found = [
                clip.document(captions) | library.marks(clip.id).document() | {"absolute_path": _absolute_path(clip)}
                for clip, captions in clips
            ]
            terminal.document({"clips": found})
            return
        rows = [_row(clip, captions) for clip, captions in clips]
        terminal.table(
            ("", "root", "path", "seconds", "fps", "format", "rig", "caption"),
            rows,
            right=("seconds", "fps"),
            below=("path", "caption"),
        )
        if not rows:
            terminal.note(terminal.no_clips(library, filters))


def _clips(library: Library, sort: str | None, filters: dict[str, Any]) -> Iterator[tuple[Clip, Sequence[Caption]]]:
    return ((clip, library.captions(clip.id)) for clip in library.clips(sort, **filters))


def _absolute_path(clip: Clip) -> str | None:
    return None if clip.file is None else str(clip.file)


def _row(clip: Clip, captions: Sequence[Caption]) -> tuple[str, ...]:
    number, seconds, fps = f"#{clip.id}", f"{clip.duration:.1f}", f"{clip.fps:g}"
    caption = captions[0].text if captions else ""
    return number, clip.root_name, clip.path, seconds, fps, clip.format, clip.rig, caption
