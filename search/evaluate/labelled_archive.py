"""Retrieval in a labelled archive: how well queries find the clips of their label, and clips the queries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.errors import QueryError
from encoders.metrics import average_precision
from encoders.protocol import Encoder
from indexer.datasets.labelled_clips import LabelledClips
from search.evaluate.gallery import Gallery
from search.query.encoding import encode_queries
from search.ranking.hubness import hubness_penalty


@dataclass(frozen=True)
class LabelReport:
    """Average precision of every query, by label.

    Attributes
    ----------
    precisions : {label: [average precision of each query]}
    clips : {label: number of clips}
    confusion : {label: {label: share of the first's clips whose nearest query is one of the second}}
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
        """Share of clips whose nearest query, among one of each label, is that of their own label."""
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


def evaluate_labels(archive: LabelledClips, encoder: Encoder) -> LabelReport:
    """Rank all labelled clips for each query of each label.

    Raises
    ------
    QueryError
        If no label has both clips and queries.
    """
    labels = np.array(archive.labels)
    queries = {label: texts for label, texts in archive.queries.items() if label in archive.labels}
    if not queries:
        raise QueryError("no readable clip has a label with a query; see docs/evaluation.md")
    gallery = Gallery(encoder, archive.motions)
    texts = [text for row in queries.values() for text in row]
    text_labels = [label for label, row in queries.items() for _ in row]
    precisions: dict[str, list[float]] = {label: [] for label in queries}
    for label, scores in zip(text_labels, gallery.scores(encode_queries(encoder, texts)), strict=True):
        precisions[label].append(average_precision(scores, labels == label))
    # Sentences for a motion are ranked as `describe` ranks them: without paraphrases, less their hubness.
    plain = encoder.encode_texts(texts)
    return LabelReport(
        precisions,
        {label: int((labels == label).sum()) for label in queries},
        _confusion(plain @ gallery.whole.T - hubness_penalty(encoder, plain)[:, None], text_labels, labels),
        archive.unreadable,
    )


def _confusion(
    similarity: NDArray[np.float32], text_labels: list[str], clip_labels: NDArray[np.str_]
) -> dict[str, dict[str, float]]:
    """Share of each label's clips by the label of their nearest query.

    The first queries of all labels compete with one another, then the second ones, and so on.
    """
    order = list(dict.fromkeys(text_labels))
    rows = {label: [i for i, other in enumerate(text_labels) if other == label] for label in order}
    nth = range(min(map(len, rows.values())))
    nearest = np.stack([similarity[[rows[label][n] for label in order]].argmax(axis=0) for n in nth])
    return {
        label: {other: float(np.mean(nearest[:, clip_labels == label] == column)) for column, other in enumerate(order)}
        for label in order
    }
