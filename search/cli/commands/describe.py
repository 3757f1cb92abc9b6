"""`motionseek describe`: what is this?"""

from __future__ import annotations

import click

from search.cli import options


@click.command()
@click.argument("ref", metavar="CLIP")
@options.start
@options.end
@click.option("-k", "k", type=click.IntRange(1, 1000), default=5, show_default=True, help="At most so many.")
@options.fps
@options.library
@options.as_json
def describe(
    ref: str, start: float | None, end: float | None, k: int, fps: float | None, folder: str | None, as_json: bool
) -> None:
    """Say what happens in CLIP: a file, or a clip of the library by path, name or #id.

    A file needs no library; where there is one, its captions are among the sentences.

    \b
    Examples:
      motionseek describe take_017.bvh
      motionseek describe long_take.bvh --start 12 --end 14.5 -k 3
    """
    from search.cli import terminal
    from search.ranking.description import describe_motion

    with options.open_source(ref, folder, fps=fps) as (bundle, source, library):
        texts, _, vectors = library.caption_vectors() if library else ((), None, None)
        sentences = describe_motion(bundle, source.cut(start, end), k, texts, vectors)
    if as_json:
        found = [{"text": text, "score": round(score, 4)} for text, score in sentences]
        terminal.document({"path": source.path, "sentences": found})
    else:
        terminal.table(("score", "sentence"), [(f"{score:.3f}", text) for text, score in sentences], right=("score",))
