"""`motionseek describe`: the sentences that match a motion."""

from __future__ import annotations

import click

from search.cli import options


@click.command()
@click.argument("ref", metavar="CLIP")
@options.start
@options.end
@click.option(
    "-k",
    "k",
    metavar="N",
    type=options.Count(1, 1000),
    default=5,
    show_default=True,
    help="Maximum number of sentences.",
)
@options.fps
@options.up
@options.file_model
@options.library
@options.as_json
def describe(
    ref: str,
    start: float | None,
    end: float | None,
    k: int,
    fps: float | None,
    up: str | None,
    model: str | None,
    folder: str | None,
    as_json: bool,
) -> None:
    """Describe CLIP, or a span of it, in sentences.

    CLIP is a file, or a clip of the library by path, name or number. The sentences are those of the built-in vocabulary
    and the captions of the library, if there is one.

    \b
    Examples:
      motionseek describe take_017.bvh
      motionseek describe long_take.bvh --start 12 --end 14.5 -k 3
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.documents import description_document
    from search.ranking.description import describe_motion

    with (
        working("describing"),
        options.open_source(ref, folder, fps=fps, up=up, model=model) as (bundle, source, library),
    ):
        texts, _, vectors = library.caption_vectors() if library else ((), None, None)
        sentences = describe_motion(bundle, source.cut(start, end), k, texts, vectors)
    if as_json:
        terminal.document(description_document(source.path, sentences))
    else:
        terminal.table(("score", "sentence"), [(f"{score:.3f}", text) for text, score in sentences], right=("score",))
