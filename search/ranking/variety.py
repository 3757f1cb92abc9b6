"""A varied choice of clips: each is far from those before it, so that the first few show what a library holds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Clips that the choice is made from, drawn at random; the varied part is at most so long.
_POOL, _MOST = 600, 200
#: The next clip is drawn from this part of those left that are farthest: outliers do not begin every choice.
_FAR = 0.05


def varied(vectors: NDArray[np.floating], seed: int) -> NDArray[np.int64]:
    """An order of clips whose every beginning, up to `_MOST`, is varied; another one for each seed.

    Farthest-point sampling (Gonzalez, 1985), but the next is drawn from the farthest twentieth.

    Parameters
    ----------
    vectors : array (N, D)
        Unit vectors.

    Returns
    -------
    int64 array (N,)
        Rows of `vectors`.
    """
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(vectors))
    pool = order[:_POOL]
    unit = vectors[pool].astype(np.float32)
    left = np.arange(len(pool))
    nearest = np.full(len(pool), -1, np.float32)  # the cosine similarity to the nearest chosen clip
    chosen: list[int] = []
    for draw in rng.random(min(len(pool), _MOST)):
        far = max(round(_FAR * len(left)), 1)
        pick = int(left[np.argpartition(nearest[left], far - 1)[int(draw * far)]])
        chosen.append(pick)
        left = left[left != pick]
        nearest = np.maximum(nearest, unit @ unit[pick])
    return np.concatenate([pool[np.array(chosen, np.int64)], pool[left], order[_POOL:]])
