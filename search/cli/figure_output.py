"""Figures in the form that is asked for: a table, one JSON document, CSV, or rows of a LaTeX table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeVar

import click

from search.cli import terminal
from search.evaluate.row_formats import csv_text, latex_row

Form = Literal["table", "json", "csv", "latex"]
FORMS: tuple[Form, ...] = ("table", "json", "csv", "latex")
F = TypeVar("F", bound=Callable[..., Any])


def form_option(command: F) -> F:
    """Adds --format and --json."""
    command = click.option(
        "--format",
        "form",
        type=click.Choice(FORMS),
        default="table",
        show_default=True,
        help="How figures are printed.",
    )(command)
    return click.option("--json", "form", flag_value="json", help="The same as --format json.")(command)


def print_rows(columns: Sequence[str], rows: Sequence[Sequence[str]], document: Any, form: Form) -> None:
    """Print rows of cells under columns; `document` is what JSON gives instead, with all there is to say.

    LaTeX has the columns as a comment, and rows that can be pasted into a table.
    """
    if form == "json":
        terminal.document(document)
    elif form == "csv":
        print(csv_text(columns, rows), end="")
    elif form == "latex":
        print("% " + " & ".join(columns))
        print("".join(map(latex_row, rows)), end="")
    else:
        terminal.table(columns, rows, right=columns[1:])
