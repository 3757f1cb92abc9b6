"""Hubness penalty: what is subtracted from the scores of sentences that lie near every motion.

In a space of many dimensions a few sentences, the hubs, are neighbours of nearly everything and would describe every
motion. As in cross-domain similarity local scaling (CSLS; Conneau et al., ICLR 2018), a share of a sentence's mean
similarity to the motions nearest to it is subtracted; the bundle's unrelated motions stand for all. The ranking
of motions for one sentence does not change.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.protocol import Encoder, unrelated_motions

#: The published share is a half, which takes more from short plain sentences than is good on validation.
_NEAREST, _SHARE = 30, 0.35


def hubness_penalty(encoder: Encoder, sentences: ArrayLike) -> NDArray[np.float32]:
    """What to subtract from the scores of sentences (N, D): (N,), zero where there are no unrelated motions."""
    vectors = np.asarray(sentences, np.float32)
    motions = unrelated_motions(encoder)
    if motions is None:
        return np.zeros(len(vectors), np.float32)
    scores = vectors @ motions.T
    count = min(_NEAREST, scores.shape[1])
    nearest: NDArray[np.float32] = np.partition(scores, -count, axis=1)[:, -count:].mean(axis=1)
    return _SHARE * nearest
