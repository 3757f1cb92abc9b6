"""Sentences that fit a motion: the nearest of a library's captions and the shipped vocabulary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.motion import Motion
from encoders.protocol import Encoder
from search.query.vocabulary import vocabulary
from search.ranking.hubness import hubness_penalty

#: Number of sentences nearest to a motion that are reranked with the hubness penalty.
_RERANKED = 1000


def describe_motion(
    encoder: Encoder,
    motion: Motion,
    k: int,
    captions: Sequence[str] = (),
    vectors: NDArray[np.float32] | None = None,
) -> list[tuple[str, float]]:
    """The sentences that fit a motion best.

    Parameters
    ----------
    captions : sequence of str
        Captions to choose from beside the shipped vocabulary.
    vectors : float32 array (N, D)
        Their unit vectors.

    Returns
    -------
    list of (sentence, score), best first, no sentence twice
        The score is the cosine less the `hubness_penalty` of the sentence.
    """
    motion_vector = encoder.encode_motions([motion])[0]
    sentences = vocabulary()
    candidates = encoder.encode_texts(list(sentences))
    if vectors is not None and len(captions):
        sentences, candidates = (*captions, *sentences), np.concatenate([vectors, candidates])
    cosines = candidates @ motion_vector
    near = np.argsort(-cosines, kind="stable")[: max(_RERANKED, 10 * k)]
    scores = cosines[near] - hubness_penalty(encoder, candidates[near])
    best: dict[str, float] = {}
    for i in np.argsort(-scores, kind="stable"):
        best.setdefault(sentences[near[i]], float(scores[i]))
        if len(best) == k:
            break
    return list(best.items())
