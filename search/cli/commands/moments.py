"""`motionseek moments`: the spans of one clip, or of the whole library, that match a sentence."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from search.cli import options
from search.cli.path_types import NEW_FILE
from search.cli.sentence_command import SentenceCommand, quoted


@click.command(cls=SentenceCommand)
@click.argument("sentence", required=False)
@click.argument("ref", metavar="[CLIP]", required=False)
@click.option("--then", "steps", metavar="SENTENCE", multiple=True, help="A step of a sequence; repeat for each step.")
@click.option("--while", "meanwhile", metavar="SENTENCE", multiple=True, help="A simultaneous action; can be repeated.")
@click.option("--no-split", is_flag=True, help="Do not split SENTENCE into steps.")
@click.option(
    "--plot",
    type=NEW_FILE,
    help="Plot similarity over time to a .png, .jpg, .svg or .pdf file.",
)
@options.export
@options.export_as
@options.force
@options.hits
@options.min_strength
@options.filters
@options.fps
@options.up
@options.file_model
@options.library
@options.as_json
def moments(
    sentence: str | None,
    ref: str | None,
    steps: tuple[str, ...],
    meanwhile: tuple[str, ...],
    no_split: bool,
    plot: Path | None,
    export_folder: Path | None,
    export_format: str,
    force: bool,
    k: int,
    min_strength: str | None,
    fps: float | None,
    up: str | None,
    model: str | None,
    folder: str | None,
    as_json: bool,
    **filters: Any,
) -> None:
    """Find the moments that match SENTENCE.

    CLIP is a file, indexed or not, or a clip of the library by path, name or number; without CLIP, the whole library is
    searched. A sentence in steps ("walks, then sits down, then waves") matches consecutive spans. Where --then or
    --while state all sentences, one argument is CLIP if it names a file or a clip, else SENTENCE. Filters cannot be
    combined with CLIP.

    \b
    Examples:
      motionseek moments "sits down" long_take.bvh --plot sits.png
      motionseek moments "a person jumps" -k 20 --export jumps
      motionseek moments "walks forward, then sits down, then waves" long_take.bvh
      motionseek moments "walks" --then "sits down"
      motionseek moments --then "walks" --then "sits down" long_take.bvh
      motionseek moments "walks" --while "raises the right arm" long_take.bvh
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.drawing.plots import plot_moments, refuse_format
    from search.query.filters import refuse_filters
    from search.query.question import Question

    sentence, ref = _sentence_and_clip(sentence, ref, folder, bool(steps) or len(meanwhile) > 1)
    question = Question.of(sentence, steps, meanwhile, split_steps=not no_split)
    options.refuse_export(export_folder, force)
    if plot is not None:
        if ref is None:
            raise click.UsageError("--plot needs a CLIP")
        options.refuse_overwriting(plot, force)
        refuse_format(plot)
    if ref is None:
        for option, value in {"--fps": fps, "--up": up, "--model": model}.items():
            if value is not None:
                raise click.UsageError(f"{option} needs a CLIP")
        with options.open_library(folder) as library:
            with working("searching"):
                found = library.answer(question, None, k, min_strength=min_strength, **filters)
            terminal.moments(question, found, library, as_json=as_json, filters=filters)
            terminal.remark(question.sentences, library.bundle)
            options.export_hits(found, export_folder, export_format, library=library, force=force)
        return

    from search.moments.one_motion import moments_of
    from search.moments.queried_motion import QueriedMotion

    refuse_filters(filters)
    with (
        _quoting(sentence, ref),
        options.open_source(ref, folder, fps=fps, up=up, model=model) as (bundle, source, in_library),
    ):
        with working(f"searching {source.path}"):
            motion = QueriedMotion(bundle, source, question.encode(bundle))
            found = moments_of(motion, k, min_strength)
            curve = motion.curve()
        if plot is not None:
            plot_moments(plot, question, source, found, *curve)
        width = shutil.get_terminal_size().columns
        terminal.moments(question, found, in_library, curve, as_json=as_json, width=width)
        terminal.remark(question.sentences, bundle)
        options.export_hits(found, export_folder, export_format, library=in_library, fps=fps, up=up, force=force)
    if plot is not None:
        terminal.note(f"wrote {plot}")


@contextmanager
def _quoting(sentence: str | None, ref: str) -> Iterator[None]:
    """Say to quote the sentence where what was taken for a clip may be its last word."""
    from encoders.errors import UnknownClip

    try:
        yield
    except UnknownClip as error:
        if sentence is None or not ref.isalpha():
            raise
        line = quoted(click.get_current_context(), [sentence, ref])
        raise UnknownClip(f"{error}; if it is part of the sentence, put that in quotes: {line}") from None


def _sentence_and_clip(
    sentence: str | None, ref: str | None, folder: str | None, has_more: bool
) -> tuple[str | None, str | None]:
    """The sentence and the clip, in either order: an existing file is the clip.

    Where options state enough sentences (`has_more`), one argument alone may be either.
    """
    from indexer.formats.opening import is_file
    from indexer.formats.table import READABLE

    if sentence is None or not is_file(Path(sentence)):
        if sentence is not None and ref is None and not has_more and Path(sentence).suffix.lower() in READABLE:
            raise click.UsageError(f'"{sentence}": there is no such file; give a sentence to search for, too')
        is_clip = sentence is not None and has_more and ref is None and options.names_clip(sentence, folder)
        return (None, sentence) if is_clip else (sentence, ref)
    if ref is None and not has_more:
        raise click.UsageError(f'"{sentence}" is a file; give a sentence to search for, too, such as "a person waves"')
    if ref is not None and is_file(Path(ref)):
        raise click.UsageError(f'"{sentence}" and "{ref}" are both files; give one file and a sentence')
    return ref, sentence
