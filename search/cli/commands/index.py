"""`motionseek index`: motion files become a library."""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import click

from search.cli import options
from search.cli.path_types import FILE

if TYPE_CHECKING:
    from indexer.ingest.storing import Summary


#: Kinds of warnings about clips that are printed.
_KINDS = 20
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


@click.command()
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True)
@click.option(
    "--library", "library", type=click.Path(file_okay=False), help="Store the library here instead of in FOLDER."
)
@click.option("--jobs", type=options.Count(1, 256), help="Number of reading processes. [default: one per core]")
@click.option("--fps", type=options.Number(1, 10_000), help="Frame rate of files that state none or a wrong one.")
@click.option("--up", type=click.Choice(options.AXES), help="The axis that is up in the files, whatever they say.")
@click.option(
    "--joint-map",
    type=FILE,
    help='JSON file {"left_wrist": "joint of the rig", ...} for rigs that are not recognised.',
)
@click.option(
    "--rebuild", is_flag=True, help="Encode all clips again, from stored poses; with --model, with another model."
)
@options.model
@click.option("--retry", is_flag=True, help="Read files that failed before again.")
@click.option(
    "--vectors",
    metavar="milvus://HOST:PORT/NAME",
    help="Also keep a collection of Milvus in step, or a file of milvus-lite (NAME.db), for servers elsewhere.",
)
@click.option("--poses", metavar="PLACE", help="With --vectors: put the poses into a folder, or s3://... and the like.")
@click.option("--shard", metavar="I/N", help="Only the files of the I-th of N indexers of one archive.")
@click.option("--watch", is_flag=True, help="Go on: index again whenever a file in FOLDER changes, until Ctrl-C.")
@options.as_json
def index(
    folders: tuple[str, ...],
    library: str | None,
    jobs: int | None,
    fps: float | None,
    up: str | None,
    joint_map: Path | None,
    rebuild: bool,
    model: str | None,
    retry: bool,
    vectors: str | None,
    poses: str | None,
    shard: str | None,
    watch: bool,
    as_json: bool,
) -> int:
    """Index the motion files in FOLDER, or update its index.

    Subfolders are included; files that have not changed are skipped. Captions are read from a .txt file of the same
    name and from captions.csv, .tsv or .jsonl in FOLDER. A library keeps to the model it was made with. The exit code
    is 1 if a new or changed file could not be read; all others are indexed.

    \b
    Examples:
      motionseek index my_mocap/
      motionseek index shoot_a/ shoot_b/ --library team_library --jobs 8
      motionseek index old_rigs/ --joint-map names.json --retry
      motionseek index my_mocap/ --rebuild --model tmr-humanml3d
      motionseek index my_mocap/ --watch
      motionseek index archive/ --shard 2/8 --vectors milvus://10.0.0.5/mocap
    """
    from encoders.bundle.known_models import load_model
    from indexer.ingest import indexing
    from indexer.maintenance import watch as watching
    from search.cli import terminal
    from search.cli.locate import VARIABLE
    from search.cli.progress import progress_bar

    for folder in folders:
        if os.path.isfile(folder):
            described = f"motionseek describe {shlex.quote(folder)}"
            raise click.UsageError(f"{folder} is a file; index its folder, or run: {described}")
    if not any(map(os.path.isdir, folders)):
        raise click.UsageError(f"no folder {folders[0]}")
    _lower_priority()
    library = library or os.environ.get(VARIABLE)
    names = read_joint_map(joint_map) if joint_map else None
    encoder = None if model is None else load_model(model)

    def run(*, retry: bool, rebuild: bool) -> Summary:
        with progress_bar() as progress:
            summary = indexing.index(
                folders,
                library=library,
                bundle=encoder,
                jobs=jobs,
                fps=fps,
                up=up,
                joint_map=names,
                retry=retry,
                rebuild=rebuild,
                vectors=vectors,
                poses=poses,
                shard=shard,
                progress=progress,
            )
        if as_json:
            failed = [{"path": path, "reason": reason} for path, reason in summary.failed]
            terminal.document(asdict(summary) | {"failed": failed, "seconds": round(summary.seconds, 2)})
        else:
            report(summary, library or folders[0])
        sys.stdout.flush()
        return summary

    known = watching.seen(folders) if watch else b""
    summary = run(retry=retry, rebuild=rebuild)
    if watch and not summary.interrupted:
        return _watch(folders, known, lambda: run(retry=False, rebuild=False))
    return 130 if summary.interrupted else int(bool(summary.failed))


def _watch(folders: Sequence[str], known: bytes, run: Callable[[], Summary]) -> int:
    """Run again whenever a file has changed, until Ctrl-C; what ends a run is said, and the next change tries again."""
    from encoders.errors import MotionSeekError
    from indexer.maintenance import watch as watching
    from search.cli import terminal

    terminal.note("watching; press Ctrl-C to stop")
    try:
        for _ in watching.changes(folders, known):
            try:
                if run().interrupted:
                    break
            except MotionSeekError as error:
                terminal.note(str(error))
    except KeyboardInterrupt:
        pass
    return 0


def _lower_priority() -> None:
    """Lower the priority of this process, so that interactive programs and servers on the machine stay responsive."""
    if hasattr(os, "setpriority"):
        os.setpriority(os.PRIO_PROCESS, 0, max(10, os.getpriority(os.PRIO_PROCESS, 0)))


def read_joint_map(path: Path) -> dict[str, str]:
    """Read a joint map from a JSON file: target joint -> joint of the rig."""
    from indexer.argument_checks import checked_joint_map

    return checked_joint_map(options.read_object(path), str(path)) or {}


def grouped(warnings: Sequence[tuple[str, str]]) -> list[str]:
    """Warnings about clips as lines: one for all that differ in numbers only, and a count of those beyond some."""
    alike: dict[str, list[tuple[str, str]]] = {}
    for path, warning in warnings:
        alike.setdefault(_NUMBER.sub("0", warning), []).append((path, warning))
    lines = []
    for group in islice(alike.values(), _KINDS):
        path, warning = group[0]
        others = len(group) - 1
        more = f" (and {others} more like it)" if others else ""
        lines.append(f"{path}: {warning}{more}")
    if len(alike) > _KINDS:
        rest = sum(map(len, islice(alike.values(), _KINDS, None)))
        lines.append(f"{rest} other warnings; 'motionseek list --json' has those of every clip")
    return lines


def report(summary: Summary, place: str) -> None:
    """Print the summary of a run on stdout, failures and warnings on stderr; `place` names the library."""
    from search.cli import terminal

    for path, reason in summary.failed:
        terminal.note(f"failed: {path}: {reason}")
    for warning in summary.warnings + grouped(summary.reading_warnings):
        terminal.note(f"warning: {warning}")
    if summary.failed_before:
        files = "1 file" if summary.failed_before == 1 else f"{summary.failed_before} files"
        terminal.note(f"{files} failed before; to see why, run: motionseek status --failed {shlex.quote(place)}")
    if summary.interrupted:
        terminal.note("interrupted; run the command again to continue")
    counts = {
        "indexed": summary.indexed,
        "unchanged": summary.unchanged,
        "moved": summary.moved,
        "gone": summary.gone,
        "failed": len(summary.failed),
        "failed before": summary.failed_before,
        "clips sent": summary.sent,
        "clips withdrawn": summary.withdrawn,
    }
    nothing = "nothing indexed" if summary.interrupted else "no motion files found"
    said = ", ".join(f"{count} {name}" for name, count in counts.items() if count) or nothing
    print(f"{said} ({summary.seconds:.1f} s)")
