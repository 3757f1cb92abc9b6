"""Strength of a hit: strong, plausible or weak, calibrated per query.

No fixed score separates right from wrong: how high unrelated motion scores depends on the query. So the bundle carries
background motions, and a hit is judged by its score and by how far it stands above what the background scores for the
same query. Both numbers go through a logistic curve that was fitted on validation queries, out-of-domain sentences
among them. Hits of a sentence a third of which is out of vocabulary are downgraded by one degree: its vector may lie
near a motion by chance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.protocol import Encoder
from search.hits import PLAUSIBLE, STRONG, WEAK
from search.query.known_words import Words, out_of_vocabulary_share
from search.query.languages import understood_language_of
from search.query.question import EncodedQuestion
from search.translation.concepts import concepts_of

#: Probability of being right from which a hit is called strong, and plausible.
STRONG_FROM, PLAUSIBLE_FROM = 0.5, 0.2

#: Share of out-of-vocabulary words from which a sentence is out of vocabulary, and from which its hits are downgraded
#: (a third): of 1,800 human sentences about motion 2 in 100 are, of out-of-domain ones 9 in 10.
_UNKNOWN_FROM, _DOWNGRADED_FROM = 0.5, 0.33
_DOWNGRADED = {STRONG: PLAUSIBLE, PLAUSIBLE: WEAK}


def background_level(unrelated: ArrayLike) -> tuple[float, float]:
    """The 95th percentile and the standard deviation of what unrelated motions score for a query (M,)."""
    against = np.asarray(unrelated, np.float64)
    return float(np.percentile(against, 95)), max(float(against.std()), 1e-3)


def score_statistics(scores: ArrayLike, level: tuple[ArrayLike, ArrayLike]) -> NDArray[np.float64]:
    """What strength is calibrated on.

    Parameters
    ----------
    scores : array (...)
        The highest similarity in each hit.
    level : (float, float)
        See `background_level`; or arrays (...) of them.

    Returns
    -------
    float array (..., 2)
        The score, and its height above the background's 95th percentile in standard deviations of the background.
    """
    s = np.asarray(scores, np.float64)
    return np.stack([s, (s - np.asarray(level[0])) / np.asarray(level[1])], axis=-1)


def probability(statistics: ArrayLike, coefficients: ArrayLike) -> NDArray[np.float64]:
    """Probability (N,) that a hit is right, from its `score_statistics` (N, 2) and fitted coefficients (3,)."""
    c = np.asarray(coefficients, np.float64)
    return np.asarray(1 / (1 + np.exp(-(np.asarray(statistics) @ c[1:] + c[0]))))


def judge(encoder: Encoder, question: EncodedQuestion, peaks: ArrayLike) -> list[str]:
    """The strength of each hit of one question; of several sentences the one that fits worst decides.

    Parameters
    ----------
    peaks : array (N, S)
        The highest similarity of each hit to each query vector.

    Returns
    -------
    list of str
        "strong", "plausible" or "weak"; empty strings where the encoder is not calibrated for such questions.
    """
    judged = Judge(encoder, question)
    return [judged(row) for row in np.asarray(peaks, np.float64)]


class Judge:
    """Says how strong the hits of one question are; see `judge`."""

    def __init__(self, encoder: Encoder, question: EncodedQuestion) -> None:
        calibration, unrelated = encoder.calibration or {}, question.unrelated(encoder)
        self._coefficients = calibration.get(f"{question.kind}_coefficients") if unrelated is not None else None
        if unrelated is None or self._coefficients is None:
            return
        self._levels = [background_level(scores) for scores in unrelated]
        words = calibration.get("words")
        self._downgrades = words is not None and any(
            is_out_of_vocabulary(text, words, _DOWNGRADED_FROM) for text in question.wanted
        )

    def __call__(self, peaks: ArrayLike) -> str:
        """The strength of a hit by its highest similarity to each query vector (S,)."""
        if self._coefficients is None:
            return ""
        statistics = [score_statistics(peak, level) for peak, level in zip(np.ravel(peaks), self._levels, strict=True)]
        right = probability(statistics, self._coefficients).min()
        strength = STRONG if right >= STRONG_FROM else PLAUSIBLE if right >= PLAUSIBLE_FROM else WEAK
        return _DOWNGRADED.get(strength, strength) if self._downgrades else strength


def is_out_of_vocabulary(sentence: str, words: Words, least: float = _UNKNOWN_FROM) -> bool:
    """Whether a share of a sentence of `least` or more is not among the sorted words (W,) in which motion is described.

    One of another language is, where it names nothing that its lexicon of movement has.
    """
    if language := understood_language_of(sentence):
        return len(concepts_of(sentence, language)) == 0
    return out_of_vocabulary_share(sentence, words) >= least
