"""Figures over repeats."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def mean_and_interval(values: Sequence[float]) -> tuple[float, float]:
    """The mean of repeats and the half-width of its 95 % interval, 1.96 standard errors; nan for a single repeat.

    As the papers report: 20 repeats in Action2Motion, ACTOR and MultiAct. Papers on prediction print the standard
    deviation over seeds instead. The deviation here is over N - 1.

    Raises
    ------
    ValueError
        If there is none.
    """
    if not len(values):
        raise ValueError("no repeat to average")
    if len(values) == 1:
        return float(values[0]), float("nan")
    return float(np.mean(values)), float(1.96 * np.std(values, ddof=1) / np.sqrt(len(values)))
