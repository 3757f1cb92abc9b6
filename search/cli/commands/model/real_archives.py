"""The options that name real archives with known answers, on which strength is calibrated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from search.cli.path_types import FILE, FOLDER

if TYPE_CHECKING:
    from indexer.datasets.questioned_archives import QuestionedArchive

_Command = TypeVar("_Command", bound=Callable[..., Any])


def real_archives(command: _Command) -> _Command:
    """Add --real, --captions and --labelled."""
    for option in (
        click.option("--labelled", type=FOLDER, help="Folder with labels.tsv and queries.tsv, to calibrate on."),
        click.option("--captions", type=FILE, help="Their captions, JSON lines."),
        click.option("--real", type=FOLDER, help="Folder of captioned takes, to calibrate on its split val."),
    ):
        command = option(command)
    return command


def read_archives(real: Path | None, captions: Path | None, labelled: Path | None) -> list[QuestionedArchive]:
    """The archives that were named.

    Raises
    ------
    UsageError
        If there are takes without captions, or captions without takes.
    QueryError
        If one cannot be read.
    """
    from indexer.datasets.captioned_takes import captioned_takes
    from indexer.datasets.questioned_archives import questioned_labels, questioned_takes

    require_both(real, captions)
    found = [questioned_labels(labelled)] if labelled else []
    if real and captions:
        found.append(questioned_takes(list(captioned_takes(real, captions, "val"))))
    return found


def require_both(real: Path | None, captions: object | None) -> None:
    """Exit where only one of two options is given that need each other."""
    if (real is None) != (captions is None):
        raise click.UsageError("--real and --captions must be given together")
