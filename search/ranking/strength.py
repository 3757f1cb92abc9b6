"""Strength of a hit: strong, plausible or weak, calibrated per query.

No fixed score separates right from wrong: how high unrelated motion scores depends on the query. So the bundle carries
background motions, and a hit is judged by its score and by how far it stands above what the background scores for the
same query. Both numbers go through a logistic curve that was fitted on validation queries, out-of-domain sentences
among them. Hits of a sentence that is mostly out of vocabulary are downgraded by one degree: its vector may lie near a
motion by chance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.protocol import Encoder, unrelated_motions
from search.hits import PLAUSIBLE, STRONG, WEAK
from search.query.known_words import Words, out_of_vocabulary_share
from search.query.question import EncodedQuestion

#: Probability of being right from which a hit is called strong, and plausible.
_STRONG_FROM, _PLAUSIBLE_FROM = 0.6, 0.2

#: Share of out-of-vocabulary words from which the hits of a sentence are downgraded.
_DOWNGRADED_FROM = 0.5
_DOWNGRADED = {STRONG: PLAUSIBLE, PLAUSIBLE: WEAK}


def score_statistics(query: ArrayLike, scores: ArrayLike, background: ArrayLike) -> NDArray[np.float64]:
    """What strength is calibrated on.

    Parameters
    ----------
    query : array (D,)
        Unit vector of a sentence or a motion.
    scores : array (N,)
        Cosines of the hits.
    background : array (M, D)
        Unit vectors of unrelated motions.

    Returns
    -------
    float array (N, 2)
        The score, and its height above the background's 95th percentile in standard deviations of the background.
    """
    against = np.asarray(background, np.float32) @ np.asarray(query, np.float32)
    spread = max(float(against.std()), 1e-3)
    s = np.asarray(scores, np.float64)
    return np.stack([s, (s - np.percentile(against, 95)) / spread], axis=-1)


def probability(statistics: ArrayLike, coefficients: ArrayLike) -> NDArray[np.float64]:
    """Probability (N,) that a hit is right, from its `score_statistics` (N, 2) and fitted coefficients (3,)."""
    c = np.asarray(coefficients, np.float64)
    return np.asarray(1 / (1 + np.exp(-(np.asarray(statistics) @ c[1:] + c[0]))))


def judge(encoder: Encoder, question: EncodedQuestion, scores: ArrayLike) -> list[str]:
    """The strength of each hit of one question.

    Parameters
    ----------
    scores : array (N,)
        Cosines of the hits.

    Returns
    -------
    list of str
        "strong", "plausible" or "weak"; empty strings where the encoder is not calibrated for such questions.
    """
    calibration, background = encoder.calibration or {}, unrelated_motions(encoder)
    coefficients = calibration.get(f"{question.kind}_coefficients")
    s = np.asarray(scores, np.float64)
    if background is None or coefficients is None or len(s) == 0:
        return [""] * len(s)
    right = probability(score_statistics(question.vectors.mean(axis=0), s, background), coefficients)
    strengths = [STRONG if p >= _STRONG_FROM else PLAUSIBLE if p >= _PLAUSIBLE_FROM else WEAK for p in right]
    words = calibration.get("words")
    if words is None or not any(is_out_of_vocabulary(sentence, words) for sentence in question.sentences):
        return strengths
    return [_DOWNGRADED.get(strength, strength) for strength in strengths]


def is_out_of_vocabulary(sentence: str, words: Words) -> bool:
    """Whether half of a sentence or more is not among the sorted words (W,) in which motion is described."""
    return out_of_vocabulary_share(sentence, words) >= _DOWNGRADED_FROM
