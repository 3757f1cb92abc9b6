"""`motionseek segment`: a take divided into labelled segments."""

from __future__ import annotations

from pathlib import Path

import click

from search.cli import options
from search.cli.path_types import NEW_FILE


@click.command()
@click.argument("ref", metavar="TAKE")
@click.option("--labels", metavar="A,B,...", help="Labels to choose from, separated by commas.")
@click.option("--captions", is_flag=True, help="Use the captions of the library as labels.")
@click.option(
    "-o",
    "--out",
    type=NEW_FILE,
    help="Write them to a .tsv, .json, .babel.json or .eaf file.",
)
@options.force
@options.fps
@options.up
@options.file_model
@options.library
@options.as_json
def segment(
    ref: str,
    labels: str | None,
    captions: bool,
    out: Path | None,
    force: bool,
    fps: float | None,
    up: str | None,
    model: str | None,
    folder: str | None,
    as_json: bool,
) -> None:
    """Divide TAKE into labelled segments.

    TAKE is a file, or a clip of the library by path, name or number. Labels are chosen from --labels, from --captions,
    or else from the built-in vocabulary. The segments cover the whole take; where no label matches, it is empty.

    \b
    Examples:
      motionseek segment long_take.bvh --labels "walk, sit down, wave"
      motionseek segment long_take.bvh --labels "walk, sit down" -o long_take.eaf
      motionseek segment long_take.bvh --captions --json
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.export.annotations import FORMATS, as_document
    from search.export.replacing import write_text
    from search.moments.segments import segment_motion
    from search.query.vocabulary import vocabulary

    if labels is not None and captions:
        raise click.UsageError("--labels and --captions cannot be combined")
    names = [name.strip() for name in (labels or "").split(",") if name.strip()]
    if labels is not None and not names:
        raise click.UsageError('--labels is empty; give labels such as --labels "walk, sit down"')
    write = None
    if out is not None:
        write = next((writer for ending, writer in FORMATS.items() if out.name.lower().endswith(ending)), None)
        if write is None:
            raise click.UsageError(f"{out}: unsupported format; use {', '.join(FORMATS)}")
        options.refuse_overwriting(out, force)
    with (
        working("segmenting"),
        options.open_source(ref, folder, fps=fps, up=up, model=model) as (bundle, source, library),
    ):
        if captions:
            names = sorted(set(library.caption_vectors()[0])) if library else []
            if not names:
                raise click.ClickException("no captions to use as labels; give --labels")
        segments = segment_motion(bundle, source, names or vocabulary())
        stale = source.stale() or None
    if out is not None and write is not None:
        write_text(out, write(segments, source.path))
        terminal.note(f"wrote {out}")
    if as_json:
        terminal.document(as_document(segments, source.path) | {"stale": stale})
    elif out is None:
        rows = [(f"{s.start:.1f}", f"{s.end:.1f}", s.label or "-", f"{s.score:.3f}", s.strength) for s in segments]
        terminal.table(("start", "end", "label", "score", "strength"), rows, right=("start", "end", "score"))
