"""Does the model know when there is nothing? How often sentences about other things are called strong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import BundleError
from encoders.protocol import Encoder
from search.query.encoding import encode_queries
from search.ranking import strength

SENTENCES = Path(__file__).parent / "data" / "out_of_domain.txt"


def evaluate_nonsense(bundle: Encoder, gallery: NDArray[np.float32]) -> dict[str, float]:
    """Percent of out-of-domain sentences whose best hit in a gallery (N, D) is called strong, or plausible.

    Raises
    ------
    BundleError
        If the bundle carries no calibration, and so calls nothing anything.
    """
    if bundle.calibration is None:
        raise BundleError(f"{bundle.name}: carries no calibration; 'motionseek model release' makes bundles that do")
    sentences = [line for line in SENTENCES.read_text(encoding="utf-8").splitlines() if line.strip()]
    queries = encode_queries(bundle, sentences)
    judged = [
        strength.downgrade(bundle, [sentence], strength.judge(bundle, query, [float(np.max(gallery @ query))]))[0]
        for sentence, query in zip(sentences, queries, strict=True)
    ]
    return {
        "sentences": float(len(sentences)),
        "strong": 100 * float(np.mean([j == strength.STRONG for j in judged])),
        "plausible": 100 * float(np.mean([j == strength.PLAUSIBLE for j in judged])),
    }
