"""Products in int8: near what floating point gives, the same in any batch, and only in graphs of the known form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.bundle import sessions
from encoders.bundle.bundle import DEFAULT, Bundle
from encoders.bundle.int8_graph import open_int8
from encoders.bundle.manifest import MOTION
from encoders.corpus.composition.synthetic_pairs import synthetic_clips
from encoders.features.registry import FEATURE_KINDS

pytest.importorskip("onnxruntime")


def loaded(folder: Path, monkeypatch: pytest.MonkeyPatch, *, units: bool) -> Bundle:
    """A bundle that has loaded its motion encoder on a processor with or without such units."""
    monkeypatch.setattr(sessions, "has_int8_units", lambda: units)
    bundle = Bundle.load(folder, threads=1)
    bundle.encode_features([np.zeros((4, 96), np.float32)])
    return bundle


@pytest.fixture(scope="module")
def clips() -> list[np.ndarray]:
    """Features of clips of several lengths."""
    return [clip.features[:100] for clip in synthetic_clips(1, 8, FEATURE_KINDS["body"])]


def test_vectors_are_near_those_of_floating_point(clips: list[np.ndarray], monkeypatch: pytest.MonkeyPatch) -> None:
    exact, small = (loaded(DEFAULT, monkeypatch, units=units).encode_features(clips) for units in (False, True))
    assert not np.array_equal(exact, small)
    assert (exact * small).sum(axis=1).min() > 0.995


def test_a_vector_does_not_depend_on_its_batch(clips: list[np.ndarray], monkeypatch: pytest.MonkeyPatch) -> None:
    bundle = loaded(DEFAULT, monkeypatch, units=True)
    alone = np.concatenate([bundle.encode_features([features]) for features in clips])
    np.testing.assert_allclose(bundle.encode_features(clips), alone, atol=1e-5)


def test_every_process_finds_the_same_vectors(clips: list[np.ndarray], monkeypatch: pytest.MonkeyPatch) -> None:
    once, again = (loaded(DEFAULT, monkeypatch, units=True).encode_features(clips) for _ in range(2))
    np.testing.assert_array_equal(once, again)


def test_a_graph_of_another_form_stays_as_it_is(tiny_bundle: Path) -> None:
    def load(graph: bytes) -> None:
        raise AssertionError("nothing is to be loaded")

    assert open_int8((tiny_bundle / MOTION).read_bytes(), load) is None
