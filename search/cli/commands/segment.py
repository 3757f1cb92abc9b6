"""`motionseek segment`: label a take from beginning to end."""

from __future__ import annotations

from pathlib import Path

import click

from search.cli import options


@click.command()
@click.argument("ref", metavar="TAKE")
@click.option("--labels", metavar="A,B,...", help="The labels, with commas between.")
@click.option("--captions", is_flag=True, help="Take the library's captions as labels.")
@click.option(
    "-o", "--out", type=click.Path(dir_okay=False, path_type=Path), help="Write .tsv, .json, .babel.json or .eaf."
)
@options.force
@options.fps
@options.library
@options.as_json
def segment(
    ref: str,
    labels: str | None,
    captions: bool,
    out: Path | None,
    force: bool,
    fps: float | None,
    folder: str | None,
    as_json: bool,
) -> None:
    """Say what happens in TAKE from its beginning to its end; without labels, in the words of the shipped vocabulary.

    The segments cover the whole take; a segment that none of the labels fits has an empty one. TAKE is a file, or a
    clip of the library by path, name or #id.

    \b
    Examples:
      motionseek segment long_take.bvh --labels "walk, sit down, wave"
      motionseek segment long_take.bvh --labels "walk, sit down" -o long_take.eaf
      motionseek segment long_take.bvh --captions --json
    """
    from search.cli import terminal
    from search.export.annotations import FORMATS, as_document
    from search.moments.segments import segment as divide
    from search.query.vocabulary import vocabulary

    if labels is not None and captions:
        raise click.UsageError("--labels and --captions exclude each other; give one")
    names = [name.strip() for name in (labels or "").split(",") if name.strip()]
    if labels is not None and not names:
        raise click.UsageError('--labels is empty; give some, such as --labels "walk, sit down"')
    write = None
    if out is not None:
        write = next((writer for ending, writer in FORMATS.items() if out.name.lower().endswith(ending)), None)
        if write is None:
            raise click.UsageError(f"{out}: can write {', '.join(FORMATS)}")
        options.refuse_overwriting(out, force)
    with options.open_source(ref, folder, fps=fps) as (bundle, source, library):
        if captions:
            names = sorted(set(library.caption_vectors()[0])) if library else []
            if not names:
                raise click.ClickException("there are no captions to take labels from; give --labels")
        segments = divide(bundle, source.motion, names or vocabulary())
    if out is not None and write is not None:
        out.write_text(write(segments, source.path), encoding="utf-8")
        terminal.note(f"wrote {out}")
    if as_json:
        terminal.document(as_document(segments, source.path))
    elif out is None:
        rows = [(f"{s.start:.1f}", f"{s.end:.1f}", s.label or "-", f"{s.score:.3f}") for s in segments]
        terminal.table(("start", "end", "label", "score"), rows, right=("start", "end", "score"))
