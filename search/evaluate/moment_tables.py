"""Figures of moment retrieval as tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from search.evaluate.markdown import markdown_table
from search.evaluate.moment_metrics import THRESHOLDS

Figures = Mapping[str, Mapping[str, float]]

_FIRST = ("questions", *(f"accuracy at {t}" for t in THRESHOLDS), "mean IoU", "mAP 0.1 to 0.7")
_RECALLS = tuple(f"{name} at {t}" for name in ("accuracy", "R@5", "R@10") for t in (0.3, 0.5, 0.7))


def moment_tables(figures: Figures) -> Iterator[str]:
    """The tables of one set of takes: first answers, recall, and steps in order, in percent."""
    methods = {name: row for name, row in figures.items() if "mean IoU" in row}
    yield _table("first answer, by IoU", [key.removeprefix("accuracy at ") for key in _FIRST], _FIRST, methods)
    ranked = {name: row for name, row in methods.items() if name.startswith("motionseek")}
    yield _table("recall", [key.replace("accuracy", "R@1") for key in _RECALLS], _RECALLS, ranked)
    for name, row in figures.items():
        if name not in methods:
            yield _table("", list(row), list(row), {name: row})


def _table(title: str, header: Sequence[str], keys: Sequence[str], figures: Figures) -> str:
    rows = [
        (name, *(f"{row[key]:.{0 if key == 'questions' else 1}f}" for key in keys)) for name, row in figures.items()
    ]
    return markdown_table((title, *header), rows)
