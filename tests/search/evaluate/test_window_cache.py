"""Cached windows: the vectors of the encoder, each encoded once."""

from __future__ import annotations

import numpy as np

from search.evaluate.window_cache import WindowCache
from tests.search.answers import KnownAnswers, motion


def test_a_cached_window_has_the_vector_of_the_encoder() -> None:
    model, features = KnownAnswers(), KnownAnswers().features(motion(0, 1, 2, seconds=2.0))
    cached = WindowCache(model)
    whole = cached.encode_windows(features, np.arange(40), 20)
    part = cached.encode_windows(features[7:], np.arange(0, 30, 2), 20)
    assert np.array_equal(part, whole[7:37:2])
    assert model.encoded == 40
    cached.keep_only(())
    assert np.array_equal(cached.encode_windows(features, np.arange(40), 20), whole)
