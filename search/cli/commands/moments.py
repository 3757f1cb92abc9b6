"""`motionseek moments`: where in a take, or anywhere in the library, it happens."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import click

from search.cli import options


@click.command()
@click.argument("sentence", required=False)
@click.argument("ref", metavar="[CLIP]", required=False)
@click.option("--then", "steps", metavar="SENTENCE", multiple=True, help="A step; give one for each, in order.")
@click.option("--while", "meanwhile", metavar="SENTENCE", multiple=True, help="What happens at the same time.")
@click.option("--no-split", is_flag=True, help="Take SENTENCE as one step even if it says 'then'.")
@click.option(
    "--plot",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw similarity over time to this PNG, JPEG, SVG or PDF.",
)
@options.force
@options.hits
@options.filters
@options.fps
@options.library
@options.as_json
def moments(
    sentence: str | None,
    ref: str | None,
    steps: tuple[str, ...],
    meanwhile: tuple[str, ...],
    no_split: bool,
    plot: Path | None,
    force: bool,
    k: int,
    fps: float | None,
    folder: str | None,
    as_json: bool,
    **filters: Any,
) -> None:
    """Find the moments in CLIP, or without CLIP in the whole library, where SENTENCE happens.

    CLIP is a file, indexed or not, or a clip of the library by path, name or #id. A sentence in steps ("walks, then
    sits down, then waves") is found as spans that follow one another.

    \b
    Examples:
      motionseek moments "sits down" long_take.bvh --plot sits.png
      motionseek moments "a person jumps" -k 20
      motionseek moments "walks forward, then sits down, then waves" long_take.bvh
      motionseek moments --then "walks" --then "sits down" long_take.bvh
      motionseek moments "walks" --while "raises the right arm" long_take.bvh
    """
    from search.cli import terminal
    from search.drawing.plots import plot_moments, refuse_format
    from search.query.question import Question

    sentence, ref = _told_apart(sentence, ref, bool(steps) or len(meanwhile) > 1)
    question = Question.of(sentence, steps, meanwhile, split_steps=not no_split)
    if plot is not None:
        if ref is None:
            raise click.UsageError("--plot needs a CLIP whose similarity to draw")
        options.refuse_overwriting(plot, force)
        refuse_format(plot)
    if ref is None:
        if fps is not None:
            raise click.UsageError("--fps needs a CLIP whose file it is true of")
        with options.open_library(folder) as library:
            found = library.answer(question, None, k, **filters)
        terminal.answer(question, found, as_json=as_json)
        return

    from search.moments.one_motion import moments_of
    from search.moments.queried_motion import QueriedMotion

    with options.open_source(ref, folder, fps=fps) as (bundle, source, _):
        motion = QueriedMotion(bundle, source, question.encode(bundle))
        found = moments_of(motion, k)
        times, similarity = motion.curve()
    if plot is not None:
        plot_moments(plot, question, source, found, times, similarity)
    terminal.answer(question, found, (times, similarity), as_json=as_json, width=shutil.get_terminal_size().columns)
    if plot is not None:
        terminal.note(f"wrote {plot}")


def _told_apart(sentence: str | None, ref: str | None, has_more: bool) -> tuple[str | None, str | None]:
    """The sentence and the clip, whichever was given first: what is a file is no sentence."""
    if sentence is None or not Path(sentence).is_file():
        return (None, sentence) if has_more and ref is None else (sentence, ref)
    if ref is None and not has_more:
        raise click.UsageError(f'"{sentence}" is a file; say what to look for in it too, such as "a person waves"')
    if ref is not None and Path(ref).is_file():
        raise click.UsageError(f'"{sentence}" and "{ref}" are both files; give one, and a sentence')
    return ref, sentence
