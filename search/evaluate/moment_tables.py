"""Figures of moments as Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from search.evaluate.card import table
from search.evaluate.moment_metrics import THRESHOLDS

Figures = Mapping[str, Mapping[str, float]]

_RANKED = [f"{name} at {t}" for name in ("accuracy", "R@5", "R@10") for t in (0.3, 0.5, 0.7)]


def moment_tables(figures: Figures) -> Iterator[str]:
    """The tables of one set of takes: first answers, recall, and steps in order, in percent."""
    ways = {name: row for name, row in figures.items() if "mean IoU" in row}
    first = [f"accuracy at {t}" for t in THRESHOLDS]
    shown = ["questions", *first, "mean IoU", "mAP 0.1 to 0.7"]
    yield _table("first answer, by IoU", [name.removeprefix("accuracy at ") for name in shown], shown, ways)
    several = {name: row for name, row in ways.items() if name.startswith("motionseek")}
    yield _table("recall", [name.replace("accuracy", "R@1") for name in _RANKED], _RANKED, several)
    ordered = {name: row for name, row in figures.items() if "mean IoU" not in row}
    for name, row in ordered.items():
        yield _table("", list(row), list(row), {name: row})


def _table(title: str, header: list[str], keys: list[str], rows: Figures) -> str:
    return table(
        (title, *header),
        [
            (name, *(f"{row[key]:.0f}" if key == "questions" else f"{row[key]:.1f}" for key in keys))
            for name, row in rows.items()
        ],
    )
