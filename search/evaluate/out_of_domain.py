"""Out-of-domain queries: how often sentences that no motion fits are called strong or plausible."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import BundleError
from encoders.protocol import Encoder
from search.hits import PLAUSIBLE, STRONG
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.ranking.strength import judge

_SENTENCES = Path(__file__).parent / "data" / "out_of_domain.txt"


def evaluate_out_of_domain(encoder: Encoder, gallery: NDArray[np.float32]) -> dict[str, float]:
    """Percent of out-of-domain sentences whose best hit in a gallery (N, D) is called strong, or plausible.

    Raises
    ------
    BundleError
        If the model carries no calibration, without which hits have no strength.
    """
    if encoder.calibration is None:
        raise BundleError(f"{encoder.name}: carries no calibration; 'motionseek model release' makes bundles that do")
    sentences = [line for line in _SENTENCES.read_text(encoding="utf-8").splitlines() if line.strip()]
    queries = encode_queries(encoder, sentences)
    strengths = [
        judge(encoder, EncodedQuestion(query[None], (sentence,)), [[float(np.max(gallery @ query))]])[0]
        for sentence, query in zip(sentences, queries, strict=True)
    ]
    return {
        "sentences": float(len(sentences)),
        "strong": 100 * float(np.mean([s == STRONG for s in strengths])),
        "plausible": 100 * float(np.mean([s == PLAUSIBLE for s in strengths])),
    }
