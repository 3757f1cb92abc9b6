"""`motionseek duplicates`: the clips that show one performance, in several rigs or mirrored."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from search.cli import options

if TYPE_CHECKING:
    from indexer.store.clips import Clip
    from search.library import Library
    from search.stacks.stacking import Copy


@click.command()
@click.option("--extra", is_flag=True, help="Leave out the first clip of each stack.")
@options.filters
@options.library
@options.as_json
def duplicates(extra: bool, folder: str | None, as_json: bool, **filters: Any) -> None:
    """List the stacks: clips that show one performance, in several rigs, from several files, or mirrored.

    They are told by how the joints move, not by names or files. When piped, each clip is one line of its stack, number,
    root, path, duration, rig and whether it is mirrored, separated by tabs. Nothing is changed.

    \b
    Examples:
      motionseek duplicates
      motionseek duplicates --extra | motionseek tag - --add duplicate
    """
    from search.cli import terminal
    from search.cli.progress import progress_bar

    with options.open_library(folder) as library:
        with progress_bar("clips") as progress:
            found = library.duplicates(progress=lambda done, total: progress(done, total, ""), **filters)
        stacks = [stack[int(extra) :] for stack in found]
        clips = library.clips_by_id([copy.clip_id for stack in stacks for copy in stack])
        if as_json:
            document = [{"clips": [_record(clips[copy.clip_id], copy) for copy in stack]} for stack in stacks]
            terminal.document({"stacks": document})
            return
        rows = [
            _row(number, clips[copy.clip_id], copy) for number, stack in enumerate(stacks, start=1) for copy in stack
        ]
        terminal.table(
            ("stack", "", "root", "path", "seconds", "rig", "mirrored"), rows, right=("seconds",), below=("path",)
        )
        if not rows:
            terminal.note(_none(library, filters))


def _record(clip: Clip, copy: Copy) -> dict[str, Any]:
    return clip.document() | {"mirrored": copy.mirrored, "absolute_path": None if clip.file is None else str(clip.file)}


def _row(number: int, clip: Clip, copy: Copy) -> tuple[str, ...]:
    flipped = "mirrored" if copy.mirrored else ""
    return str(number), f"#{clip.id}", clip.root_name, clip.path, f"{clip.duration:.1f}", clip.rig, flipped


def _none(library: Library, filters: dict[str, Any]) -> str:
    from search.cli import terminal

    return terminal.why_no_clips(library, filters) or "no two clips show one performance"
