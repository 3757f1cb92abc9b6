"""`motionseek export`: a cut as a file."""

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
    """Write CLIP, or the cut of it from --start to --end, to OUT (.bvh, .npz or .npy).

    A .bvh cut of a .bvh file keeps its rig, its frame rate and its numbers; any other becomes the 22-joint rig at 20
    frames a second. .npz and .npy hold the 22 joints in metres, Y up.

    \b
    Examples:
      motionseek export long_take.bvh sits.bvh --start 12.4 --end 15
      motionseek export fights/wave_03.bvh wave.npz
    """
    from search.cli import terminal
    from search.export.cut import WRITERS, write_cut

    if out.suffix.lower() not in WRITERS:
        raise click.UsageError(f"{out}: can write {', '.join(WRITERS)}")
    options.refuse_overwriting(out, force)
    with options.open_source(ref, folder) as (_, source, _library):
        if source.file is not None and out.exists() and out.samefile(source.file):
            raise click.UsageError(f"{out} is the clip itself; name another file, its source would be lost")
        frames, fps = write_cut(source, out, start, end)
    if as_json:
        terminal.document({"path": str(out), "source": source.path, "frames": frames, "fps": round(fps, 4)})
    else:
        print(f"{out}: {frames} {'frame' if frames == 1 else 'frames'} at {fps:g} a second")
