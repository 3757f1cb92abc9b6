"""A report on retrieval as lines: a table, CSV, and rows of LaTeX, two decimals as in the papers."""

from __future__ import annotations

from collections.abc import Iterator

from search.evaluate.retrieval.dataset_retrieval import RetrievalReport
from search.evaluate.retrieval.protocols import WAYS
from search.evaluate.row_formats import csv_text, latex_row

FIGURES = ("R@1", "R@2", "R@3", "R@5", "R@10", "MedR")
COLUMNS = ("protocol", "footing", "gallery", "direction", *FIGURES)
_CONTEXT = ("model", "dataset", "split", "sentence_similarity", "dissimilar_subset")


def table_rows(report: RetrievalReport) -> Iterator[tuple[str, ...]]:
    """One row for each protocol, footing and direction, under `COLUMNS`."""
    for row in report.rows:
        for way in WAYS:
            figures = (f"{row.figures[way][name]:.2f}" for name in FIGURES)
            yield row.protocol, row.footing, str(row.gallery), way, *figures


def summary(report: RetrievalReport) -> list[str]:
    """What the figures rest on, in lines."""
    lines = [f"{report.model} on {report.dataset}, split {report.split}"]
    if report.sentence_model:
        lines.append(f"sentence similarity: {report.sentence_model}")
    else:
        lines.append("no sentence similarity: no protocol with threshold, no selected subset; see --sentence-model")
    if report.subset:
        lines.append(f"dissimilar subset: {report.subset}")
    return lines


def as_csv(report: RetrievalReport) -> str:
    """The table with a header line; every line names model, data set, split and where its figures come from."""
    values = report.as_dict()
    context = [values[name] or "" for name in _CONTEXT]
    return csv_text((*_CONTEXT, *COLUMNS), ((*context, *row) for row in table_rows(report)))


def as_latex(report: RetrievalReport) -> str:
    """For each protocol and footing a comment and a row: the model, six figures text to motion, six back."""
    lines = [f"% {line}" for line in summary(report)]
    lines.append(f"% model & {' & '.join(FIGURES)} (text to motion) & the same (motion to text)")
    for row in report.rows:
        figures = (f"{row.figures[way][name]:.2f}" for way in WAYS for name in FIGURES)
        lines.append(f"% {row.protocol}, {row.footing}, gallery {row.gallery}")
        lines.append(latex_row([report.model, *figures]).rstrip())
    return "\n".join(lines) + "\n"
