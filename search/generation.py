"""Generated motions beside real ones: how well each fits a sentence, by the same model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.errors import BundleMismatch
from encoders.motion import Motion
from search.judging.metrics.agreement import tmr_scores
from search.library import Library


class RealHit(NamedTuple):
    """A clip of a library, and its TMR-score with a sentence."""

    path: str
    score: float


def scores_of(motions: Sequence[Motion], sentence: str, bundle: Bundle) -> list[float]:
    """TMR-score of each motion with a sentence, both as they are."""
    vector = bundle.encode_texts([sentence])
    vectors = bundle.encode_motions(motions)
    return [float(score) for score in tmr_scores(vectors, np.repeat(vector, len(vectors), axis=0))]


def best_real(library: Library, sentence: str, bundle: Bundle) -> RealHit | None:
    """The clip of a library that, as a whole, fits a sentence best; None where the library is empty.

    Raises
    ------
    BundleMismatch
        If the library holds vectors of another model.
    """
    if library.bundle.fingerprint != bundle.fingerprint:
        raise BundleMismatch(f"{library.folder}: made with another model, so its clips cannot be compared")
    scores, ids = library.nearest_clips(bundle.encode_texts([sentence]), 1)
    if ids[0, 0] < 0:
        return None
    clip = library.clips_by_id([int(ids[0, 0])])[int(ids[0, 0])]
    return RealHit(clip.path, 0.5 + 0.5 * float(scores[0, 0]))
