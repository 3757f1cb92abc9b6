"""How well moments are found: ours beside the paper's way, on the same takes with the same model.

The answer is right at a threshold if its intersection over union with any true span reaches it. Figures are those of
the literature: accuracy of the first answer at IoU 0.1 to 0.9, recall of the first k, mean IoU, and mean average
precision over IoU 0.1 to 0.7. The ceiling is what the best window of the library's grid could reach.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from encoders.bundle import Bundle
from encoders.corpus.takes import MarkedTake
from indexer.windows import grid
from search.moments import localise
from search.moments_baseline import SIZES, best_of
from search.query import encode_queries
from search.spans import iou

Spans = Sequence[tuple[float, float]]

THRESHOLDS = tuple(round(0.1 * i, 1) for i in range(1, 10))
_ANSWERS = 10


@dataclass
class Overlaps:
    """For every question, how well each ranked answer overlaps its best true span."""

    rows: list[NDArray[np.float64]] = field(default_factory=list)

    def add(self, answers: Spans, truth: Spans) -> None:
        """One question's ranked answers against all its true spans."""
        starts, ends = np.array([a for a, _ in answers]), np.array([b for _, b in answers])
        self.rows.append(np.max([iou(starts, ends, start, end) for start, end in truth], axis=0))

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


def evaluate_moments(takes: Iterable[MarkedTake], bundle: Bundle) -> dict[str, dict[str, float]]:
    """Every marked sentence of every take is asked of its take.

    Returns
    -------
    dict
        Figures by way: "motionseek", the paper's "window of 20", "40", "60" frames and "best of the three", and the
        "ceiling of the grid".
    """
    ways: dict[str, Overlaps] = {}
    for take in takes:
        queries = encode_queries(bundle, [marked.sentence for marked in take.marked])
        features = bundle.features(take.motion)
        windows = _grid_spans(len(features), bundle.fps)
        slid = best_of(bundle, take.motion, queries)
        for marked, query, paper in zip(take.marked, queries, slid, strict=True):
            found = localise(bundle, features, bundle.fps, query[None], _ANSWERS)
            _add(ways, "motionseek", [(m.start, m.end) for m in found], marked.spans)
            for size in SIZES:
                _add(ways, f"window of {size}", [(paper[size].start, paper[size].end)], marked.spans)
            _add(ways, "best of the three", [(paper[0].start, paper[0].end)], marked.spans)
            best = max(range(len(windows)), key=lambda i: _overlap(windows[i], marked.spans))
            _add(ways, "ceiling of the grid", [windows[best]], marked.spans)
    return {name: figures(overlaps) for name, overlaps in ways.items()}


def figures(overlaps: Overlaps) -> dict[str, float]:
    """All figures of one way."""
    return {
        "questions": float(len(overlaps.rows)),
        **{f"accuracy at {t}": overlaps.recall(1, t) for t in THRESHOLDS},
        **{f"R@{k} at {t}": overlaps.recall(k, t) for k in (5, 10) for t in (0.3, 0.5, 0.7)},
        "mean IoU": overlaps.mean_iou(),
        "mAP 0.1 to 0.7": overlaps.mean_ap(),
    }


def _add(ways: dict[str, Overlaps], name: str, answers: Spans, truth: Spans) -> None:
    ways.setdefault(name, Overlaps()).add(answers, truth)


def _grid_spans(frames: int, fps: float) -> list[tuple[float, float]]:
    return [
        (float(start / fps), float((start + size) / fps))
        for starts, size in grid(frames, fps).values()
        for start in starts
    ]


def _overlap(span: tuple[float, float], truth: Spans) -> float:
    return max(float(iou([span[0]], [span[1]], start, end)[0]) for start, end in truth)
