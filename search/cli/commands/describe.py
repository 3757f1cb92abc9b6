"""`motionseek describe`: the sentences that match a motion."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from search.cli import options
from search.cli.path_types import NEW_FILE

if TYPE_CHECKING:
    from search.library import Library
    from search.ranking.description import Description

Described = tuple[str, list["Description"]]


@click.command()
@click.argument("ref", metavar="[CLIP]", required=False)
@click.option("--all", "every", is_flag=True, help="Describe all clips of the library, or those that pass the filters.")
@click.option(
    "-o",
    "--out",
    type=NEW_FILE,
    metavar="FILE.csv",
    help="Write what --all finds as a captions table.",
)
@options.force
@options.filters
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
    ref: str | None,
    every: bool,
    out: Path | None,
    force: bool,
    start: float | None,
    end: float | None,
    k: int,
    fps: float | None,
    up: str | None,
    model: str | None,
    folder: str | None,
    as_json: bool,
    **filters: Any,
) -> None:
    """Describe CLIP, or a span of it, in sentences; or with --all every clip, as first labels of an archive.

    CLIP is a file, or a clip of the library by path, name or number. The sentences are those of the built-in vocabulary
    and the captions of the library, if there is one.

    \b
    Examples:
      motionseek describe take_017.bvh
      motionseek describe long_take.bvh --start 12 --end 14.5 -k 3
      motionseek describe --all -o labels.csv -k 1 --uncaptioned
    """
    from search.query.filters import refuse_filters

    if every:
        if ref is not None or (start, end, fps, up, model) != (None,) * 5:
            raise click.UsageError("--all takes filters, and no CLIP, --start, --end, --fps, --up or --model")
        _describe_all(folder, k, out, force, as_json, filters)
        return
    if ref is None:
        raise click.UsageError("name a CLIP, or give --all")
    if out is not None:
        raise click.UsageError("-o needs --all")
    refuse_filters(filters)
    from search.cli import terminal
    from search.cli.progress import working
    from search.documents import description_document
    from search.hits import WEAK
    from search.ranking.description import describe_motion

    with (
        working("describing"),
        options.open_source(ref, folder, fps=fps, up=up, model=model) as (bundle, source, library),
    ):
        texts, _, vectors = library.caption_vectors() if library else ((), None, None)
        sentences = describe_motion(bundle, source.cut(start, end), k, texts, vectors)
        stale = source.stale() or None
    if as_json:
        terminal.document(description_document(source.path, sentences) | {"stale": stale})
    else:
        rows = [(f"{s.score:.3f}", s.text, s.strength) for s in sentences]
        terminal.table(("score", "sentence", "strength"), rows, right=("score",))
        if all(s.strength == WEAK for s in sentences):
            terminal.note("nothing that the model knows fits well; these are the nearest")


def _describe_all(
    folder: str | None, k: int, out: Path | None, force: bool, as_json: bool, filters: dict[str, Any]
) -> None:
    """Print or write the sentences of every clip that passes the filters."""
    from search.cli import terminal
    from search.documents import description_document
    from search.export.replacing import write_text

    if out is not None:
        options.refuse_overwriting(out, force)
    with options.open_library(folder) as library:
        found = list(_descriptions(library, k, filters))
        if not found:
            terminal.note(terminal.no_clips(library, filters))
    if out is not None:
        write_text(out, _table(found))
        terminal.note(f"wrote the sentences of {len(found)} {'clip' if len(found) == 1 else 'clips'} to {out}")
    elif as_json:
        terminal.document({"clips": [description_document(path, sentences) for path, sentences in found]})
    else:
        rows = [(path, f"{s.score:.3f}", s.text, s.strength) for path, sentences in found for s in sentences]
        terminal.table(("clip", "score", "sentence", "strength"), rows, right=("score",), below=("clip",))


def _descriptions(library: Library, k: int, filters: dict[str, Any]) -> Iterator[Described]:
    """The name of each clip, with its sentences, from the vectors that the library holds."""
    from indexer.vectors.library_indexes import CLIPS
    from search.cli.progress import progress_bar
    from search.ranking.description import Sentences

    with library.reading() as connection, progress_bar("clips") as progress:
        texts, _, vectors = library.caption_vectors()
        sentences = Sentences(library.bundle, texts, vectors)
        rows = library.indexes.current(CLIPS, connection).rows
        places = {clip_id: row for row, clip_id in enumerate(rows.owners.tolist())}
        clips = list(library.clips(**filters))
        for done, clip in enumerate(clips, start=1):
            vector = rows.vectors[places[clip.id]].astype("float32")
            yield library.reference(clip.root_name, clip.path), sentences.nearest(vector, k)
            progress(done, len(clips), clip.path)


def _table(found: list[Described]) -> str:
    """A captions table: what is right of it, or corrected, can be put into its folder as captions.csv."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("path", "text", "score", "strength"))
    writer.writerows((path, s.text, f"{s.score:.3f}", s.strength) for path, sentences in found for s in sentences)
    return text.getvalue()
