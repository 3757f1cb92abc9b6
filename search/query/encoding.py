"""Query vectors: each the mean of the vectors of a sentence and its paraphrases.

A sentence of another language has the mean vector of the English sentences nearest to it. What a sentence takes away
("without turning", "-left") is subtracted in part.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.query.known_words import spelled_out
from search.query.languages import understood_language_of
from search.query.negation import Parts, parts_of
from search.query.paraphrases import is_action, paraphrases
from search.translation.english_neighbours import encode_foreign

#: How much of the vector of what is taken away is subtracted at least, and how much more where that is like what is
#: asked for, as "left" of "kicks" is (`benchmarks.negation`).
_LEAST, _ALIKE = 0.2, 0.5


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
    parts = [parts_of(sentence) for sentence in sentences]
    negated = [(i, texts) for i, part in enumerate(parts) for texts in _negated(part, languages[i])]
    owners = [i for i, texts in negated for _ in texts]
    texts = [*(part.wanted for part in parts), *(text for _, texts in negated for text in texts)]
    encoded = _encode(encoder, texts, [*languages, *(languages[i] for i in owners)], paraphrased)
    vectors, others = encoded[: len(parts)], iter(encoded[len(parts) :])
    unwanted = [(i, _unit(np.sum([next(others) for _ in texts], axis=0))) for i, texts in negated]
    for i in dict.fromkeys(owners):
        vectors[i] = taken_away(vectors[i], np.stack([vector for owner, vector in unwanted if owner == i]))
    return vectors


def taken_away(wanted: NDArray[np.float32], unwanted: NDArray[np.float32]) -> NDArray[np.float32]:
    """The unit vector (D,) of what is asked for less what is taken away (U, D); all of them unit vectors."""
    shares = np.maximum(0, _LEAST + _ALIKE * unwanted @ wanted) / np.sqrt(len(unwanted))
    return _unit(wanted - shares @ unwanted)


def _negated(part: Parts, language: str) -> list[tuple[str, ...]]:
    """The texts whose mean vector each thing has that is taken away.

    What is no action by itself ("left") is also read beside what is asked for ("kicks left").
    """
    alone = part.only_takes_away or bool(language)
    return [(text,) if alone or is_action(text) else (text, f"{part.wanted} {text}") for text in part.unwanted]


def _unit(vector: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(vector / np.linalg.norm(vector), np.float32)


def _encode(encoder: Encoder, texts: Sequence[str], languages: Sequence[str], paraphrased: bool) -> NDArray[np.float32]:
    """Unit vectors (Q, D) of texts, each of a language; empty for English."""
    english = [spelled_out(text) for text, language in zip(texts, languages, strict=True) if not language]
    foreign = [(text, language) for text, language in zip(texts, languages, strict=True) if language]
    vectors = np.empty((len(texts), encoder.latent_size), np.float32)
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
