"""Labelled clips of a folder, and the queries for each label."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from encoders.errors import MotionSeekError
from encoders.motion import Motion
from indexer.datasets.archive_tables import read_columns
from indexer.ingest.load import load_motion


@dataclass(frozen=True)
class LabelledClips:
    """The readable clips of a folder with their labels.

    Attributes
    ----------
    motions, labels : lists of N
    queries : {label: its queries}
    unreadable : [(path, reason)]
    """

    motions: list[Motion]
    labels: list[str]
    queries: dict[str, list[str]]
    unreadable: list[tuple[str, str]]


def labelled_clips(
    folder: Path, labels: Path = Path("labels.tsv"), queries: Path = Path("queries.tsv")
) -> LabelledClips:
    """Read all labelled clips of a folder.

    Parameters
    ----------
    labels, queries : Path
        Tables with columns path, label and label, query; a relative path is looked for in `folder` first.

    Raises
    ------
    QueryError
        If a table is unusable.
    """
    found = LabelledClips([], [], {}, [])
    rows = read_columns(_inside(folder, labels), ("path", "label"))
    for row in read_columns(_inside(folder, queries), ("label", "query")):
        found.queries.setdefault(row["label"], []).append(row["query"])
    for row in rows:
        try:
            found.motions.append(load_motion(folder / row["path"]))
            found.labels.append(row["label"])
        except MotionSeekError as error:
            found.unreadable.append((row["path"], str(error)))
    return found


def _inside(folder: Path, table: Path) -> Path:
    return folder / table if not table.is_absolute() and (folder / table).exists() else table
