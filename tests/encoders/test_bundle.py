"""The bundle at work, on a bundle of random weights: no torch is needed, and none is loaded."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.batching import length_buckets, pad
from encoders.bundle.bundle import Bundle, half_overlapping
from encoders.bundle.manifest import REQUIRED, digest
from encoders.errors import BundleError
from encoders.features.registry import FEATURE_KINDS
from encoders.motion import Motion
from encoders.protocol import Encoder

SIZE = FEATURE_KINDS["body"].size


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> Bundle:
    return Bundle.load(tiny_bundle, threads=1)


@pytest.fixture
def copy(tiny_bundle: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(tiny_bundle, tmp_path / "bundle"))


def change(folder: Path, **values: object) -> None:
    """Rewrite the manifest with other values; None takes a key out."""
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text()) | values
    path.write_text(json.dumps({key: value for key, value in manifest.items() if value is not None}))


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
    np.testing.assert_allclose(bundle._encode(padded, np.array([10])), bundle.encode_features([features]), atol=1e-5)


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
    with pytest.raises(ValueError, match="must lie inside"):
        bundle.encode_windows(sequences(300)[0], np.array(starts), length)


def test_motions_are_encoded_through_their_features(bundle):
    motions = [walk(60), walk(30, fps=30.0), walk(1)]
    latents = bundle.encode_motions(motions)
    np.testing.assert_allclose(latents, bundle.encode_features([bundle.features(m) for m in motions]), atol=1e-6)


def test_a_long_motion_is_the_mean_of_half_overlapping_windows(bundle):
    motion = walk(450)
    features = bundle.features(motion)
    assert len(features) == 225
    starts = half_overlapping(225, 100)
    assert starts.tolist() == [0, 50, 100, 125]
    mean = bundle.encode_windows(features, starts, 100).mean(axis=0)
    short = walk(40, seed=2)
    latents = bundle.encode_motions([short, motion])
    np.testing.assert_allclose(latents[1], mean / np.linalg.norm(mean), atol=1e-6)
    np.testing.assert_allclose(latents[0], bundle.encode_motions([short])[0], atol=1e-5)


@pytest.mark.parametrize("frames", [1, 99, 100, 101, 149, 150, 151, 1000])
def test_half_overlapping_windows_cover_every_frame(frames):
    starts = half_overlapping(frames, 100)
    covered = np.zeros(frames, bool)
    for start in starts:
        covered[start : start + 100] = True
    assert covered.all()
    assert starts[-1] == max(frames - 100, 0)
    assert (np.diff(starts) > 0).all()


def test_sentences_give_the_same_together_and_alone(bundle):
    sentences = ["a person walks", "jump", "a woman sits down and then stands up slowly", "", "walk " * 200]
    together = bundle.encode_texts(sentences)
    assert together.shape == (5, 24)
    np.testing.assert_allclose(np.linalg.norm(together, axis=1), 1, atol=1e-6)
    fresh = Bundle.load(bundle.folder)
    for sentence, latent in zip(sentences, together, strict=True):
        np.testing.assert_allclose(fresh.encode_texts([sentence])[0], latent, atol=1e-5)
    assert bundle.encode_texts([]).shape == (0, 24)


def test_sentences_asked_again_are_remembered_and_only_so_many(bundle, monkeypatch):
    fresh = Bundle.load(bundle.folder)
    asked: list[str] = []
    encode = fresh._encode_new_texts
    monkeypatch.setattr(fresh, "_encode_new_texts", lambda new: asked.extend(new) or encode(new))
    first = fresh.encode_texts(["jump", "run", "jump"])
    again = fresh.encode_texts(["run", "sit", "jump"])
    assert asked == ["jump", "run", "sit"]
    np.testing.assert_array_equal(first[[1, 0]], again[[0, 2]])
    monkeypatch.setattr("encoders.bundle.bundle._SENTENCES_KEPT", 2)
    fresh.encode_texts(["kick"])
    fresh.encode_texts(["run"])
    assert asked == ["jump", "run", "sit", "kick", "run"]


@pytest.mark.parametrize("shape", [(0, SIZE), (5, SIZE - 1), (5,), (1, 5, SIZE)])
def test_features_of_another_shape_are_refused(bundle, shape):
    with pytest.raises(ValueError, match="must be"):
        bundle.encode_features([np.zeros(shape, np.float32)])


def test_nothing_encodes_to_nothing(bundle):
    assert bundle.encode_features([]).shape == (0, 24)
    assert bundle.encode_motions([]).shape == (0, 24)


def test_buckets_hold_every_item_once_within_the_budget_with_little_padding():
    lengths = np.random.default_rng(0).integers(1, 200, 1000).tolist()
    batches = list(length_buckets(lengths, 2000))
    assert sorted(np.concatenate(batches)) == list(range(1000))
    sizes = [[lengths[i] for i in batch] for batch in batches]
    assert all(max(batch) * len(batch) <= 2000 for batch in sizes)
    assert all(max(batch) * len(batch) <= 1.15 * sum(batch) for batch in sizes)
    assert [batch.tolist() for batch in length_buckets([10], 5)] == [[0]]
    assert list(length_buckets([], 5)) == []


def test_padding_is_zeros_at_the_end():
    padded, lengths = pad([np.ones((2, 3), np.float32), np.ones((4, 3), np.float32)])
    assert padded.shape == (2, 4, 3)
    assert padded.sum(axis=(1, 2)).tolist() == [6, 12]
    assert lengths.tolist() == [2, 4]


def test_the_fingerprint_follows_what_changes_an_embedding_and_nothing_else(copy, bundle):
    change(copy, licence="another", name="renamed", training={"steps": 3})
    assert Bundle.load(copy).fingerprint == bundle.fingerprint
    change(copy, max_frames=50)
    assert Bundle.load(copy).fingerprint != bundle.fingerprint
    change(copy, max_frames=100)
    (copy / "motion.onnx").write_bytes((copy / "motion.onnx").read_bytes() + b"\0")
    change(copy, files={name: digest(copy / name) for name in REQUIRED})
    assert Bundle.load(copy).fingerprint != bundle.fingerprint


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


@pytest.mark.parametrize("name", REQUIRED)
def test_a_damaged_or_missing_file_is_named(copy, name):
    content = bytearray((copy / name).read_bytes())
    content[len(content) // 2] ^= 1
    (copy / name).write_bytes(content)
    with pytest.raises(BundleError, match=f"{name}: damaged"):
        Bundle.load(copy)
    (copy / name).unlink()
    with pytest.raises(BundleError, match=f"{name}: missing"):
        Bundle.load(copy)


@pytest.mark.parametrize(
    "name", ["../outside.bin", "/etc/hostname", "sub/file", "..", ".", "", "a\\b", "a\0b", "manifest.json"]
)
def test_a_manifest_that_points_elsewhere_is_refused(copy, name):
    (copy.parent / "outside.bin").write_bytes(b"outside")
    files = json.loads((copy / "manifest.json").read_text())["files"]
    change(copy, files=files | {name: "0" * 64})
    with pytest.raises(BundleError, match="no plain file name"):
        Bundle.load(copy)


def test_a_link_out_of_the_folder_is_refused(copy):
    outside = copy.parent / "outside.json"
    (copy / "tokenizer.json").rename(outside)
    (copy / "tokenizer.json").symlink_to(outside)
    with pytest.raises(BundleError, match="no plain file"):
        Bundle.load(copy)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"format": 99}, "format 99, this version reads 1"),
        ({"format": None}, "format None"),
        ({"feature_kind": "astrology"}, "feature kind 'astrology' is unknown; known: .*body"),
        ({"max_frames": "many"}, "'max_frames' is missing or no int"),
        ({"max_frames": True}, "'max_frames' is missing or no int"),
        ({"latent_size": 0}, "must be positive"),
        ({"name": None}, "'name' is missing"),
        ({"files": {}}, "does not list motion.onnx"),
        ({"files": []}, "'files' is missing or no dict"),
    ],
)
def test_a_manifest_that_makes_no_sense_is_refused(copy, values, message):
    change(copy, **values)
    with pytest.raises(BundleError, match=message):
        Bundle.load(copy)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000, " " * 2_000_000])
def test_what_is_no_manifest_is_refused(copy, text):
    (copy / "manifest.json").write_text(text)
    with pytest.raises(BundleError, match=r"manifest\.json"):
        Bundle.load(copy)


def test_a_folder_without_manifest_is_no_bundle(tmp_path):
    with pytest.raises(BundleError, match="no model bundle here"):
        Bundle.load(tmp_path)


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
assert list(bundle._sessions) == ["motion.onnx"] and "tokenizers" not in sys.modules
bundle.encode_texts(["jump"])
assert "torch" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], check=True, cwd=Path(__file__).parents[2])
