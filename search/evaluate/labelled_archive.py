"""Score a model on an archive somebody has labelled: how well does a sentence find the clips of its label?"""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import MotionSeekError, QueryError
from encoders.metrics import average_precision
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.ingest.load import load_motion
from search.query.encoding import encode_queries
from search.ranking.hubness import hubness_penalty


@dataclass(frozen=True)
class LabelReport:
    """Average precision of every query, by label.

    Attributes
    ----------
    precisions : {label: [average precision of each query]}
    clips : {label: number of clips}
    confusion : {label: {label: share of the first's clips whose nearest sentence is one of the second}}
    unreadable : [(path, reason)]
    """

    precisions: dict[str, list[float]]
    clips: dict[str, int]
    confusion: dict[str, dict[str, float]]
    unreadable: list[tuple[str, str]]

    @property
    def mean(self) -> float:
        """Mean over labels and their queries."""
        return float(np.mean([p for row in self.precisions.values() for p in row]))

    @property
    def top1(self) -> float:
        """Share of clips whose own label's sentence is first among all labels'."""
        total = sum(self.clips.values())
        return sum(self.clips[label] * row[label] for label, row in self.confusion.items()) / total

    def as_dict(self) -> dict[str, object]:
        return {
            "mean_average_precision": self.mean,
            "motion_to_sentence_top1": self.top1,
            "labels": {
                label: {"clips": self.clips[label], "average_precision": float(np.mean(row)), "queries": row}
                for label, row in self.precisions.items()
            },
            "unreadable": [{"path": path, "reason": reason} for path, reason in self.unreadable],
        }


def read_table(path: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """Rows of a tab- or comma-separated table that has at least `columns`.

    Raises
    ------
    QueryError
        If the file cannot be read or lacks a column.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise QueryError(f"{path}: cannot be read as a table ({reason.lower()}); see docs/evaluation.md") from error
    rows = list(csv.DictReader(text.splitlines(), delimiter="\t" if "\t" in text.split("\n", 1)[0] else ","))
    missing = [c for c in columns if not rows or c not in rows[0]]
    if missing:
        raise QueryError(f"{path}: needs a header line with {', '.join(columns)} and at least one row")
    for number, row in enumerate(rows, 2):
        if not all(row[c] for c in columns):
            raise QueryError(f"{path}: row {number} lacks {' or '.join(columns)}")
    return rows


def evaluate_labels(
    folder: Path,
    labels: Path,
    queries: Path,
    bundle: Encoder,
    *,
    load: Callable[[Path], Motion] = load_motion,
) -> LabelReport:
    """Rank all of a folder's labelled clips for each query of each label.

    Parameters
    ----------
    folder : Path
        Where the clips lie.
    labels, queries : Path
        Tables with columns path, label and label, query; a relative path is looked for in `folder` first.

    Raises
    ------
    QueryError
        If a table is unusable, or no label has both clips and queries.
    """
    label_rows = read_table(_inside(folder, labels), ("path", "label"))
    query_rows = read_table(_inside(folder, queries), ("label", "query"))
    motions, names, unreadable = [], [], []
    for row in label_rows:
        try:
            motions.append(load(folder / row["path"]))
            names.append(row["label"])
        except MotionSeekError as error:
            unreadable.append((row["path"], str(error)))
    asked = [row for row in query_rows if row["label"] in names]
    if not asked:
        raise QueryError(f"{labels}: no readable clip has a label that {queries} asks for")
    gallery = bundle.encode_motions(motions)
    texts = [row["query"] for row in asked]
    similarity = encode_queries(bundle, texts) @ gallery.T
    # What is said of a motion is compared as `describe` does it: as it is, in no other phrasing.
    said = bundle.encode_texts(texts)
    told = said @ gallery.T - hubness_penalty(bundle, said)[:, None]
    clip_labels = np.array(names)
    precisions: dict[str, list[float]] = {}
    for row, scores in zip(asked, similarity, strict=True):
        precisions.setdefault(row["label"], []).append(average_precision(scores, clip_labels == row["label"]))
    return LabelReport(
        precisions,
        {label: int((clip_labels == label).sum()) for label in precisions},
        _confusion(told, [row["label"] for row in asked], clip_labels),
        unreadable,
    )


def _confusion(
    similarity: NDArray[np.float32], asked: list[str], clip_labels: NDArray[np.str_]
) -> dict[str, dict[str, float]]:
    """What the clips of each label are nearest to; the first sentences of all labels compete, the second ones, ..."""
    order = list(dict.fromkeys(asked))
    rows = {label: [i for i, a in enumerate(asked) if a == label] for label in order}
    rounds = range(min(map(len, rows.values())))
    nearest = np.stack([similarity[[rows[label][n] for label in order]].argmax(axis=0) for n in rounds])
    return {
        label: {other: float(np.mean(nearest[:, clip_labels == label] == column)) for column, other in enumerate(order)}
        for label in order
    }


def _inside(folder: Path, table: Path) -> Path:
    return folder / table if not table.is_absolute() and (folder / table).exists() else table
