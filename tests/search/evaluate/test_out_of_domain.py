"""How out-of-domain sentences are called."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.errors import BundleError
from search.evaluate.out_of_domain import evaluate_out_of_domain
from tests.search.answers import KnownAnswers

MOTIONS = np.eye(6, dtype=np.float32)[:5]
CALIBRATION = {"motions": MOTIONS, "sentence_coefficients": np.array([-5.0, 10.0, 0.0])}


def test_sentences_far_from_every_motion_are_called_weak() -> None:
    figures = evaluate_out_of_domain(KnownAnswers(CALIBRATION), MOTIONS)
    assert figures["sentences"] >= 40
    assert figures["strong"] == figures["plausible"] == 0.0


def test_sentences_near_a_motion_are_called_strong() -> None:
    gallery = np.eye(6, dtype=np.float32)
    assert evaluate_out_of_domain(KnownAnswers(CALIBRATION), gallery)["strong"] == 100.0


def test_a_model_without_calibration_is_refused() -> None:
    with pytest.raises(BundleError, match="calibration"):
        evaluate_out_of_domain(KnownAnswers(), MOTIONS)
