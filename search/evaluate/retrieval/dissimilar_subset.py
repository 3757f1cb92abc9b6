"""The dissimilar subset: items whose sentences are as far from one another as possible.

Section 4.1 of the TMR paper (Petrovich et al., ICCV 2023) takes 100 such pairs by an approximation of the quadratic
knapsack problem and publishes the lists, not the selection. Here the sum of all pairwise similarities is minimised,
greedily and then by exchanges until none is better. It is deterministic: among equals the earlier item is taken.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SIZE = 100
#: Sums of similarities that differ by less are equal.
_EQUAL = 1e-6


def dissimilar_subset(vectors: NDArray[np.floating], captions: Sequence[str], size: int = SIZE) -> NDArray[np.int64]:
    """Indices, in order, of `size` items whose sentences are least similar; of equal captions the first counts.

    Parameters
    ----------
    vectors : (N, E)
        Unit embeddings of the captions.
    captions : N sentences

    Returns
    -------
    int64 array (min(size, number of distinct captions),)
    """
    first = np.array(sorted({caption: i for i, caption in reversed(list(enumerate(captions)))}.values()), np.int64)
    if len(first) <= size or size < 2:
        return first[:size]
    similarity = (vectors[first] @ vectors[first].T).astype(np.float64)
    np.fill_diagonal(similarity, 0)
    return first[np.sort(_exchanged(similarity, _greedy(similarity, size)))]


def _greedy(similarity: NDArray[np.float64], size: int) -> NDArray[np.int64]:
    """The least similar pair, then one after the other what is least similar to all that are chosen."""
    apart = similarity + np.diag(np.full(len(similarity), np.inf))
    chosen = [int(i) for i in np.unravel_index(apart.argmin(), apart.shape)]
    to_chosen = similarity[chosen].sum(axis=0)
    to_chosen[chosen] = np.inf
    while len(chosen) < size:
        chosen.append(int(to_chosen.argmin()))
        to_chosen += similarity[chosen[-1]]
        to_chosen[chosen[-1]] = np.inf
    return np.array(chosen, np.int64)


def _exchanged(similarity: NDArray[np.float64], chosen: NDArray[np.int64]) -> NDArray[np.int64]:
    """Exchange one item for another, the best exchange first, until none makes the sum smaller."""
    chosen = np.sort(chosen)
    others = np.setdiff1d(np.arange(len(similarity)), chosen)
    while len(others):
        to_chosen = similarity[chosen].sum(axis=0)
        gain = to_chosen[chosen][:, None] - to_chosen[others][None] + similarity[np.ix_(chosen, others)]
        out, into = np.unravel_index(gain.argmax(), gain.shape)
        if gain[out, into] <= _EQUAL:
            break
        chosen[out], others[into] = others[into], chosen[out]
    return chosen
