"""Whether a model knows when there is nothing."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.errors import BundleError
from search.evaluate.out_of_domain import evaluate_nonsense
from tests.search.answers import KnownAnswers

MOTIONS = np.eye(6, dtype=np.float32)[:5]
CALIBRATION = {"motions": MOTIONS, "sentence_coefficients": np.array([-5.0, 10.0, 0.0])}


def test_sentences_far_from_every_motion_are_called_nothing() -> None:
    figures = evaluate_nonsense(KnownAnswers(CALIBRATION), MOTIONS)
    assert figures["sentences"] >= 40
    assert figures["strong"] == figures["plausible"] == 0.0


def test_sentences_near_a_motion_are_called_strong() -> None:
    gallery = np.eye(6, dtype=np.float32)
    assert evaluate_nonsense(KnownAnswers(CALIBRATION), gallery)["strong"] == 100.0


def test_without_calibration_nothing_can_be_said() -> None:
    with pytest.raises(BundleError, match="calibration"):
        evaluate_nonsense(KnownAnswers(), MOTIONS)
