"""The four protocols of the TMR paper (Petrovich et al., ICCV 2023, section 4.1), in both directions, on two footings.

* all: the whole gallery.
* all with threshold: an item is also right whose sentence is more similar than 0.95 to that of the query, on the
  (1 + cosine) / 2 scale. Its rank counts ties as published: also with other right items.
* dissimilar subset: a gallery of 100 items whose sentences are far from one another.
* batches of 32: the mean over random galleries, seed 0, the incomplete last one dropped (Guo et al., CVPR 2022).

Footings: *strict*, only the query's own item is right, as TMR's code counts; *credit for duplicates*, every item with
the same caption is right, as MotionPatches' code counts (Yu et al., CVPR 2024), mirrored motions, too: their captions
are the same unless they name a side. The literature has tables of both; they must not be mixed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.metrics import batch_orders, ranks, recalls

THRESHOLD = 0.95
BATCH = 32
ALL, THRESHOLDED, DISSIMILAR, BATCHES = (
    "all",
    f"all with threshold {THRESHOLD}",
    "dissimilar subset",
    f"batches of {BATCH}",
)
STRICT, CREDIT, SIMILAR = "strict", "credit for duplicates", "similar captions"
WAYS = ("text->motion", "motion->text")

Similarity = NDArray[np.floating]
Right = NDArray[np.bool_]


@dataclass(frozen=True)
class RetrievalRow:
    """Figures of one protocol on one footing.

    Attributes
    ----------
    gallery : int
        Items in a gallery.
    figures : {direction: {"R@1", "R@2", "R@3", "R@5", "R@10" in percent, "MedR" from 1}}
    """

    protocol: str
    footing: str
    gallery: int
    figures: dict[str, dict[str, float]]


def evaluate_protocols(
    similarity: Similarity,
    captions: Sequence[str],
    *,
    sentence_similarity: Similarity | None = None,
    subset: NDArray[np.integer] | None = None,
    batched: Sequence[int] | None = None,
) -> Iterator[RetrievalRow]:
    """All rows that the arguments allow.

    Parameters
    ----------
    similarity : (N, N)
        Rows are the captions, columns the motions.
    captions : N sentences
        Those of the motions, in the same order.
    sentence_similarity : (N, N), optional
        Cosines of their sentence embeddings, for the threshold.
    subset : int array, optional
        The dissimilar subset.
    batched : sequence of N int, optional
        The order of the items before they are shuffled into batches: published TMR sorts their keys.

    Raises
    ------
    ValueError
        If shapes do not fit or a similarity is not finite.
    """
    same = np.array(captions)[:, None] == np.array(captions)[None, :]
    for footing, right in ((STRICT, None), (CREDIT, same)):
        yield RetrievalRow(ALL, footing, len(same), _both(similarity, right))
    if sentence_similarity is not None:
        similar = np.asarray(sentence_similarity > 2 * THRESHOLD - 1) | np.eye(len(same), dtype=bool)
        yield RetrievalRow(THRESHOLDED, SIMILAR, len(same), _both(similarity, similar, True))
    if subset is not None:
        few = np.ix_(subset, subset)
        for footing, right in ((STRICT, None), (CREDIT, same[few])):
            yield RetrievalRow(DISSIMILAR, footing, len(subset), _both(similarity[few], right))
    if len(same) >= BATCH:
        order = np.arange(len(same)) if batched is None else np.asarray(batched)
        batches = [order[batch] for batch in batch_orders(len(order), BATCH)]
        for footing in (STRICT, CREDIT):
            rows = [_both(similarity[np.ix_(b, b)], same[np.ix_(b, b)] if footing == CREDIT else None) for b in batches]
            yield RetrievalRow(BATCHES, footing, BATCH, _mean(rows))


def _both(similarity: Similarity, right: Right | None, right_ties: bool = False) -> dict[str, dict[str, float]]:
    there = recalls(ranks(similarity, right, right_ties=right_ties))
    back = recalls(ranks(similarity.T, None if right is None else right.T, right_ties=right_ties))
    return dict(zip(WAYS, (there, back), strict=True))


def _mean(rows: Sequence[dict[str, dict[str, float]]]) -> dict[str, dict[str, float]]:
    return {way: {key: float(np.mean([row[way][key] for row in rows])) for key in rows[0][way]} for way in WAYS}
