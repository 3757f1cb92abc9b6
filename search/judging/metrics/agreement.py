"""Whether motions show what their sentences say, by the vectors of an evaluator that reads both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.metrics import in_batches, ranks

#: Sentences of a batch of Guo's protocol, and the places that count.
BATCH, PLACES = 32, (1, 2, 3)


def tmr_scores(vectors: ArrayLike, others: ArrayLike) -> NDArray[np.float64]:
    """(1 + cosine) / 2 of each row with the row of the same place, (N,): TMR-score, 0..1, 0.5 is unrelated.

    Petrovich et al., "Multi-Track Timeline Control for Text-Driven 3D Human Motion Generation" (STMC, CVPRW 2024):
    motion-to-text with a motion's own sentence, motion-to-motion with its reference. SINC's TEMOS score is the cosine.

    Raises
    ------
    ValueError
        If there are not as many of one as of the other.
    """
    a, b = (np.asarray(rows, np.float64) for rows in (vectors, others))
    if a.shape != b.shape:
        raise ValueError(f"{a.shape} and {b.shape}: every motion needs its one counterpart")
    scale = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    return np.asarray(0.5 + 0.5 * (a * b).sum(1) / np.maximum(scale, 1e-12))


def multimodal_distance(motions: ArrayLike, texts: ArrayLike) -> float:
    """Mean Euclidean distance (MM-Dist) of motions (N, D) to their own sentences (N, D); Guo et al. (CVPR 2022)."""
    a, b = np.asarray(motions, np.float64), np.asarray(texts, np.float64)
    if a.shape != b.shape:
        raise ValueError(f"{a.shape} and {b.shape}: every motion needs its one sentence")
    return float(np.linalg.norm(a - b, axis=1).mean())


def batched_precision(motions: ArrayLike, texts: ArrayLike, seed: int) -> dict[int, float]:
    """R-precision: percent of motions (N, D) whose own sentence (N, D) is among the first k of 32, for k of `PLACES`.

    Guo et al. (CVPR 2022), and T2LM: one right sentence and 31 of other motions, ranked by distance; unit vectors
    rank alike by cosine. Motions are shuffled and the last incomplete batch dropped; ties take the mean of their
    places, as in `encoders.metrics`.

    Raises
    ------
    ValueError
        If there are fewer than 32 motions.
    """
    similarity = np.asarray(texts, np.float64) @ np.asarray(motions, np.float64).T
    found = in_batches(similarity, BATCH, seed)["motion->text"]
    return {k: found[f"R@{k}"] for k in PLACES}


def precision(motions: ArrayLike, vectors: ArrayLike, own: Sequence[int]) -> dict[int, float]:
    """Percent of motions (N, D) whose own sentence is among the first k of all sentences (S, D), for k of `PLACES`.

    STMC ranks the 60 sentences of its data set for each crop. `own` (N,) are rows of the sentences, each
    of which stands there once.
    """
    similarity = np.asarray(motions, np.float64) @ np.asarray(vectors, np.float64).T
    rank = ranks(similarity, np.arange(similarity.shape[1]) == np.asarray(own)[:, None])
    return {k: float(100 * np.mean(rank < k)) for k in PLACES}
