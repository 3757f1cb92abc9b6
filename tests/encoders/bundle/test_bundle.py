"""The bundle at work, on a bundle of random weights: no torch is needed, and none is loaded."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle, open_session
from encoders.bundle.manifest import digest
from encoders.bundle.windows import window_starts
from encoders.errors import ArgumentError, BundleError
from encoders.features.registry import FEATURE_KINDS
from encoders.motion import Motion
from encoders.protocol import Encoder
from tests.conftest import ROOT
from tests.encoders.bundle.conftest import change

SIZE = FEATURE_KINDS["body"].size


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> Bundle:
    return Bundle.load(tiny_bundle, threads=1)


def sequences(*lengths: int, seed: int = 0) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.standard_normal((length, SIZE)).astype(np.float32) for length in lengths]


def walk(frames: int, fps: float = 20.0, seed: int = 0) -> Motion:
    steps = np.random.default_rng(seed).normal(0, 0.02, (frames, 22, 3)).cumsum(0)
    return Motion(steps + np.random.default_rng(1).normal(0, 0.5, (22, 3)), fps)


def test_a_bundle_is_an_encoder(tiny_bundle: Path) -> None:
    encoder: Encoder = Bundle.load(tiny_bundle)
    members = {name for name in vars(Encoder) if not name.startswith("_")}
    assert len(members) == 12
    assert all(hasattr(encoder, name) for name in members)


def test_it_says_what_it_is(bundle):
    assert (bundle.name, bundle.feature_kind, bundle.fps, bundle.max_frames) == ("tiny", "body", 10.0, 100)
    assert bundle.latent_size == 24
    assert bundle.manifest["licence"] == "MIT"
    assert bundle.calibration is None
    assert len(bundle.fingerprint) == 64


def test_vectors_are_unit_and_in_the_order_asked(bundle):
    features = sequences(33, 7, 100, 1, 64)
    latents = bundle.encode_features(features)
    assert latents.shape == (5, 24)
    assert latents.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(latents, axis=1), 1, atol=1e-6)
    for sequence, latent in zip(features, latents, strict=True):
        np.testing.assert_allclose(bundle.encode_features([sequence])[0], latent, atol=1e-5)


def test_many_motions_in_mixed_lengths_give_what_each_gives_alone(bundle):
    lengths = np.random.default_rng(0).integers(1, 110, 200)
    features = sequences(*lengths)
    together = bundle.encode_features(features)
    alone = np.concatenate([bundle.encode_features([sequence]) for sequence in features])
    np.testing.assert_allclose(together, alone, atol=1e-5)


def test_what_padding_holds_does_not_matter(bundle):
    (features,) = sequences(10)
    padded = np.full((1, 30, SIZE), 1e3, np.float32)
    padded[0, :10] = features
    graph = open_session(bundle.folder / "motion.onnx", threads=1)
    (latent,) = graph.run(None, {"features": padded, "lengths": np.array([10])})[0]
    np.testing.assert_allclose(latent / np.linalg.norm(latent), bundle.encode_features([features])[0], atol=1e-5)


def test_windows_are_slices_encoded_alone(bundle):
    (features,) = sequences(300)
    starts = np.arange(0, 300 - 33)
    latents = bundle.encode_windows(features, starts, 33)
    assert latents.shape == (len(starts), 24)
    for start in (0, 100, 266):
        expected = bundle.encode_features([features[start : start + 33]])[0]
        np.testing.assert_allclose(latents[start], expected, atol=1e-5)
    assert bundle.encode_windows(features, np.array([], np.int64), 33).shape == (0, 24)


@pytest.mark.parametrize(("starts", "length"), [([-1], 10), ([291], 10), ([0], 0)])
def test_windows_outside_the_features_are_refused(bundle, starts, length):
    with pytest.raises(ArgumentError, match="must lie inside"):
        bundle.encode_windows(sequences(300)[0], np.array(starts), length)


def test_motions_are_encoded_through_their_features(bundle):
    motions = [walk(60), walk(30, fps=30.0), walk(1)]
    latents = bundle.encode_motions(motions)
    np.testing.assert_allclose(latents, bundle.encode_features([bundle.features(m) for m in motions]), atol=1e-6)


def test_a_long_motion_is_the_mean_of_half_overlapping_windows(bundle):
    motion = walk(450)
    features = bundle.features(motion)
    assert len(features) == 225
    starts = window_starts(225, 100, 50)
    assert starts.tolist() == [0, 50, 100, 125]
    mean = bundle.encode_windows(features, starts, 100).mean(axis=0)
    short = walk(40, seed=2)
    latents = bundle.encode_motions([short, motion])
    np.testing.assert_allclose(latents[1], mean / np.linalg.norm(mean), atol=1e-6)
    np.testing.assert_allclose(latents[0], bundle.encode_motions([short])[0], atol=1e-5)
    np.testing.assert_array_equal(bundle.encode_features([bundle.features(short), features]), latents)


def test_sentences_give_the_same_together_and_alone(bundle):
    sentences = ["a person walks", "jump", "a woman sits down and then stands up slowly", "", "walk " * 200]
    together = bundle.encode_texts(sentences)
    assert together.shape == (5, 24)
    np.testing.assert_allclose(np.linalg.norm(together, axis=1), 1, atol=1e-6)
    fresh = Bundle.load(bundle.folder)
    for sentence, latent in zip(sentences, together, strict=True):
        np.testing.assert_allclose(fresh.encode_texts([sentence])[0], latent, atol=1e-5)
    assert bundle.encode_texts([]).shape == (0, 24)


class CountingSession:
    """A session that counts the sentences that pass it."""

    def __init__(self, session: Any) -> None:
        self.session = session
        self.sentences = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.session, name)

    def run(self, outputs: Any, feed: dict[str, np.ndarray]) -> Any:
        self.sentences += len(feed["input_ids"])
        return self.session.run(outputs, feed)


def test_the_last_few_thousand_sentences_are_encoded_once(bundle, monkeypatch):
    counting = CountingSession(open_session(bundle.folder / "text.onnx"))
    monkeypatch.setattr("encoders.bundle.bundle.open_session", lambda path, threads, int8: counting)
    fresh = Bundle.load(bundle.folder)
    first = fresh.encode_texts(["jump", "run", "jump"])
    again = fresh.encode_texts(["run", "sit", "jump"])
    assert counting.sentences == 3
    np.testing.assert_array_equal(first[[1, 0]], again[[0, 2]])
    fresh.encode_texts([f"run {i}" for i in range(4096)])
    fresh.encode_texts(["run 4095"])
    assert counting.sentences == 3 + 4096
    fresh.encode_texts(["jump"])
    assert counting.sentences == 3 + 4096 + 1


@pytest.mark.parametrize("shape", [(0, SIZE), (5, SIZE - 1), (5,), (1, 5, SIZE)])
def test_features_of_another_shape_are_refused(bundle, shape):
    with pytest.raises(ArgumentError, match="must be"):
        bundle.encode_features([np.zeros(shape, np.float32)])


def test_nothing_encodes_to_nothing(bundle):
    assert bundle.encode_features([]).shape == (0, 24)
    assert bundle.encode_motions([]).shape == (0, 24)


def test_calibration_is_read_when_listed_and_changes_no_fingerprint(copy, bundle):
    np.savez(copy / "calibration.npz", background=np.arange(3))
    assert Bundle.load(copy).calibration is None
    files = json.loads((copy / "manifest.json").read_text())["files"]
    change(copy, files=files | {"calibration.npz": digest(copy / "calibration.npz")})
    loaded = Bundle.load(copy)
    assert loaded.calibration["background"].tolist() == [0, 1, 2]
    assert loaded.fingerprint == bundle.fingerprint


def test_calibration_that_needs_pickle_is_refused(copy):
    np.savez(copy / "calibration.npz", background=np.array([{}]))
    files = json.loads((copy / "manifest.json").read_text())["files"]
    change(copy, files=files | {"calibration.npz": digest(copy / "calibration.npz")})
    with pytest.raises(BundleError, match=r"calibration\.npz"):
        _ = Bundle.load(copy).calibration


def test_a_graph_that_does_not_fit_its_manifest_is_refused(copy):
    change(copy, latent_size=25)
    loaded = Bundle.load(copy)
    with pytest.raises(BundleError, match=r"motion\.onnx: does not fit"):
        loaded.encode_features(sequences(10))
    with pytest.raises(BundleError, match=r"text\.onnx: does not fit"):
        loaded.encode_texts(["jump"])


@pytest.mark.parametrize(("name", "ask"), [("motion.onnx", "encode_features"), ("tokenizer.json", "encode_texts")])
def test_a_file_that_is_none_of_its_kind_is_named(copy, name, ask):
    (copy / name).write_bytes(b"nonsense")
    files = json.loads((copy / "manifest.json").read_text())["files"]
    change(copy, files=files | {name: digest(copy / name)})
    loaded = Bundle.load(copy)
    with pytest.raises(BundleError, match=name):
        getattr(loaded, ask)(sequences(10) if ask == "encode_features" else ["jump"])


def test_encoding_needs_no_torch_and_motions_need_no_language_model(tiny_bundle):
    program = f"""
import sys, numpy as np
from encoders.bundle.bundle import Bundle
assert "onnxruntime" not in sys.modules and "tokenizers" not in sys.modules
bundle = Bundle.load({str(tiny_bundle)!r})
bundle.encode_features([np.zeros((5, {SIZE}), np.float32)])
assert "tokenizers" not in sys.modules
bundle.encode_texts(["jump"])
assert "torch" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)
