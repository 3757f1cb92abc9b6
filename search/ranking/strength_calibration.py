"""Strength calibration: the background motions, the vocabulary and the two logistic curves of a bundle.

The bundle carries them as `calibration.npz`; `search.ranking.strength` judges hits by them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.corpus.composition.seeds import CALIBRATION
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, relevance, synthetic_clips
from encoders.corpus.language.unrelated import unrelated_sentences
from encoders.features.registry import feature_kind
from encoders.protocol import Encoder
from search.query.encoding import encode_queries
from search.query.known_words import lexicon
from search.query.vocabulary import vocabulary
from search.ranking.strength import background_level, is_out_of_vocabulary, score_statistics

_HITS, _NEWTON_STEPS = 10, 50
#: Synthetic clips of the background, those queried for, and out-of-domain sentences.
_BACKGROUND, _QUERIED, _OUT_OF_DOMAIN = 1500, 800, 400

#: `score_statistics` (N, 2) of hits, and whether each is right (N,).
Judged = tuple[NDArray[np.float64], NDArray[np.bool_]]
#: Of background motions (M, D): the hits of each real archive.
RealHits = Callable[[NDArray[np.float16]], Sequence[Judged]]


def calibrate(
    encoder: Encoder,
    background: Sequence[SyntheticClip],
    gallery: Sequence[SyntheticClip],
    out_of_domain: Sequence[str],
    real: RealHits | None = None,
) -> dict[str, NDArray[np.generic]]:
    """The arrays of `calibration.npz`.

    Parameters
    ----------
    background : synthetic clips whose vectors stand for unrelated motion
    gallery : other synthetic clips: their captions and their motions are queries to their motions
    out_of_domain : sentences that no motion fits
    real : function, optional
        Gives the hits of real archives, each judged beside the background; the curve of sentences is then fitted to
        them alone. An archive weighs by the root of its hits, so that a large one does not decide by itself.

    Returns
    -------
    dict
        "motions" float16 (M, D); "words" str (W,), sorted, of the clips' captions and the shipped vocabulary;
        "sentence_coefficients" and "motion_coefficients" float64 (3,). Out-of-vocabulary sentences are left out of the
        fit, since their hits are downgraded anyway.
    """
    words = lexicon([*vocabulary(), *(caption for clip in (*background, *gallery) for caption in clip.captions)])
    motions = _encode_clips(encoder, background).astype(np.float16)
    vectors = _encode_clips(encoder, gallery)

    def synthetic_hits() -> Judged:
        captions = [clip.captions[0] for clip in gallery]
        known = [sentence for sentence in out_of_domain if not is_out_of_vocabulary(sentence, words)]
        queries = np.concatenate([encode_queries(encoder, sentences) for sentences in (captions, known) if sentences])
        right = np.concatenate([relevance(gallery), np.zeros((len(known), len(vectors)), bool)])
        return _top_hits(queries, vectors, right, motions)

    actions = [frozenset(step.action for group in clip.scene.steps for step in group) for clip in gallery]
    same_actions = np.array([[a == b for b in actions] for a in actions])
    return {
        "motions": motions,
        "words": words,
        "sentence_coefficients": fit_together(real(motions)) if real else fit_logistic(*synthetic_hits()),
        "motion_coefficients": fit_logistic(*_top_hits(vectors, vectors, same_actions, motions, skip_self=True)),
    }


def calibrate_synthetically(encoder: Encoder, real: RealHits | None = None) -> dict[str, NDArray[np.generic]]:
    """The arrays of `calibrate`, on synthetic clips of the encoder's features that no model is trained on."""
    clips = list(synthetic_clips(CALIBRATION, _BACKGROUND + _QUERIED, feature_kind(encoder.feature_kind)))
    out_of_domain = unrelated_sentences(_OUT_OF_DOMAIN, seed=1)
    return calibrate(encoder, clips[:_BACKGROUND], clips[_BACKGROUND:], out_of_domain, real)


def fit_logistic(
    statistics: ArrayLike,
    right: ArrayLike,
    weights: ArrayLike | None = None,
    *,
    penalty: float = 1e-3,
) -> NDArray[np.float64]:
    """Coefficients (3,) of a logistic curve by Newton's method, with a small ridge penalty on the standardised slopes.

    Parameters
    ----------
    statistics : array (N, 2)
        See `score_statistics`.
    right : bool array (N,)
    weights : array (N,), optional
        How much each hit counts; 1 if not given.

    Raises
    ------
    ValueError
        If all hits are right, or all wrong.
    """
    raw, y = np.asarray(statistics, np.float64), np.asarray(right, np.float64)
    count = np.ones(len(y)) if weights is None else np.asarray(weights, np.float64)
    if y.min() == y.max():
        raise ValueError("both right and wrong hits are needed")
    mean, scale = raw.mean(axis=0), raw.std(axis=0)
    x = np.column_stack([np.ones(len(y)), (raw - mean) / scale])
    w = _newton(x, y, count, penalty)
    # A higher hit of one question must never come out weaker: a statistic that says so is left out.
    rising = np.append(True, w[1:] > 0)
    w = np.where(rising, _newton(x * rising, y, count, penalty), 0.0)
    slopes = w[1:] / scale
    return np.append(w[0] - slopes @ mean, slopes)


def _newton(
    x: NDArray[np.float64], y: NDArray[np.float64], count: NDArray[np.float64], penalty: float
) -> NDArray[np.float64]:
    """Weights (C,) of the logistic curve of x (N, C), whose first column is 1, for y (N,), rows counting so much."""
    w = np.zeros(x.shape[1])
    ridge = penalty * count.sum() * np.diag(np.arange(len(w)) > 0)
    for _ in range(_NEWTON_STEPS):
        p = 1 / (1 + np.exp(-np.clip(x @ w, -30, 30)))
        hessian = (x * (count * p * (1 - p))[:, None]).T @ x + ridge
        step = np.linalg.solve(hessian + 1e-9 * np.eye(len(w)), x.T @ (count * (y - p)) - ridge @ w)
        w = w + step
        if np.abs(step).max() < 1e-8:
            break
    return w


def fit_together(archives: Sequence[Judged]) -> NDArray[np.float64]:
    """The coefficients (3,) of `fit_logistic` for hits of archives, each weighing by the root of their number."""
    statistics, right = (np.concatenate(parts) for parts in zip(*archives, strict=True))
    weights = np.concatenate([np.full(len(of), len(of) ** -0.5) for _, of in archives])
    return fit_logistic(statistics, right, weights / weights.mean())


def _encode_clips(encoder: Encoder, clips: Sequence[SyntheticClip]) -> NDArray[np.float32]:
    return encoder.encode_features([clip.features[: encoder.max_frames] for clip in clips])


def _top_hits(
    queries: NDArray[np.float32],
    gallery: NDArray[np.float32],
    right: NDArray[np.bool_],
    background: NDArray[np.float16],
    *,
    skip_self: bool = False,
) -> Judged:
    """The first hits of every query (Q, D) in a gallery (N, D), of which `right` (Q, N) are right."""
    similarity = queries @ gallery.T
    if skip_self:
        np.fill_diagonal(similarity, -np.inf)
    best = np.argsort(-similarity, axis=1)[:, : min(_HITS, len(gallery) - skip_self)]
    scores = np.take_along_axis(similarity, best, axis=1)
    against = queries @ background.astype(np.float32).T
    statistics = [score_statistics(s, background_level(b)) for s, b in zip(scores, against, strict=True)]
    return np.concatenate(statistics), np.take_along_axis(right, best, axis=1).ravel()
