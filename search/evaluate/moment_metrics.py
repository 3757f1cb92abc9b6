"""Moment retrieval metrics: recall at IoU thresholds, mean IoU and mean average precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from search.spans import temporal_iou

Spans = Sequence[tuple[float, float]]

THRESHOLDS = tuple(round(0.1 * i, 1) for i in range(1, 10))


def best_overlaps(answers: Spans, truth: Spans) -> NDArray[np.float64]:
    """Intersection over union (N,) of each answer with its best true span; 0 where there is no true span."""
    starts, ends = np.array([a for a, _ in answers]), np.array([b for _, b in answers])
    overlaps = [np.zeros(len(answers)), *(temporal_iou(starts, ends, start, end) for start, end in truth)]
    return np.asarray(np.max(overlaps, axis=0), np.float64)


@dataclass
class Overlaps:
    """Overlaps of the ranked answers to every question with their best true spans."""

    rows: list[NDArray[np.float64]] = field(default_factory=list)

    def add(self, answers: Spans, truth: Spans) -> None:
        """Add the ranked answers to one question and all its true spans."""
        self.rows.append(best_overlaps(answers, truth))

    def recall(self, k: int, threshold: float) -> float:
        """Percent of questions with a right answer among the first k."""
        return 100 * float(np.mean([(row[:k] >= threshold).any() for row in self.rows]))

    def mean_iou(self) -> float:
        """Mean overlap of the first answer, in percent."""
        return 100 * float(np.mean([row[0] if len(row) else 0.0 for row in self.rows]))

    def mean_ap(self) -> float:
        """Mean over IoU 0.1 to 0.7 of the reciprocal rank of the first right answer, in percent.

        With one true span a question, average precision is that reciprocal rank.
        """
        values = []
        for threshold in THRESHOLDS[:7]:
            right = [row >= threshold for row in self.rows]
            values.append(np.mean([1 / (r.argmax() + 1) if r.any() else 0.0 for r in right]))
        return 100 * float(np.mean(values))

    def figures(self) -> dict[str, float]:
        """All figures by name; "accuracy at" a threshold is the recall of the first answer."""
        return {
            "questions": float(len(self.rows)),
            **{f"accuracy at {t}": self.recall(1, t) for t in THRESHOLDS},
            **{f"R@{k} at {t}": self.recall(k, t) for k in (5, 10) for t in (0.3, 0.5, 0.7)},
            "mean IoU": self.mean_iou(),
            "mAP 0.1 to 0.7": self.mean_ap(),
        }
