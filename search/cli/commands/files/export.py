"""`motionseek export`: a clip, or a span of it, as a motion file."""

from __future__ import annotations

from pathlib import Path

import click

from search.cli import options
from search.cli.path_types import NEW_FILE


@click.command()
@click.argument("ref", metavar="CLIP")
@click.argument("out", type=NEW_FILE)
@options.start
@options.end
@click.option(
    "--fps",
    type=options.Number(1, 1000),
    help="Frame rate of OUT, such as 24, 30 or 60; a .npy has always 20. [default: that of the source's rig, else 20]",
)
@click.option("--in-place", is_flag=True, help="Leave out the way travelled over the floor, as loops need it.")
@click.option(
    "--rig",
    type=NEW_FILE,
    metavar="LIKE.bvh",
    help="Write a .bvh on the skeleton of this file.",
)
@options.up
@options.force
@options.library
@options.as_json
def export(
    ref: str,
    out: Path,
    start: float | None,
    end: float | None,
    fps: float | None,
    in_place: bool,
    rig: Path | None,
    up: str | None,
    force: bool,
    folder: str | None,
    as_json: bool,
) -> None:
    """Export CLIP, or a span of it, to a motion file.

    OUT is a .bvh, .glb, .npz or .npy file. CLIP is a file, or a clip of the library by path, name or number. A .bvh
    keeps rig and frame rate of a source that has a rig, or is written on that of another file by --rig; anything else
    has the 22 joints at 20 fps. .glb, .npz and .npy are in metres, Y up.

    \b
    Examples:
      motionseek export long_take.bvh sits.bvh --start 12.4 --end 15
      motionseek export fights/wave_03.bvh wave.npz
      motionseek export take_001.bvh loop.glb --start 2 --end 3.2 --in-place --fps 30
      motionseek export '#17' kick.bvh --rig my_character.bvh
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.export.cut import WRITERS, write_cut

    if out.suffix.lower() not in WRITERS:
        raise click.UsageError(f"{out}: unsupported format; use {', '.join(WRITERS)}")
    options.refuse_overwriting(out, force)
    with (
        working(f"exporting {ref}"),
        options.open_source(ref, folder, up=up, tell=False) as (_, source, _library),  # write_cut says more
    ):
        if source.file is not None and out.exists() and source.file.exists() and out.samefile(source.file):
            raise click.UsageError(f"{out} is the source file of the clip; choose another file")
        frames, fps = write_cut(source, out, start, end, fps=fps, in_place=in_place, rig=rig)
        stale = source.stale() or None
    if as_json:
        written = {"path": str(out), "source": source.path, "frames": frames, "fps": round(fps, 4)}
        terminal.document(written | {"stale": stale})
    else:
        print(f"{out}: {frames} {'frame' if frames == 1 else 'frames'} at {fps:g} fps")
