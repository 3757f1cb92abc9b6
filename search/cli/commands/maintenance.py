"""`motionseek check` and `forget`: whether a library holds what was written, mending it, and removing clips."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from search.cli import options

if TYPE_CHECKING:
    from indexer.maintenance.check import Fault


@click.command()
@click.argument("place", metavar="[FOLDER]", required=False, type=click.Path(exists=True, file_okay=False))
@click.option("--repair", is_flag=True, help="Mend what can be made again, from the poses or from the files.")
@click.option("--sources", is_flag=True, help="Also read every source file, and name those that have changed or gone.")
@click.option("--vectors", metavar="milvus://HOST:PORT/NAME", help="Also check the collection that the library fills.")
@click.option("--poses", metavar="PLACE", help="With --vectors --repair: where its poses are put.")
@click.option("--shard", metavar="I/N", help="With --vectors: the shard that the library was indexed as.")
@options.library
@options.as_json
def check(
    place: str | None,
    repair: bool,
    sources: bool,
    vectors: str | None,
    poses: str | None,
    shard: str | None,
    folder: str | None,
    as_json: bool,
) -> int:
    """Check the library of FOLDER: all that it holds against what was written.

    Without FOLDER, checks the nearest library here or in a parent folder. The exit code is 1 if anything is wrong, or
    with --repair if anything is left that cannot be mended.

    \b
    Examples:
      motionseek check my_mocap/
      motionseek check my_mocap/ --repair
      motionseek check my_mocap/ --repair --vectors milvus://10.0.0.5/mocap
    """
    from indexer.ingest.reencode import model_of
    from indexer.maintenance import check as checks
    from indexer.maintenance.repair import repair as mend
    from search.cli import terminal
    from search.cli.progress import progress_bar, working

    if vectors is None and (poses is not None or shard is not None):
        raise click.UsageError("--poses and --shard are for --vectors")
    library = options.library_of(place, folder)
    with working("checking"):
        found = checks.check(library, sources=sources)
    faults = list(found.faults)
    if repair:
        with progress_bar("clips") as progress:
            faults = mend(library, model_of(library, rebuild=True), progress=progress)
        if sources:
            with working("checking again"):
                faults += checks.check(library, sources=True).faults
    if vectors is not None:
        from indexer.maintenance.collection_check import check_collection

        with working("checking the collection"):
            there, left_there = check_collection(library, vectors, shard=shard, repair=repair, poses=poses)
        found.faults += there
        faults += left_there
    if as_json:
        terminal.document({"found": _records(found.faults), "left": _records(faults), "unchecked": found.unchecked})
        return int(bool(faults))
    named, left = set(found.faults), set(faults)
    for fault in found.faults:
        state = "" if not repair else " (cannot be mended)" if fault in left else " (mended)"
        terminal.note(f"{fault.what}: {fault.problem}{state}")
    for fault in faults:
        if fault not in named:
            terminal.note(f"{fault.what}: {fault.problem}")
    if found.unchecked:
        terminal.note(f"{found.unchecked} rows were written by an earlier version, without digests to compare")
    hint = "" if repair or not faults else "; motionseek check --repair mends what can be made again"
    print((f"{len(faults)} faults{' left' if repair else ''}" if faults else "nothing is wrong") + hint)
    return int(bool(faults))


@click.command()
@click.argument("clips", metavar="[CLIP]...", nargs=-1)
@click.option("--gone", is_flag=True, help="Forget all clips whose files have gone.")
@options.library
@options.as_json
def forget(clips: tuple[str, ...], gone: bool, folder: str | None, as_json: bool) -> None:
    """Remove CLIP from the library, with its poses, vectors and captions. No file is touched.

    CLIP is a path, a name or '#number', of a clip whose file has gone, too. A clip whose file is still there comes back
    when its folder is indexed again.

    \b
    Examples:
      motionseek forget old/take_003.bvh
      motionseek forget --gone
    """
    from indexer.maintenance import forget as forgetting
    from search.cli import terminal

    if not clips and not gone:
        raise click.UsageError("name a clip, or give --gone")
    forgotten = forgetting.forget(options.library_of(None, folder), clips, gone=gone)
    if as_json:
        terminal.document({"forgotten": forgotten})
        return
    for path in forgotten:
        terminal.note(f"forgotten: {path}")
    print(f"{len(forgotten)} forgotten")


def _records(faults: list[Fault]) -> list[dict[str, str]]:
    return [fault._asdict() for fault in faults]
