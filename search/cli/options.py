"""Options that several commands share."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from search.cli.path_types import NEW_FOLDER
from search.cli.piped import read_clips

if TYPE_CHECKING:
    from encoders.protocol import Encoder
    from search.hits import Hits
    from search.library import Library
    from search.source import MotionSource

F = TypeVar("F", bound=Callable[..., Any])


class Number(click.FloatRange):
    """A finite number in a range."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is no finite number", param, ctx)
        return number


class Count(click.IntRange):
    """A whole number in a range."""

    name = "whole number"


as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON document.")
force = click.option("--force", is_flag=True, help="Overwrite an existing file.")
hits = click.option(
    "-k",
    "k",
    metavar="N",
    type=Count(1, 10_000),
    default=10,
    show_default=True,
    help="Maximum number of hits.",
)


def min_strength(command: F) -> F:
    """Adds the options that say how strong a hit must be, as the one argument `min_strength`."""
    all_of_them = click.option(
        "--all", "min_strength", flag_value="weak", help="List weak hits, too, where the first is better."
    )
    least = click.option(
        "--min-strength",
        "min_strength",
        type=click.Choice(["weak", "plausible", "strong"]),
        help="The least strength of a hit. [default: plausible where the first hit is, else weak]",
    )
    return least(all_of_them(command))


class LibraryPlace(click.Path):
    """A folder that exists, or the address of a collection of Milvus."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from indexer.vectors.milvus.milvus_address import is_milvus_address

        return value if is_milvus_address(value) else super().convert(value, param, ctx)


library = click.option(
    "--library",
    "folder",
    metavar="PLACE",
    type=LibraryPlace(exists=True, file_okay=False),
    help="Library folder, or milvus://HOST:PORT/NAME. "
    "[default: MOTIONSEEK_LIBRARY, or the nearest .motionseek here or in a parent folder]",
)
export = click.option(
    "--export",
    "export_folder",
    type=NEW_FOLDER,
    metavar="DIR",
    help="Write all hits as files into DIR, with a table (hits.csv) and the sources' credits.",
)
export_as = click.option(
    "--as",
    "export_format",
    type=click.Choice(["bvh", "glb", "npz", "npy"]),
    default="bvh",
    show_default=True,
    help="Format of the files of --export; .bvh keeps the rig of a source that has one.",
)
start = click.option("--start", type=Number(min=0), help="Start of the span in seconds.")
fps = click.option(
    "--fps",
    type=Number(1, 10_000),
    help="Frame rate of the file, overriding the one it states or was indexed with.",
)
model = click.option(
    "--model", "model", metavar="NAME", help="A model by its name ('motionseek model list'), or a bundle's folder."
)
file_model = click.option(
    "--model", "model", metavar="NAME", help="Read a file by itself, without a library, with another model."
)
AXES = ("x", "y", "z", "-x", "-y", "-z")
up = click.option("--up", type=click.Choice(AXES), help="The axis of the file that is up, whatever it says.")
end = click.option("--end", type=Number(min=0), help="End of the span in seconds.")

_BY_RIG = click.option("--rig", metavar="NAME", help="Only clips with this rig.")
_FILTERS = (
    click.option("--min-duration", type=Number(min=0), metavar="S", help="Only clips of at least S seconds."),
    click.option("--max-duration", type=Number(min=0), metavar="S", help="Only clips of at most S seconds."),
    click.option("--path", metavar="PATTERN", help="Only clips whose path matches a glob, such as 'fights/*'."),
    _BY_RIG,
    click.option("--format", metavar="NAME", help="Only clips of this file format."),
    click.option("--captioned/--uncaptioned", default=None, help="Only clips with captions, or without."),
    click.option("--split", metavar="NAME", help="Only clips of a data set's split, such as 'test'."),
    click.option("--starred/--unstarred", default=None, help="Only clips with a star, or without."),
    click.option("--tag", metavar="NAME", help="Only clips with this tag."),
    click.option("--collection", metavar="NAME", help="Only clips of this collection."),
    click.option(
        "--clips",
        metavar="FILE",
        callback=read_clips,
        help="Only the clips that FILE names, one a line or as JSON; '-' for what another command pipes in.",
    ),
)


def filters(command: F) -> F:
    """Adds the options that filter clips."""
    return _with(command, _FILTERS)


def filters_but_rig(command: F) -> F:
    """Adds them to a command whose --rig names a file."""
    return _with(command, [option for option in _FILTERS if option is not _BY_RIG])


def _with(command: F, added: Sequence[Callable[[F], F]]) -> F:
    for option in reversed(added):
        command = option(command)
    return command


def one_of(place: str | None, folder: str | None) -> str | None:
    """What is given as FOLDER or by --library, which cannot be combined."""
    if place is not None and folder is not None:
        raise click.UsageError("FOLDER and --library cannot be combined")
    return place or folder


def library_of(place: str | None, folder: str | None) -> Path:
    """The library folder of a command that takes FOLDER or --library; see `search.cli.locate.locate`.

    Raises
    ------
    LibraryNotFound
        If there is none.
    """
    from encoders.errors import LibraryNotFound
    from indexer.store.library_reader import library_folder
    from search.cli.locate import locate

    given = locate(one_of(place, folder))
    if isinstance(given, str):
        raise LibraryNotFound(f"{given}: this needs a library in a folder; a collection has only what it puts there")
    found = library_folder(given)
    if found is None:
        raise LibraryNotFound(f"{given}: no library here; make one with 'motionseek index {given}'")
    return found.resolve()


def open_library(folder: str | None) -> Library:
    """Open the library of a command; see `search.cli.locate.locate`."""
    from search.cli.locate import locate, poses_of
    from search.places import open_library as opened

    place = locate(folder)
    return opened(place, poses=poses_of(place))


def names_clip(text: str, folder: str | None) -> bool:
    """Whether an argument means a motion: a file, what looks like a file or a number, or a clip of the library."""
    from encoders.errors import LibraryError
    from indexer.formats.opening import is_file
    from indexer.formats.table import READABLE

    if is_file(Path(text)) or text.startswith("#") or Path(text).suffix.lower() in READABLE:
        return True
    try:
        with open_library(folder) as library:
            return bool(library.matches(text))
    except LibraryError:
        return False


@contextmanager
def open_source(
    ref: str,
    folder: str | None,
    *,
    fps: float | None = None,
    up: str | None = None,
    model: str | None = None,
    tell: bool = True,
) -> Iterator[tuple[Encoder, MotionSource, Library | None]]:
    """The model, the motion that `ref` names, and the library, None for a file without one.

    Where no library is given or found, that of the folder that holds the file is used; none where a model is named.
    What became of the file of a clip is said, if `tell`; see `named_source`.
    """
    from encoders.bundle.known_models import load_model
    from encoders.errors import LibraryError
    from indexer.formats.opening import is_file
    from search.cli.locate import VARIABLE
    from search.references import find_source

    if model is not None:
        if folder:
            raise click.UsageError("--model and --library cannot be combined: a library keeps to its own model")
        yield load_model(model), find_source(ref, None, fps=fps, up=up), None
        return
    try:
        library = open_library(folder)
    except LibraryError:
        if (folder or os.environ.get(VARIABLE)) and not is_file(Path(ref)):
            raise
        around = None if folder or os.environ.get(VARIABLE) else _library_around(Path(ref))
        if around is None:
            yield load_model(), find_source(ref, None, fps=fps, up=up), None
            return
        library = around
    with library:
        yield library.bundle, named_source(ref, library, fps=fps, up=up, tell=tell), library


def named_source(
    ref: str, library: Library, *, fps: float | None = None, up: str | None = None, tell: bool = True
) -> MotionSource:
    """The motion that `ref` names; if `tell`, it is said where that is stored and its file has changed or is gone."""
    from search.cli import terminal

    source = library.source(ref, fps=fps, up=up)
    if tell:
        terminal.stale({library.reference(source.root, source.path): source.stale()})
    return source


def _library_around(file: Path) -> Library | None:
    """The library of the folder that holds a file; None where there is none or it was made with another model."""
    from encoders.errors import BundleMismatch, LibraryError
    from indexer.formats.opening import is_file
    from search.cli.locate import locate
    from search.library import Library

    if not is_file(file):
        return None
    try:
        library = Library.open(locate(start=file.absolute().parent))
    except LibraryError:
        return None
    try:
        library.bundle  # noqa: B018  raises BundleMismatch
    except BundleMismatch:
        library.close()
        return None
    return library


def read_object(path: Path) -> dict[str, Any]:
    """Read a file that holds one JSON object."""
    try:
        content = json.loads(path.read_text("utf-8-sig"))
    except (ValueError, OSError) as error:
        raise click.ClickException(f"{path}: invalid JSON: {error}") from None
    if not isinstance(content, dict):
        raise click.ClickException(f'{path}: expected one JSON object, {{"name": value, ...}}')
    return content


def refuse_export(folder: Path | None, force: bool) -> None:
    """Raise where --export would overwrite an earlier one, before any work is done."""
    if folder is not None and (folder / "hits.csv").exists() and not force:
        raise click.ClickException(f"{folder / 'hits.csv'} exists; name another folder, or use --force to overwrite")


def export_hits(
    hits: Hits,
    folder: Path | None,
    format: str,
    *,
    library: Library | None = None,
    fps: float | None = None,
    up: str | None = None,
    force: bool = False,
) -> None:
    """Write all hits into the folder of --export, if one is given."""
    if folder is None:
        return
    from search.export.hit_files import export_hits as write

    files = write(hits, folder, format, library=library, fps=fps, up=up, overwrite=force)
    click.echo(f"wrote {len(files)} {'file' if len(files) == 1 else 'files'} and hits.csv into {folder}", err=True)


def refuse_overwriting(path: Path, force: bool) -> None:
    """Raise where an existing file would be overwritten, before any work is done."""
    if path.exists() and not force:
        raise click.ClickException(f"{path} exists; use --force to overwrite it")
    if not path.absolute().parent.is_dir():
        raise click.ClickException(f"{path}: no folder {path.absolute().parent}; create it first")
