"""Options that several commands share."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from encoders.protocol import Encoder
    from search.library import Library
    from search.source import MotionSource

F = TypeVar("F", bound=Callable[..., Any])

as_json = click.option("--json", "as_json", is_flag=True, help="Print one JSON document.")
force = click.option("--force", is_flag=True, help="Overwrite a file that exists.")
hits = click.option("-k", "k", type=click.IntRange(1, 10_000), default=10, show_default=True, help="At most so many.")
library = click.option(
    "--library",
    "folder",
    type=click.Path(exists=True, file_okay=False),
    help="The library; else MOTIONSEEK_LIBRARY, else the nearest .motionseek upward from here.",
)
start = click.option("--start", type=click.FloatRange(min=0), help="Begin at this second.")
fps = click.option(
    "--fps", type=click.FloatRange(1, 10_000), help="True frame rate of the file, over what it says or was indexed at."
)
end = click.option("--end", type=click.FloatRange(min=0), help="End at this second.")

_FILTERS = (
    click.option("--min-duration", type=click.FloatRange(min=0), help="Only clips of at least so many seconds."),
    click.option("--max-duration", type=click.FloatRange(min=0), help="Only clips of at most so many seconds."),
    click.option("--path", metavar="PATTERN", help="Only clips whose path matches, such as 'fights/*'."),
    click.option("--rig", metavar="NAME", help="Only clips of this rig."),
    click.option("--format", metavar="NAME", help="Only clips of this file format."),
    click.option("--captioned/--uncaptioned", default=None, help="Only clips with a caption, or without."),
)


def filters(command: F) -> F:
    """The options that choose which clips are asked."""
    for option in reversed(_FILTERS):
        command = option(command)
    return command


def open_library(folder: str | None) -> Library:
    """The library a command means, open."""
    from search.cli.locate import locate
    from search.library import Library

    return Library.open(locate(folder))


@contextmanager
def open_source(
    ref: str, folder: str | None, *, fps: float | None = None
) -> Iterator[tuple[Encoder, MotionSource, Library | None]]:
    """The model, the file or clip a command means, and the library; None where a file is asked about without one.

    Where no library is named or found from here upward, a file is asked about with the one it lies in.
    """
    from encoders.bundle.bundle import Bundle
    from encoders.errors import LibraryError
    from search.cli.locate import VARIABLE
    from search.source import find_source

    try:
        library = open_library(folder)
    except LibraryError:
        if (folder or os.environ.get(VARIABLE)) and not Path(ref).is_file():
            raise
        around = None if folder or os.environ.get(VARIABLE) else _library_around(Path(ref))
        if around is None:
            yield Bundle.load(), find_source(ref, None, fps=fps), None
            return
        library = around
    with library:
        yield library.bundle, find_source(ref, library, fps=fps), library


def _library_around(file: Path) -> Library | None:
    """The library that a file lies in, where it is one of the model at hand."""
    from encoders.errors import BundleMismatch, LibraryError
    from search.cli.locate import locate
    from search.library import Library

    if not file.is_file():
        return None
    try:
        library = Library.open(locate(start=file.absolute().parent))
    except LibraryError:
        return None
    try:
        library.bundle  # noqa: B018  raises where the library is of another model
    except BundleMismatch:
        library.close()
        return None
    return library


def read_object(path: Path) -> dict[str, Any]:
    """The JSON object that a file holds."""
    try:
        content = json.loads(path.read_text("utf-8-sig"))
    except (ValueError, OSError) as error:
        raise click.ClickException(f"{path} is no JSON file: {error}") from None
    if not isinstance(content, dict):
        raise click.ClickException(f'{path} must hold one JSON object, {{"name": value, ...}}')
    return content


def refuse_overwriting(path: Path, force: bool) -> None:
    """Stop before anything is done where a file would be lost."""
    if path.exists() and not force:
        raise click.ClickException(f"{path} exists; overwrite it with --force")
    if not path.absolute().parent.is_dir():
        raise click.ClickException(f"{path}: there is no folder {path.absolute().parent}; make it first")
