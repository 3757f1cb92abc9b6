"""`motionseek tag`: stars, tags and collections of clips."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from search.cli import options
from search.cli.piped import clips_in

if TYPE_CHECKING:
    from search.library import Library

Names = tuple[str, ...]


@click.command()
@click.argument("clips", metavar="[CLIP]...", nargs=-1)
@click.option("--add", "added", metavar="NAME", multiple=True, help="Tag the clips; can be repeated.")
@click.option("--remove", "removed", metavar="NAME", multiple=True, help="Take a tag from them.")
@click.option("--star/--unstar", default=None, help="Star the clips, or take their stars.")
@click.option("--collect", metavar="NAME", multiple=True, help="Put the clips into a collection.")
@click.option("--uncollect", metavar="NAME", multiple=True, help="Take them out of a collection.")
@options.library
@options.as_json
def tag(
    clips: Names,
    added: Names,
    removed: Names,
    star: bool | None,
    collect: Names,
    uncollect: Names,
    folder: str | None,
    as_json: bool,
) -> None:
    """Star CLIP, tag it, or collect it; without options, show what it has.

    CLIP is a path, a name or '#number' of a clip of the library, or '-' for those that another command pipes in.
    Without CLIP, all stars, tags and collections are listed with how many clips have each. They live in the library and
    stay with a clip when its file is moved. Searches and 'motionseek list' take --tag, --starred and --collection.

    \b
    Examples:
      motionseek tag take_003.bvh --add fight --add fast
      motionseek tag take_003.bvh '#17' --star --collect reel
      motionseek tag take_003.bvh --remove fast
      motionseek duplicates --extra | motionseek tag - --add duplicate
      motionseek tag
    """
    if "-" in clips:
        piped = clips_in(sys.stdin.read())
        clips = (*(clip for clip in clips if clip != "-"), *piped)
        if not clips:
            return
    given = bool(added or removed or collect or uncollect or star is not None)
    if given and not clips:
        raise click.UsageError("name a clip, by its path, name or '#number'")
    with options.open_library(folder) as library:
        if star or added or collect:
            library.mark(clips, star=bool(star), tags=added, collections=collect)
        if star is False or removed or uncollect:
            library.unmark(clips, star=star is False, tags=removed, collections=uncollect)
        if clips:
            _show_clips(library, clips, as_json)
        else:
            _show_all(library, as_json)


def _show_clips(library: Library, refs: Names, as_json: bool) -> None:
    from search.cli import terminal

    clips = list({clip.id: clip for clip in map(library.find, refs)}.values())
    marks = {clip.id: library.marks(clip.id) for clip in clips}
    if as_json:
        found = [{"id": c.id, "root": c.root_name, "path": c.path} | marks[c.id].document() for c in clips]
        terminal.document({"clips": found})
        return
    rows = [
        (
            f"#{clip.id}",
            clip.root_name,
            clip.path,
            "starred" if marks[clip.id].starred else "",
            ", ".join(marks[clip.id].tags),
            ", ".join(marks[clip.id].collections),
        )
        for clip in clips
    ]
    terminal.table(("", "root", "path", "star", "tags", "collections"), rows, below=("path",))


def _show_all(library: Library, as_json: bool) -> None:
    from search.cli import terminal

    counts = library.mark_counts()
    if as_json:
        terminal.document(counts)
        return
    rows = [("star", "", str(counts["starred"]))] if counts["starred"] else []
    for kind in ("tags", "collections"):
        rows += [(kind.removesuffix("s"), name, str(count)) for name, count in counts[kind].items()]
    terminal.table(("kind", "name", "clips"), rows, right=("clips",))
    if not rows:
        terminal.note("nothing is starred, tagged or collected; motionseek tag CLIP --add NAME tags a clip")
