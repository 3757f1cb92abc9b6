"""`motionseek compose`: a time line of sentences becomes one motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from search.cli import options
from search.cli.path_types import FILE, NEW_FILE

if TYPE_CHECKING:
    from search.compose.composition import Composition
    from search.compose.timeline import Timeline

#: Seconds from 0 at which a time line may begin without a word.
_NOTICED = 0.05


@click.command()
@click.argument("timeline", required=False, type=FILE)
@click.option("-o", "--out", type=NEW_FILE, required=True, help="Write a .bvh, .glb, .npz, .npy, .png or .gif file.")
@click.option(
    "--then",
    "steps",
    type=(str, options.Number(min=0.5, max=600)),
    multiple=True,
    metavar="SENTENCE SECONDS",
    help="What happens next, and for how long; repeat for each step.",
)
@click.option(
    "--while",
    "meanwhile",
    type=(str, options.Number(min=0), options.Number(min=0)),
    multiple=True,
    metavar="SENTENCE START END",
    help="What happens at the same time, from START to END in seconds; can be repeated.",
)
@click.option("--name", help="Which time line of a file that holds several.")
@click.option("--after", metavar="CLIP", help="A motion that comes first: a file, or a clip of the library.")
@click.option(
    "--samples", type=options.Count(1, 20), default=1, show_default=True, help="Write so many different ones."
)
@click.option("--seed", type=options.Count(0, 2**31), default=0, show_default=True, help="Repeats a choice of samples.")
@click.option(
    "--transition",
    type=options.Number(0.1, 3),
    default=0.5,
    show_default=True,
    help="Seconds in which one piece goes over into the next; more where poses lie far apart.",
)
@click.option(
    "--rig",
    type=NEW_FILE,
    metavar="FILE",
    help="Write a .bvh on the skeleton of this file.",
)
@options.force
@options.filters_but_rig
@options.library
@options.as_json
def compose(
    timeline: Path | None,
    out: Path,
    steps: tuple[tuple[str, float], ...],
    meanwhile: tuple[tuple[str, float, float], ...],
    name: str | None,
    after: str | None,
    samples: int,
    seed: int,
    transition: float,
    rig: Path | None,
    force: bool,
    folder: str | None,
    as_json: bool,
    **filters: Any,
) -> None:
    """Compose a motion for TIMELINE out of the clips of the library.

    TIMELINE is a text file with a line 'sentence # start # end # body part # ...' for each sentence, in seconds, or a
    .json file; or the sentences are given by --then and --while. Sentences may overlap where they use different body
    parts: legs, spine, head, left arm, right arm; where none are given, the words tell them. A report lies beside OUT,
    with the clip and span that each sentence is shown by, and the credits of its source.

    \b
    Examples:
      motionseek compose --then "a person walks forward" 4 --then "sits down" 3 -o out.bvh
      motionseek compose --then "walks in a circle" 5 --while "raises the right hand" 1 3 -o out.glb
      motionseek compose scene.txt -o scene.bvh --rig my_character.bvh --samples 5
    """
    from search.cli import terminal
    from search.cli.progress import working
    from search.compose.report import WRITERS, document, write_composition
    from search.query.question import Question

    if out.suffix.lower() not in WRITERS:
        raise click.UsageError(f"{out}: unsupported format; use {', '.join(WRITERS)}")
    outs = [out if number == 1 else out.with_stem(f"{out.stem}-{number}") for number in range(1, samples + 1)]
    for path in outs:
        options.refuse_overwriting(path, force)
        options.refuse_overwriting(path.with_suffix(".json"), force)
    line = _timeline(timeline, name, steps, meanwhile)
    if line.moved >= _NOTICED:
        terminal.note(
            f"nothing happens before {line.moved:g} s; the motion begins there, and its times count from there"
        )
    with working("composing"), options.open_library(folder) as library:
        before = None if after is None else options.named_source(after, library)
        found = library.compose(line, samples=samples, seed=seed, after=before, transition=transition, **filters)
        for composition, path in zip(found, outs, strict=True):
            write_composition(composition, path, rig=rig)
        documents = [{"file": str(path)} | document(one) for one, path in zip(found, outs, strict=True)]
        sentences = list(dict.fromkeys(one.text for one in line.intervals))
        answers = {text: library.answer(Question((text,)), k=1, **filters) for text in sentences}
        bundle = library.bundle
    if as_json:
        terminal.document({"compositions": documents})
        return
    for composition, told in zip(found, documents, strict=True):
        _show(composition)
        worst = max((one["cm"] for one in told["transitions"]), default=0.0)
        figures = f"transitions of at most {worst:.1f} cm, feet slide in {told['sliding']:.0f} % of frames"
        print(f"{told['file']}: {told['duration']:.1f} s, {figures}")
    for text, hits in answers.items():
        if hits.nothing_matches:
            terminal.note(f"{text}: no good match; it is shown by what is nearest")
    terminal.remark(sentences, bundle)


def _timeline(
    path: Path | None,
    name: str | None,
    steps: tuple[tuple[str, float], ...],
    meanwhile: tuple[tuple[str, float, float], ...],
) -> Timeline:
    from search.compose.timeline import Interval, Timeline, read_timelines

    if path is None:
        if not steps:
            raise click.UsageError("give a TIMELINE, or sentences by --then")
        return Timeline.of_steps(steps, [Interval(text, start, end) for text, start, end in meanwhile])
    if steps or meanwhile:
        raise click.UsageError("a TIMELINE cannot be combined with --then and --while")
    lines = read_timelines(path)
    if name is not None:
        lines = [line for line in lines if line.name == name]
    if len(lines) != 1:
        found = "none of that name" if name is not None and not lines else f"{len(lines)} time lines"
        raise click.UsageError(f"{path} holds {found}; name one with --name, such as --name {_names(path)}")
    return lines[0]


def _names(path: Path) -> str:
    from search.compose.timeline import read_timelines

    return " or ".join([line.name for line in read_timelines(path)][:3])


def _show(composition: Composition) -> None:
    from search.cli import terminal

    rows = [
        (
            f"{one.interval.start:.1f}",
            f"{one.interval.end:.1f}",
            one.interval.text,
            f"{one.tmr_score:.3f}",
            one.candidate.source.path,
            f"{one.candidate.source.start + one.candidate.start:.1f}",
            f"{one.candidate.source.start + one.candidate.end:.1f}",
        )
        for one in composition.chosen
    ]
    numbers = ("start", "end", "score", "from", "to")
    terminal.table(("start", "end", "sentence", "score", "clip", "from", "to"), rows, right=numbers, below=("clip",))
