"""`motionseek export`: a clip, or a span of it, as a motion file."""

from __future__ import annotations

from pathlib import Path

import click

from search.cli import options


@click.command()
@click.argument("ref", metavar="CLIP")
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@options.start
@options.end
@options.force
@options.library
@options.as_json
def export(
    ref: str, out: Path, start: float | None, end: float | None, force: bool, folder: str | None, as_json: bool
) -> None:
    """Export CLIP, or a span of it, to a motion file.

    OUT is a .bvh, .npz or .npy file. CLIP is a file, or a clip of the library by path, name or number. A .bvh span of a
    .bvh file keeps rig, frame rate and values; anything else is written with the 22-joint skeleton at 20 fps. .npz and
    .npy hold joint positions in metres, Y up.

    \b
    Examples:
      motionseek export long_take.bvh sits.bvh --start 12.4 --end 15
      motionseek export fights/wave_03.bvh wave.npz
    """
    from search.cli import terminal
    from search.export.cut import WRITERS, write_cut

    if out.suffix.lower() not in WRITERS:
        raise click.UsageError(f"{out}: unsupported format; use {', '.join(WRITERS)}")
    options.refuse_overwriting(out, force)
    with options.open_source(ref, folder) as (_, source, _library):
        if source.file is not None and out.exists() and out.samefile(source.file):
            raise click.UsageError(f"{out} is the source file of the clip; choose another file")
        frames, fps = write_cut(source, out, start, end)
    if as_json:
        terminal.document({"path": str(out), "source": source.path, "frames": frames, "fps": round(fps, 4)})
    else:
        print(f"{out}: {frames} {'frame' if frames == 1 else 'frames'} at {fps:g} fps")
