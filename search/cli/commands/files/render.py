"""`motionseek render`: a motion as an image or an animation."""

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
@click.option("--size", type=options.Count(64, 2160), default=480, show_default=True, help="Image height in pixels.")
@click.option("--fps", type=options.Number(1, 60), default=20, show_default=True, help="Frame rate of an animation.")
@options.up
@options.force
@options.library
@options.as_json
def render(
    ref: str,
    out: Path,
    start: float | None,
    end: float | None,
    size: int,
    fps: float,
    up: str | None,
    force: bool,
    folder: str | None,
    as_json: bool,
) -> None:
    """Render CLIP, or a span of it, to an image file.

    OUT is a .png, .gif or .mp4 file. CLIP is a file, or a clip of the library by path, name or number. A .png shows
    poses side by side, .gif and .mp4 are animations. For .mp4, install ffmpeg or run pip install imageio-ffmpeg.

    \b
    Examples:
      motionseek render take_017.bvh kick.gif
      motionseek render '#17' wave.mp4 --start 12.4 --end 15 --size 720
      motionseek render long_take.bvh strip.png
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.drawing.film import WRITERS, write_picture

    if out.suffix.lower() not in WRITERS:
        raise click.UsageError(f"{out}: unsupported format; use {', '.join(WRITERS)}")
    options.refuse_overwriting(out, force)
    with working(f"rendering {ref}"), options.open_source(ref, folder, up=up) as (_, source, _library):
        frames = write_picture(source.cut(start, end), out, size=size, fps=fps)
        stale = source.stale() or None
    if as_json:
        terminal.document({"path": str(out), "source": source.path, "frames": frames, "stale": stale})
    else:
        print(f"{out}: {frames} {'poses' if out.suffix.lower() == '.png' else 'frames'}")
