"""Is this hit really one? Strong, plausible or weak, calibrated per query.

No fixed score separates right from wrong: how high unrelated motion scores depends on the query. So the bundle
carries background motions, and a hit is judged by its score and by how far it stands above what the background
scores for the same query. Two numbers go through a logistic curve that was fitted on validation queries, nonsense
among them. What a sentence is made of counts beside: near a motion by its vector alone, one in words that nobody uses
of motion is called a degree less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.protocol import Encoder
from search.hits import Hit, Hits
from search.query.known_words import Words, out_of_vocabulary_share

STRONG, PLAUSIBLE, WEAK = "strong", "plausible", "weak"

#: Chance of being right from which a hit is called strong, and plausible.
_STRONG_FROM, _PLAUSIBLE_FROM = 0.6, 0.2

#: Share of words foreign to descriptions of motion from which a sentence is doubted.
_FOREIGN = 0.5
_LESS = {STRONG: PLAUSIBLE, PLAUSIBLE: WEAK}


def evidence(query: ArrayLike, scores: ArrayLike, background: ArrayLike) -> NDArray[np.float64]:
    """What a judgement rests on.

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
        The score, and its height above the background's upper end (95th percentile) in standard deviations.
    """
    against = np.asarray(background, np.float32) @ np.asarray(query, np.float32)
    spread = max(float(against.std()), 1e-3)
    s = np.asarray(scores, np.float64)
    return np.stack([s, (s - np.percentile(against, 95)) / spread], axis=-1)


def chance(evidence: ArrayLike, coefficients: ArrayLike) -> NDArray[np.float64]:
    """Chance (N,) that a hit is right, from its evidence (N, 2) and the fitted coefficients (3,)."""
    c = np.asarray(coefficients, np.float64)
    return np.asarray(1 / (1 + np.exp(-(np.asarray(evidence) @ c[1:] + c[0]))))


def judge(bundle: Encoder, query: ArrayLike, scores: ArrayLike, *, asked: str = "sentence") -> list[str]:
    """The strength of each hit of one query.

    Parameters
    ----------
    query : array (D,)
        Unit query vector.
    scores : array (N,)
        Cosines of the hits.
    asked : str
        "sentence" or "motion": what the query was.

    Returns
    -------
    list of str
        "strong", "plausible" or "weak"; empty strings where the bundle carries no calibration.
    """
    calibration = bundle.calibration
    s = np.asarray(scores, np.float64)
    if calibration is None or len(s) == 0:
        return [""] * len(s)
    right = chance(evidence(query, s, calibration["motions"]), calibration[f"{asked}_coefficients"])
    return [STRONG if p >= _STRONG_FROM else PLAUSIBLE if p >= _PLAUSIBLE_FROM else WEAK for p in right]


def is_out_of_vocabulary(sentence: str, words: Words) -> bool:
    """Whether half of a sentence or more is foreign to the sorted words (W,) in which motion is described."""
    return out_of_vocabulary_share(sentence, words) >= _FOREIGN


def downgrade(bundle: Encoder, sentences: Sequence[str], strengths: Sequence[str]) -> list[str]:
    """Strengths of answers to sentences, each a degree less where one of these is doubtful.

    A bundle whose calibration holds no "words" doubts nothing.
    """
    words = (bundle.calibration or {}).get("words")
    if words is None or not any(is_out_of_vocabulary(sentence, words) for sentence in sentences):
        return list(strengths)
    return [_LESS.get(strength, strength) for strength in strengths]


def downgrade_hits(bundle: Encoder, sentences: Sequence[str], hits: Sequence[Hit]) -> Hits:
    """Hits with strengths as `downgrade` has them."""
    tempered = downgrade(bundle, sentences, [hit.strength for hit in hits])
    return Hits(replace(hit, strength=strength) for hit, strength in zip(hits, tempered, strict=True))


def fit(evidence: ArrayLike, right: ArrayLike, *, rounds: int = 50, penalty: float = 1e-3) -> NDArray[np.float64]:
    """Coefficients (3,) of the logistic curve by Newton's method with a small ridge.

    Parameters
    ----------
    evidence : array (N, 2)
    right : bool array (N,)

    Raises
    ------
    ValueError
        If all hits are right, or all wrong.
    """
    x = np.column_stack([np.ones(len(np.asarray(evidence))), np.asarray(evidence, np.float64)])
    y = np.asarray(right, np.float64)
    if y.min() == y.max():
        raise ValueError("both right and wrong hits are needed")
    w = np.zeros(x.shape[1])
    ridge = penalty * len(y) * np.diag([0.0, 1.0, 1.0])
    for _ in range(rounds):
        p = 1 / (1 + np.exp(-np.clip(x @ w, -30, 30)))
        hessian = (x * (p * (1 - p))[:, None]).T @ x + ridge
        step = np.linalg.solve(hessian + 1e-9 * np.eye(len(w)), x.T @ (y - p) - ridge @ w)
        w = w + step
        if np.abs(step).max() < 1e-8:
            break
    return w


def nothing_matches(strengths: Sequence[str]) -> bool:
    """Whether no hit is more than weak: the honest answer is then that nothing in the library matches."""
    return bool(strengths) and all(s == WEAK for s in strengths)
