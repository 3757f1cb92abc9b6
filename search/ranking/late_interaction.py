"""Late interaction: the first hits are compared once more, each word of the sentence with each part of the motion.

One vector a motion is what a library searches; an encoder that has token vectors, too, ranks the first hits again by
MaxSim (Khattab and Zaharia, ColBERT, SIGIR 2020): the mean over the words of each word's best part. Token vectors are
not stored: those of the few motions that are ranked again are encoded from their poses when a question is asked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from encoders.errors import BundleError
from encoders.protocol import TokenEncoder
from indexer.store.stored_library import StoredLibrary
from search.ranking.clip_scores import ClipScore

#: Clips that are ranked again, the nearest ones.
FIRST_HITS = 100


def max_sim(words: NDArray[np.floating], parts: NDArray[np.floating]) -> float:
    """The mean over words (M, E) of the highest cosine with a part (N, E); all of them unit vectors."""
    return float((words @ parts.T).max(axis=1).mean())


def rerank_by_tokens(
    encoder: TokenEncoder, library: StoredLibrary, sentence: str, ranked: Iterator[ClipScore]
) -> Iterator[ClipScore]:
    """Clips that were ranked for a sentence, the first `FIRST_HITS` by MaxSim with the span that each was found by.

    Their score becomes their MaxSim; clips after them keep the order and the cosine of their vectors.

    Raises
    ------
    BundleError
        If the encoder's token vectors are not unit vectors of one size.
    """
    found = list(islice(ranked, FIRST_HITS))
    if not found:
        return
    spans = []
    for score in found:
        features = encoder.features(library.motion(score.clip_id))
        last = len(features) if score.end is None else round(score.end * encoder.fps)
        first = min(0 if score.start is None else round(score.start * encoder.fps), len(features) - 1)
        spans.append(features[first : max(last, first + 1)])
    (words,) = _checked(encoder, encoder.text_tokens([sentence]), 1)
    parts = _checked(encoder, encoder.motion_tokens(spans), len(spans))
    if {rows.shape[1] for rows in parts} != {words.shape[1]}:
        raise BundleError(f"{encoder.name}: token vectors of sentences and motions differ in size")
    scored = [replace(score, score=max_sim(words, rows)) for score, rows in zip(found, parts, strict=True)]
    yield from sorted(scored, key=lambda score: -score.score)
    yield from ranked


def _checked(encoder: TokenEncoder, tokens: list[NDArray[np.float32]], count: int) -> list[NDArray[np.float32]]:
    given = [np.asarray(rows) for rows in tokens]
    if len(given) != count or any(rows.ndim != 2 or len(rows) == 0 or rows.dtype.kind != "f" for rows in given):
        raise BundleError(f"{encoder.name}: token vectors must be {count} arrays (n, E) with n >= 1")
    if not all((np.abs(np.linalg.norm(rows.astype(np.float64), axis=1) - 1) < 1e-2).all() for rows in given):
        raise BundleError(f"{encoder.name}: token vectors must be finite and of length 1")
    return given
