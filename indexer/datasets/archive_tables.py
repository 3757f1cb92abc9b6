"""Tables that describe an archive: its manifest, its labels, the queries for them."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from encoders.errors import QueryError
from encoders.motion import Motion
from indexer.ingest.load import load_motion

TableRow = dict[str, str]

_TAKE_COLUMNS = ("path", "trial", "kind", "fps_in_file", "fps_true")


def read_columns(path: Path, columns: Sequence[str], *, blank: bool = False) -> list[TableRow]:
    """Rows of a tab- or comma-separated table with a header line that has at least `columns`.

    Parameters
    ----------
    blank : bool
        Whether cells of these columns may be empty.

    Raises
    ------
    QueryError
        If the file cannot be read, has no row, or lacks a column or a cell.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise QueryError(f"{path}: cannot be read as a table ({reason.lower()}); see docs/evaluation.md") from error
    delimiter = "\t" if "\t" in text.split("\n", 1)[0] else ","
    rows = list(csv.DictReader(io.StringIO(text, newline=""), delimiter=delimiter))
    if not rows or not rows[0].keys() >= set(columns):
        raise QueryError(f"{path}: needs a header line with {', '.join(columns)} and at least one row")
    for number, row in enumerate(rows, 2):
        if any(row[column] is None or not (row[column] or blank) for column in columns):
            raise QueryError(f"{path}: row {number} lacks {' or '.join(columns)}")
    return rows


def read_manifest(folder: Path, columns: Sequence[str] = ()) -> list[TableRow]:
    """Rows of a folder's `manifest.tsv` with path, trial, kind, fps_in_file, fps_true and further `columns`.

    Raises
    ------
    QueryError
        See `read_columns`.
    """
    return read_columns(folder / "manifest.tsv", (*_TAKE_COLUMNS, *columns), blank=True)


def load_row(folder: Path, row: TableRow) -> Motion:
    """The motion of a row of a manifest, at its true frame rate where the row has one, else at that of the file.

    Raises
    ------
    UnreadableMotion
        If the file cannot be read.
    """
    rate = row["fps_true"] or row["fps_in_file"]
    return load_motion(folder / row["path"], fps=float(rate) if rate else None)
