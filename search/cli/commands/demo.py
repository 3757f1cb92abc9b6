"""`motionseek demo`: a tour on real motion capture that is included in the package."""

from __future__ import annotations

import json
import shlex
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from search.cli import options
from search.cli.path_types import NEW_FOLDER

if TYPE_CHECKING:
    from search.hits import Hit
    from search.library import Library

#: The clips, and demo.json: {"questions": [sentence, ...], "moment": {"sentence": ..., "clip": path}}.
DATA = Path(__file__).parents[2] / "demo_data"


@click.command()
@click.argument("folder", required=False, type=NEW_FOLDER)
@options.force
@options.as_json
def demo(folder: Path | None, force: bool, as_json: bool) -> None:
    """Run a demo on real motion capture.

    Indexes a few clips, searches them, finds a moment in a long take, and draws images of the results. Everything is
    written to FOLDER, or to a new temporary folder.

    \b
    Examples:
      motionseek demo
      motionseek demo ~/motionseek-demo
    """
    from indexer.ingest import indexing
    from search.cli import terminal
    from search.cli.progress import progress_bar
    from search.library import Library

    if not (DATA / "demo.json").is_file():
        raise click.ClickException(f"the clips of the demo are missing from {DATA}; reinstall motionseek")
    place = Path(tempfile.mkdtemp(prefix="motionseek-demo-")) if folder is None else folder
    if folder is not None and folder.exists() and any(folder.iterdir()) and not force:
        raise click.ClickException(f"{folder} is not empty; use --force to write into it")
    script = json.loads((DATA / "demo.json").read_text("utf-8"))
    shutil.copytree(DATA, place, dirs_exist_ok=True, ignore=shutil.ignore_patterns("demo.json"))
    with progress_bar() as progress:
        summary = indexing.index(place, progress=progress)
    say = _silent if as_json else print
    say(f"Indexed {summary.indexed} clips of real motion capture in {summary.seconds:.1f} s: {place}\n")
    with Library.open(place) as library:
        report = _ask(library, script["questions"], place / "hits.png", say)
        report |= _locate(library, script["moment"], place / "moment.png", say)
    if as_json:
        terminal.document({"folder": str(place), "clips": summary.indexed} | report)
    program = shlex.quote("motionseek" if shutil.which("motionseek") else sys.argv[0])
    say(f"Watch, search, star and export them in a browser:  {program} serve {shlex.quote(str(place))} --edit --open")
    say(f'Index your own:  {program} index FOLDER   then, in FOLDER:  {program} search "..."')


def _silent(line: str) -> None:
    """Print nothing: the result is one JSON document."""


def _ask(library: Library, questions: list[str], picture: Path, say: Any) -> dict[str, Any]:
    """Search for sentences and draw the best three hits of each."""
    from search.cli import terminal
    from search.drawing.plots import plot_poses

    groups, answers = [], []
    for question in questions:
        found = library.search(question, 3)
        answers.append({"query": question, "hits": [hit.document() for hit in found]})
        say(f'$ motionseek search "{question}" -k 3')
        if say is print:
            terminal.hits(found, question, as_json=False)
            print()
        strips = [(_label(hit), library.motion(hit.clip_id, hit.start, hit.end)) for hit in found]
        groups.append((f"“{question}”", strips))
    plot_poses(picture, groups)
    say(f"The hits as poses: {picture}\n")
    return {"answers": answers, "hits_picture": str(picture)}


def _label(hit: Hit) -> str:
    return f"{hit.rank}.  {hit.path}  {hit.start:.1f}–{hit.end:.1f} s   {hit.score:.2f}  {hit.strength}"


def _locate(library: Library, moment: dict[str, str], picture: Path, say: Any) -> dict[str, Any]:
    """Find a sentence in a long take and draw similarity over time."""
    from search.cli import terminal
    from search.drawing.plots import plot_moments
    from search.moments.one_motion import moments_of
    from search.moments.queried_motion import QueriedMotion
    from search.query.question import Question

    source = library.source(moment["clip"])
    question = Question.of(moment["sentence"])
    motion = QueriedMotion(library.bundle, source, question.encode(library.bundle))
    found = moments_of(motion, 3)
    times, similarity = motion.curve()
    plot_moments(picture, question, source, found, times, similarity)
    say(f'$ motionseek moments "{question}" {source.path} -k 3 --plot moment.png')
    if say is print:
        terminal.moments(question, found, library, (times, similarity), as_json=False)
        print()
    say(f"Similarity over time: {picture}\n")
    return {"moment": {"query": str(question), "hits": [h.document() for h in found]}, "moment_picture": str(picture)}
