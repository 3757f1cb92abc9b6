"""Query vectors: each the mean of the vectors of a sentence and its paraphrases.

A sentence of another language has the mean vector of the English sentences nearest to it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.query.known_words import spelled_out
from search.query.languages import understood_language_of
from search.query.paraphrases import paraphrases
from search.translation.english_neighbours import encode_foreign


def encode_queries(encoder: Encoder, sentences: Sequence[str], *, paraphrased: bool = True) -> NDArray[np.float32]:
    """Unit query vectors.

    Averaged over paraphrases, a vector depends less on the wording of the sentence.

    Parameters
    ----------
    sentences : sequence of str
        As the user wrote them; also names of clips, such as "HitReactLeft_02".
    paraphrased : bool
        Whether English sentences are averaged with their paraphrases.

    Returns
    -------
    float32 array (Q, D)
    """
    languages = [understood_language_of(sentence) for sentence in sentences]
    english = [spelled_out(text) for text, language in zip(sentences, languages, strict=True) if not language]
    foreign = [(text, language) for text, language in zip(sentences, languages, strict=True) if language]
    vectors = np.empty((len(sentences), encoder.latent_size), np.float32)
    is_foreign = np.array(languages, bool)
    if english:
        vectors[~is_foreign] = _encode_paraphrased(encoder, english) if paraphrased else encoder.encode_texts(english)
    if foreign:
        vectors[is_foreign] = encode_foreign(encoder, *zip(*foreign, strict=True))
    return vectors


def _encode_paraphrased(encoder: Encoder, sentences: Sequence[str]) -> NDArray[np.float32]:
    groups = [paraphrases(sentence) for sentence in sentences]
    vectors = encoder.encode_texts([text for group in groups for text in group])
    starts = np.cumsum([0] + [len(group) for group in groups[:-1]])
    means = np.add.reduceat(vectors, starts, axis=0)
    return np.asarray(means / np.linalg.norm(means, axis=1, keepdims=True), dtype=np.float32)
