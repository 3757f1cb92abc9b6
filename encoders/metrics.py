"""Retrieval metrics as pure functions of a similarity matrix.

The conventions are those of TMR's published evaluation (Petrovich et al., ICCV 2023): a rank is 0-based, and where
the right item ties with others it takes the mean of the tied places.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

RECALLS = (1, 2, 3, 5, 10)


def ranks(similarity: ArrayLike, right: ArrayLike | None = None, *, right_ties: bool = True) -> NDArray[np.float64]:
    """0-based rank of the best right item of each query.

    Parameters
    ----------
    similarity : array (Q, N)
        Higher is nearer.
    right : bool array (Q, N), optional
        Which items are right; the diagonal if not given.
    right_ties : bool
        Whether a tie with another right item takes places, as in TMR's published evaluation. Without, only ties with
        wrong items do.

    Returns
    -------
    float array (Q,)
        Half places where the best right item ties with others; NaN where no item is right.

    Raises
    ------
    ValueError
        If a shape does not fit or a right item has no finite similarity.
    """
    s = np.asarray(similarity, dtype=np.float64)
    if right is None:
        if s.ndim != 2 or s.shape[0] != s.shape[1]:
            raise ValueError(f"similarity.shape={s.shape} must be square when `right` is not given")
        best = np.diagonal(s).copy()
    else:
        mask = np.asarray(right, dtype=bool)
        if mask.shape != s.shape:
            raise ValueError(f"right.shape={mask.shape} must be similarity.shape={s.shape}")
        best = np.where(mask, s, -np.inf).max(axis=1, initial=-np.inf)
        best[~mask.any(axis=1)] = np.nan
    if right is None and not np.isfinite(best).all():
        raise ValueError("similarity of a right pair must be finite")
    above = (s > best[:, None]).sum(axis=1)
    tied = s == best[:, None]
    level = tied.sum(axis=1) if right is None or right_ties else 1 + (tied & ~mask).sum(axis=1)
    return np.where(np.isnan(best), np.nan, above + (level - 1) / 2)


def recalls(rank: ArrayLike, at: tuple[int, ...] = RECALLS) -> dict[str, float]:
    """R@k in percent and the median rank (1-based) of 0-based ranks; queries without a right item are left out."""
    r = np.asarray(rank, dtype=np.float64)
    r = r[~np.isnan(r)]
    if r.size == 0:
        raise ValueError("no query has a right item")
    figures = {f"R@{k}": float(100 * np.mean(r < k)) for k in at}
    return {**figures, "MedR": float(np.median(r) + 1)}


def text_motion(similarity: ArrayLike, right: ArrayLike | None = None) -> dict[str, dict[str, float]]:
    """Recalls of both directions; rows are sentences, columns motions."""
    s = np.asarray(similarity, dtype=np.float64)
    mask = None if right is None else np.asarray(right, dtype=bool)
    return {
        "text->motion": recalls(ranks(s, mask)),
        "motion->text": recalls(ranks(s.T, None if mask is None else mask.T)),
    }


def batch_orders(count: int, size: int = 32, seed: int = 0) -> list[NDArray[np.int64]]:
    """Random galleries of `size` of `count` items, as indices; the incomplete last one is dropped (Guo's protocol)."""
    order = np.arange(count)
    np.random.RandomState(seed).shuffle(order)
    return [order[i : i + size] for i in range(0, count - size + 1, size)]


def in_batches(similarity: ArrayLike, size: int = 32, seed: int = 0) -> dict[str, dict[str, float]]:
    """`text_motion` averaged over random galleries of `size`, see `batch_orders`."""
    s = np.asarray(similarity, dtype=np.float64)
    if len(s) < size:
        raise ValueError(f"{len(s)} pairs are fewer than one batch of {size}")
    rows = [text_motion(s[np.ix_(b, b)]) for b in batch_orders(len(s), size, seed)]
    return {
        way: {key: float(np.mean([row[way][key] for row in rows])) for key in rows[0][way]}
        for way in ("text->motion", "motion->text")
    }


def average_precision(scores: ArrayLike, right: ArrayLike) -> float:
    """Average precision of one ranking: the mean, over right items, of the precision at their place.

    Ties are broken against us: among equal scores wrong items come first.
    """
    s, r = np.asarray(scores, dtype=np.float64), np.asarray(right, dtype=bool)
    if s.shape != r.shape or s.ndim != 1:
        raise ValueError(f"scores.shape={s.shape} and right.shape={r.shape} must be equal and flat")
    if not r.any():
        raise ValueError("no item is right")
    order = np.lexsort((r, -s))
    hits = r[order]
    return float((np.cumsum(hits)[hits] / (np.flatnonzero(hits) + 1)).mean())
