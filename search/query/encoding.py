"""Query vectors: each the mean of the vectors of a sentence and its paraphrases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.query.paraphrases import paraphrases


def encode_queries(encoder: Encoder, sentences: Sequence[str]) -> NDArray[np.float32]:
    """Unit query vectors.

    Averaged over paraphrases, a vector depends less on the wording of the sentence.

    Parameters
    ----------
    sentences : sequence of str
        As the user wrote them.

    Returns
    -------
    float32 array (Q, D)
    """
    groups = [paraphrases(sentence) for sentence in sentences]
    vectors = encoder.encode_texts([text for group in groups for text in group])
    starts = np.cumsum([0] + [len(group) for group in groups[:-1]])
    means = np.add.reduceat(vectors, starts, axis=0)
    return np.asarray(means / np.linalg.norm(means, axis=1, keepdims=True), dtype=np.float32)
