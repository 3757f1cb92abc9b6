"""A model of any making as an encoder: two functions over padded batches."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.bundle.encoder_adapter import EncoderAdapter
from encoders.errors import ArgumentError, BundleError
from encoders.features.registry import FEATURE_KINDS, FeatureKind
from encoders.motion import Motion
from encoders.protocol import Encoder, TokenEncoder

PELVIS = FeatureKind("pelvis", 3, 5.0, lambda motion: motion.resample(5.0).joints[:, 0])


def adapter(**changes):
    """A motion is the sum of its standardised features, a sentence the count and sum of its letters."""
    parts = {
        "name": "sums",
        "fingerprint": "sums-1",
        "features": PELVIS,
        "latent_size": 3,
        "max_frames": 8,
        "motions": lambda features, lengths: features.sum(axis=1),
        "tokenizer": lambda sentences: [[ord(letter) for letter in sentence] for sentence in sentences],
        "texts": lambda ids, mask: np.stack([mask.sum(1), (ids * mask).sum(1), mask[:, 0]], axis=1).astype(np.float32),
        "mean": [1.0, 2.0, 3.0],
        "std": [1.0, 2.0, 4.0],
    }
    return EncoderAdapter(**parts | changes)


def unit(vector):
    return np.asarray(vector) / np.linalg.norm(vector)


def test_an_adapter_is_an_encoder():
    model = adapter()
    assert isinstance(model, Encoder)
    assert not isinstance(model, TokenEncoder)
    assert (model.feature_kind, model.fps, model.calibration) == ("pelvis", 5.0, None)
    assert adapter(features="rifke", mean=None, std=None).fps == FEATURE_KINDS["rifke"].fps


def test_features_are_standardised_and_padding_counts_for_nothing():
    rng = np.random.default_rng(0)
    rows = [rng.normal(size=(frames, 3)).astype(np.float32) for frames in (2, 7, 8, 3)]
    expected = [unit(((row - [1, 2, 3]) / [1, 2, 4]).sum(axis=0)) for row in rows]
    np.testing.assert_allclose(adapter().encode_features(rows), expected, atol=1e-5)


def test_a_long_motion_is_the_mean_of_its_windows_and_any_motion_is_brought_to_its_rate():
    model, rows = adapter(), np.random.default_rng(1).normal(size=(20, 3)).astype(np.float32)
    windows = model.encode_windows(rows, np.array([0, 4, 8, 12]), 8)
    np.testing.assert_allclose(model.encode_features([rows])[0], unit(windows.mean(axis=0)), atol=1e-6)
    motion = Motion(np.random.default_rng(2).normal(size=(40, 22, 3)), 20.0)
    assert model.features(motion).shape == (10, 3)


def test_sentences_are_tokenised_padded_and_encoded_once():
    calls = []

    def texts(ids, mask):
        calls.append(ids.shape)
        return np.stack([mask.sum(1), (ids * mask).sum(1), mask[:, 0]], axis=1).astype(np.float32)

    model = adapter(texts=texts)
    found = model.encode_texts(["ab", "a", "ab"])
    np.testing.assert_allclose(found, [unit([2, 195, 1]), unit([1, 97, 1]), unit([2, 195, 1])], atol=1e-6)
    np.testing.assert_array_equal(model.encode_texts(["a"]), found[1:2])
    assert sum(rows for rows, _ in calls) == 2


def test_a_tokenizer_of_tokenizers_is_taken(tiny_bundle):
    from tokenizers import Tokenizer

    model = adapter(tokenizer=Tokenizer.from_file(str(tiny_bundle / "tokenizer.json")))
    assert model.encode_texts(["a person walks"]).shape == (1, 3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mean": [1.0, 2.0]}, r"mean \(2,\) must be \(3,\)"),
        ({"std": [1.0, 2.0, np.nan]}, "std .* finite"),
        ({"std": [1.0, 2.0, 0.0]}, "std must be positive"),
        ({"latent_size": 0}, "latent_size=0"),
        ({"max_frames": 0}, "max_frames=0"),
    ],
)
def test_what_cannot_be_is_refused_at_once(changes, message):
    with pytest.raises(ArgumentError, match=message):
        adapter(**changes)


def test_functions_that_give_other_vectors_are_named():
    rows = [np.zeros((4, 3), np.float32)]
    with pytest.raises(BundleError, match=r"sums: float32 \(1, 2\), not vectors \(1, 3\)"):
        adapter(motions=lambda features, lengths: features.sum(axis=1)[:, :2]).encode_features(rows)
    with pytest.raises(BundleError, match=r"sums: int64 \(1, 3\)"):
        adapter(texts=lambda ids, mask: np.ones((len(ids), 3), np.int64)).encode_texts(["a"])
    with pytest.raises(ArgumentError, match="must be"):
        adapter().encode_features([np.zeros((4, 2), np.float32)])
