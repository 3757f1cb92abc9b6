"""Fit what a bundle needs to judge its own hits: background motions, known words, and two logistic curves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.captioned_motion import CaptionedTake
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, relevance
from encoders.protocol import Encoder
from search.query.encoding import encode_queries
from search.query.known_words import lexicon
from search.query.vocabulary import vocabulary
from search.ranking import strength

_HITS = 10


def calibrate(
    bundle: Encoder,
    background: Sequence[SyntheticClip],
    asked: Sequence[SyntheticClip],
    unrelated: Sequence[str],
    takes: Sequence[CaptionedTake] = (),
) -> dict[str, NDArray[np.generic]]:
    """The arrays of `calibration.npz`.

    Parameters
    ----------
    background : made clips whose vectors stand for "any motion"
    asked : other made clips: their sentences are asked, their motions searched
    unrelated : sentences that no motion fits
    takes : real takes for validation, whose descriptions and captions are asked as well; they count as much as the
        made clips do

    Returns
    -------
    dict
        "motions" float16 (M, D); "words" str (W,), sorted, of the clips' sentences and the shipped vocabulary;
        "sentence_coefficients" and "motion_coefficients" float64 (3,). The curve for sentences is fitted to those that
        their words do not make doubtful.
    """
    words = lexicon([*vocabulary(), *(caption for clip in (*background, *asked) for caption in clip.captions)])
    motions = bundle.encode_features([clip.features[: bundle.max_frames] for clip in background]).astype(np.float16)
    gallery = bundle.encode_features([clip.features[: bundle.max_frames] for clip in asked])
    sentences = encode_queries(bundle, [clip.captions[0] for clip in asked])
    trusted = [sentence for sentence in unrelated if not strength.is_out_of_vocabulary(sentence, words)]
    nothing = encode_queries(bundle, trusted) if trusted else sentences[:0]
    evidence, truth = _top_hits(
        np.concatenate([sentences, nothing]),
        gallery,
        np.concatenate([relevance(asked), np.zeros((len(nothing), len(gallery)), bool)]),
        motions,
    )
    if takes:
        real_evidence, real_truth = _described(bundle, takes, motions)
        copies = max(1, len(truth) // len(real_truth))
        evidence = np.concatenate([evidence, *[real_evidence] * copies])
        truth = np.concatenate([truth, *[real_truth] * copies])
    actions = [frozenset(step.action for group in clip.scene.steps for step in group) for clip in asked]
    alike = np.array([[a == b for b in actions] for a in actions])
    near, same = _top_hits(gallery, gallery, alike, motions, skip_self=True)
    return {
        "motions": motions,
        "words": words,
        "sentence_coefficients": strength.fit(evidence, truth),
        "motion_coefficients": strength.fit(near, same),
    }


def _described(
    bundle: Encoder, takes: Sequence[CaptionedTake], background: NDArray[np.float16]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Evidence and rightness of the first hits of what was said of real takes; right is what is described the same."""
    said = [(text, t.description) for t in takes for s in t.spans for text in (t.description, *s.captions)]
    said = list(dict.fromkeys(said))
    gallery = bundle.encode_motions([take.motion for take in takes])
    descriptions = np.array([take.description for take in takes])
    right = np.array([descriptions == description for _, description in said])
    return _top_hits(encode_queries(bundle, [text for text, _ in said]), gallery, right, background)


def _top_hits(
    queries: NDArray[np.float32],
    gallery: NDArray[np.float32],
    right: NDArray[np.bool_],
    background: NDArray[np.float16],
    *,
    skip_self: bool = False,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Evidence (Q * hits, 2) and rightness of every query's first hits."""
    similarity = queries @ gallery.T
    if skip_self:
        np.fill_diagonal(similarity, -np.inf)
    best = np.argsort(-similarity, axis=1)[:, : min(_HITS, len(gallery) - skip_self)]
    scores = np.take_along_axis(similarity, best, axis=1)
    evidence = [strength.score_statistics(q, s, background) for q, s in zip(queries, scores, strict=True)]
    return np.concatenate(evidence), np.take_along_axis(right, best, axis=1).ravel()
