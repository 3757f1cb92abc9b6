"""Sentences that lie near every motion, and how to see past them.

In a space of many dimensions a few sentences are neighbours of nearly everything; asked what a motion shows, they would
come first again and again. As in cross-domain similarity local scaling (Conneau et al., ICLR 2018), a share of what a
sentence scores with the motions nearest to it is taken from its score; the bundle's unrelated motions stand for all.
A ranking of motions for one sentence does not change by it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.protocol import Encoder

#: The published share is a half, which takes more from short plain sentences than is good on validation.
_NEAREST, _SHARE = 30, 0.35


def hubness_penalty(bundle: Encoder, sentences: ArrayLike) -> NDArray[np.float32]:
    """What to take from the scores of sentences (N, D): (N,), zero where the bundle carries no unrelated motions."""
    vectors = np.asarray(sentences, np.float32)
    if bundle.calibration is None:
        return np.zeros(len(vectors), np.float32)
    scores = vectors @ np.asarray(bundle.calibration["motions"], np.float32).T
    count = min(_NEAREST, scores.shape[1])
    nearest: NDArray[np.float32] = np.partition(scores, -count, axis=1)[:, -count:].mean(axis=1)
    return _SHARE * nearest
