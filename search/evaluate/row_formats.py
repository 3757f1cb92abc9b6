"""Rows of cells as CSV, and as rows of a LaTeX table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

_LATEX = str.maketrans(
    {
        "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "±": r"$\pm$",
        **{sign: f"\\{sign}" for sign in "&%$#_{}"},
    }
)  # fmt: skip


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A header line and a line for each row."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([columns, *rows])
    return out.getvalue()


def latex_row(cells: Iterable[str]) -> str:
    """A row that can be pasted into a table, its signs escaped; one line."""
    return " & ".join(cell.translate(_LATEX) for cell in cells) + " \\\\\n"
