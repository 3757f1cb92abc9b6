"""Whether a recogniser takes motions for the action they were asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from encoders.metrics import ranks

PLACES = (1, 5)


def accuracy(
    scores: ArrayLike, labels: Sequence[str], asked: Sequence[str], synonyms: Sequence[frozenset[str]] = ()
) -> dict[int, float]:
    """Percent of motions whose label is among the first k of a recogniser, for k of 1 and 5.

    Guo et al., "Action2Motion" (ACM MM 2020), and ACTOR (ICCV 2021); MultiAct (AAAI 2023) also counts the labels
    of a table of synonyms.

    Parameters
    ----------
    scores : array (N, L)
        Of each motion for each label, higher is likelier; ties take the mean of their places.
    labels : sequence of L strings
    asked : sequence of N strings
        The label each motion was generated for.
    synonyms : sets of labels that count for one another

    Raises
    ------
    ValueError
        If shapes do not fit, or a label asked for is none of the labels.
    """
    table = np.asarray(scores, np.float64)
    if table.shape != (len(asked), len(labels)):
        raise ValueError(f"scores {table.shape} must be ({len(asked)}, {len(labels)}): motions, labels")
    unknown = sorted(set(asked) - set(labels))
    if unknown:
        raise ValueError(f"{unknown[0]!r} is none of the {len(labels)} labels")
    also = {label: {label}.union(*(group for group in synonyms if label in group)) for label in set(asked)}
    right = np.array([[label in also[name] for label in labels] for name in asked])
    rank = ranks(table, right)
    return {k: float(100 * np.mean(rank < k)) for k in PLACES}
