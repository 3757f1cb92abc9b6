"""A judgement as rows of cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from search.judging.figure_kinds import FIGURES
from search.judging.judgement import Judgement, Measured
from search.judging.metrics.scopes import WINDOW

#: Columns of `figure_rows`; the last two only where there are real motions.
COLUMNS = ("figure", "better", "generated", "real")


def figure_rows(judgement: Judgement) -> tuple[list[str], list[list[str]]]:
    """Columns, and a row for each figure: name with unit, the way it should go, generated and real motions."""
    rows = []
    for name, figure in judgement.generated.items():
        kind = FIGURES[name]
        title = f"{kind.name} ({kind.unit})" if kind.unit else kind.name
        rows.append([title, kind.aim, shown(figure), shown(judgement.real.get(name))])
    return list(COLUMNS), rows


def csv_rows(judgement: Judgement) -> tuple[list[str], list[list[str]]]:
    """The same with all digits, a column for each number, and sources."""
    columns = ["figure", "unit", "better", "generated", "interval", "real", "real interval", "evaluator", "source"]
    rows = []
    for name, figure in judgement.generated.items():
        kind, real = FIGURES[name], judgement.real.get(name)
        numbers = [digits for one in (figure, real) for digits in _exact(one)]
        rows.append([kind.name, kind.unit, kind.aim, *numbers, judgement.evaluator, kind.source])
    return columns, rows


def latex_rows(judgement: Judgement) -> tuple[list[str], list[list[str]]]:
    """A column for each figure and a row for each kind of motion, as tables of papers have them."""
    columns = ["", *(FIGURES[name].name for name in judgement.generated)]
    rows = [["generated", *(shown(figure) for figure in judgement.generated.values())]]
    if judgement.real:
        rows.insert(0, ["real", *(shown(judgement.real.get(name)) for name in judgement.generated)])
    return columns, rows


def remarks(judgement: Judgement) -> list[str]:
    """What a reader must know beside the figures: the evaluator, and what is missing for which reason."""
    lines = [f"{judgement.motions} motions, {judgement.references} references; evaluator {judgement.evaluator}"]
    reasons: dict[str, list[str]] = {}
    for name, reason in judgement.missing.items():
        reasons.setdefault(reason, []).append(FIGURES[name].name)
    lines += [f"left out ({reason}): {', '.join(names)}" for reason, names in reasons.items()]
    if judgement.short and "sliding_diversity" in judgement.generated:
        some = ", ".join(judgement.short[:3]) + (", ..." if len(judgement.short) > 3 else "")
        lines.append(f"without a window of {WINDOW} frames: {len(judgement.short)} shorter motions ({some})")
    if not judgement.references:
        lines.append("no row of real motions: give some with --references")
    return lines


def shown(figure: Measured | None) -> str:
    """A figure in three places after the first digit that counts, with its interval."""
    if figure is None:
        return ""
    number = _rounded(figure.value)
    return number if np.isnan(figure.interval) else f"{number} ± {_rounded(figure.interval)}"


def _rounded(value: float) -> str:
    return f"{value:.1f}" if abs(value) >= 100 else f"{value:.2f}" if abs(value) >= 10 else f"{value:.3f}"


def _exact(figure: Measured | None) -> Sequence[str]:
    if figure is None:
        return ("", "")
    return (f"{figure.value:.6g}", "" if np.isnan(figure.interval) else f"{figure.interval:.3g}")
