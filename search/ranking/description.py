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
    return Sentences(encoder, captions, vectors).nearest(encoder.encode_motions([motion])[0], k)


class Sentences:
    """The sentences to choose from: captions with their unit vectors (N, D), and the shipped vocabulary."""

    def __init__(
        self, encoder: Encoder, captions: Sequence[str] = (), vectors: NDArray[np.float32] | None = None
    ) -> None:
        self._encoder, self._texts = encoder, vocabulary()
        self._vectors = encoder.encode_texts(list(self._texts))
        if vectors is not None and len(captions):
            self._texts, self._vectors = (*captions, *self._texts), np.concatenate([vectors, self._vectors])

    def nearest(self, motion_vector: NDArray[np.float32], k: int) -> list[tuple[str, float]]:
        """The k sentences that fit the unit vector (D,) of a motion best; see `describe_motion`."""
        cosines = self._vectors @ motion_vector
        near = np.argsort(-cosines, kind="stable")[: max(_RERANKED, 10 * k)]
        scores = cosines[near] - hubness_penalty(self._encoder, self._vectors[near])
        best: dict[str, float] = {}
        for i in np.argsort(-scores, kind="stable"):
            best.setdefault(self._texts[near[i]], float(scores[i]))
            if len(best) == k:
                break
        return list(best.items())
