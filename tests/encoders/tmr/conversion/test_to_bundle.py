"""Exported graphs give what torch gives, at any batch and length, whatever the padding holds."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
onnx = pytest.importorskip("onnx")
pytestmark = pytest.mark.torch

from encoders.bundle.bundle import Bundle, open_session  # noqa: E402
from encoders.bundle.manifest import digest  # noqa: E402
from encoders.errors import BundleError  # noqa: E402
from encoders.features.registry import FEATURE_KINDS  # noqa: E402
from encoders.tmr.conversion.onnx_graph import motion_graph, text_graph  # noqa: E402
from encoders.tmr.conversion.quantise import MIDDLE, int4_rows, int8_rows  # noqa: E402
from encoders.tmr.conversion.to_bundle import export_bundle  # noqa: E402
from encoders.tmr.model.network import TMR, TransformerConfig, TransformerEncoder, valid_mask  # noqa: E402
from encoders.tmr.text.language_model import LanguageModel  # noqa: E402
from encoders.tmr.training.recipe import default_network  # noqa: E402
from tests.encoders.tiny_bundle import tiny_language, tiny_network, write  # noqa: E402

SIZE = FEATURE_KINDS["body"].size


def run(graph: onnx.ModelProto, folder: Path, **feed: np.ndarray) -> np.ndarray:
    path = folder / "graph.onnx"
    onnx.save(graph, path)
    return open_session(path, threads=1).run(None, feed)[0]


@dataclass(frozen=True)
class MotionCase:
    """An encoder whose every size differs from every other, and its normaliser."""

    encoder: TransformerEncoder
    mean: np.ndarray
    std: np.ndarray

    def torch(self, features: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        x = torch.from_numpy((features - self.mean) / self.std)
        return self.encoder.mean(x, valid_mask(torch.from_numpy(lengths), x.shape[1])).detach().numpy()

    def graph(self, **options: bool) -> onnx.ModelProto:
        return motion_graph(self.encoder, self.mean, self.std, **options)


@pytest.fixture(scope="module", params=[(1, 24), (4, 10)], ids=["one frame a token", "four, latent projected"])
def motion(request) -> MotionCase:
    torch.manual_seed(0)
    frames_per_token, latent = request.param
    config = TransformerConfig(9, width=24, layers=2, heads=3, feedforward=100, frames_per_token=frames_per_token)
    rng = np.random.default_rng(0)
    mean, std = rng.normal(size=9).astype(np.float32), rng.uniform(0.1, 2, 9).astype(np.float32)
    return MotionCase(TransformerEncoder(config, latent).eval(), mean, std)


@dataclass(frozen=True)
class TextCase:
    """A language model and an encoder on top."""

    language: LanguageModel
    encoder: TransformerEncoder

    def torch(self, ids: np.ndarray, mask: np.ndarray) -> np.ndarray:
        valid = torch.from_numpy(mask) > 0
        return self.encoder.mean(self.language.network(torch.from_numpy(ids), valid), valid).detach().numpy()

    def graph(self, **options: bool) -> onnx.ModelProto:
        return text_graph(self.encoder, self.language.network, self.language.max_tokens, **options)


@pytest.fixture(scope="module")
def text() -> TextCase:
    torch.manual_seed(0)
    return TextCase(tiny_language(width=64), tiny_network(SIZE, token_features=64).text_encoder)


@pytest.mark.parametrize(("batch", "frames"), [(1, 1), (1, 4), (3, 5), (5, 33), (2, 200), (17, 64), (1, 2000)])
def test_the_motion_graph_equals_torch_at_any_shape(motion, tmp_path, batch, frames):
    rng = np.random.default_rng(1)
    features = rng.normal(size=(batch, frames, 9)).astype(np.float32)
    lengths = rng.integers(1, frames + 1, batch)
    actual = run(motion.graph(), tmp_path, features=features, lengths=lengths)
    np.testing.assert_allclose(actual, motion.torch(features, lengths), rtol=0, atol=1e-5)


@pytest.mark.parametrize(("batch", "tokens"), [(1, 1), (1, 2), (4, 7), (3, 32), (33, 12)])
def test_the_text_graph_equals_torch_at_any_shape(text, tmp_path, batch, tokens):
    rng = np.random.default_rng(1)
    ids = rng.integers(0, 100, (batch, tokens))
    mask = (np.arange(tokens) < rng.integers(1, tokens + 1, batch)[:, None]).astype(np.int64)
    actual = run(text.graph(), tmp_path, input_ids=ids, attention_mask=mask)
    np.testing.assert_allclose(actual, text.torch(ids, mask), rtol=0, atol=1e-5)


@pytest.mark.parametrize(("int8", "tolerance"), [(False, 1e-5), (True, 1e-4)])
def test_padding_changes_nothing(motion, text, tmp_path, int8, tolerance):
    rng = np.random.default_rng(2)
    lengths = np.array([1, 3, 4, 9, 30])
    graph = motion.graph(int8=int8)
    features = 100 * rng.normal(size=(5, 30, 9)).astype(np.float32)
    together = run(graph, tmp_path, features=features, lengths=lengths)
    for row, length in enumerate(lengths):
        alone = run(graph, tmp_path, features=features[row : row + 1, :length], lengths=lengths[row : row + 1])
        np.testing.assert_allclose(together[row], alone[0], rtol=0, atol=tolerance)

    graph = text.graph(int8=int8)
    ids = rng.integers(1, 100, (5, 30))
    mask = (np.arange(30) < lengths[:, None]).astype(np.int64)
    together = run(graph, tmp_path, input_ids=ids, attention_mask=mask)
    for row, length in enumerate(lengths):
        one = {"input_ids": ids[row : row + 1, :length], "attention_mask": mask[row : row + 1, :length]}
        np.testing.assert_allclose(together[row], run(graph, tmp_path, **one)[0], rtol=0, atol=tolerance)


def test_int8_rounds_to_the_nearest_of_255_steps_a_row():
    weights = np.random.default_rng(0).normal(size=(48, 64)) * np.geomspace(1e-3, 1e3, 48)[:, None]
    weights[7] = 0
    values, scales = int8_rows(weights.astype(np.float32))
    assert values.dtype == np.int8
    assert np.abs(values.astype(int)).max() == 127
    assert (np.abs(values * scales[:, None] - weights) <= scales[:, None] / 2 * 1.001).all()


def test_int4_rounds_to_one_of_16_steps_a_block_and_holds_what_is_far_out():
    weights = np.random.default_rng(0).normal(size=(48, 64)).astype(np.float32) * np.geomspace(1e-3, 1e2, 48)[:, None]
    weights[7] = 0
    packed, scales = int4_rows(weights.astype(np.float32), 16)
    assert (packed.shape, packed.dtype) == ((48, 32), np.uint8)
    assert (scales.shape, scales.dtype) == ((48, 4), np.float16)
    steps = np.concatenate([packed & 15, packed >> 4], axis=1).astype(np.float32)
    wide = scales.astype(np.float32).repeat(16, axis=1)
    error = np.abs((steps - MIDDLE) * wide - weights)
    inside = np.abs(weights) <= 8 * wide
    assert (error[inside] <= 0.5 * wide[inside] * 1.01).all()
    assert inside.mean() > 0.9
    assert np.abs(error[7]).max() < 1e-3
    assert np.square(error).sum() < 0.012 * np.square(weights).sum()


def test_int8_graphs_are_small_and_near(text, tmp_path):
    graph, small = text.graph(), text.graph(int8=True)
    assert not [
        tensor.name
        for tensor in small.graph.initializer
        if tensor.data_type == onnx.TensorProto.FLOAT and np.prod(tensor.dims) > 2048
    ]
    rng = np.random.default_rng(0)
    ids, mask = rng.integers(1, 100, (16, 12)), np.ones((16, 12), np.int64)
    full, near = (run(g, tmp_path, input_ids=ids, attention_mask=mask) for g in (graph, small))
    cosine = (full * near).sum(1) / np.linalg.norm(full, axis=1) / np.linalg.norm(near, axis=1)
    assert cosine.min() > 0.999


def test_a_layer_of_another_kind_is_refused(motion):
    encoder = TransformerEncoder(motion.encoder.config, motion.encoder.latent)
    encoder.seqTransEncoder.layers[0] = torch.nn.Identity()
    with pytest.raises(TypeError, match="Identity"):
        motion_graph(encoder, motion.mean, motion.std)


def test_a_bundle_is_whole_and_loads(tmp_path):
    folder = write(tmp_path / "bundle")
    assert sorted(file.name for file in folder.iterdir()) == [
        "manifest.json",
        "motion.onnx",
        "text.onnx",
        "tokenizer.json",
    ]
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["files"] == {name: digest(folder / name) for name in manifest["files"]}
    assert manifest["language_model"] == "tiny"
    bundle = Bundle.load(folder)
    assert bundle.encode_texts(["walk"]).shape == (1, bundle.latent_size)
    assert [path.name for path in tmp_path.iterdir()] == ["bundle"]


def test_a_bundle_gives_what_its_networks_give(tmp_path):
    torch.manual_seed(0)
    language, network = tiny_language(), tiny_network(SIZE)
    rng = np.random.default_rng(0)
    mean, std = rng.normal(size=SIZE).astype(np.float32), rng.uniform(0.1, 2, SIZE).astype(np.float32)
    options = {
        "motion_encoder": network.motion_encoder,
        "text_encoder": network.text_encoder,
        "language": language,
        "mean": mean,
        "std": std,
        "feature_kind": "body",
        "max_frames": 80,
        "calibration": {"background": np.arange(3)},
    }
    bundle = Bundle.load(export_bundle(tmp_path / "bundle", name="first", weights="float32", **options))
    features = [rng.normal(size=(length, SIZE)).astype(np.float32) for length in (7, 50, 21)]
    for sequence, latent in zip(features, bundle.encode_features(features), strict=True):
        x = torch.from_numpy((sequence - mean) / std)[None]
        expected = network.motion_encoder.mean(x, torch.ones(1, len(sequence), dtype=torch.bool))
        np.testing.assert_allclose(latent, torch.nn.functional.normalize(expected)[0], rtol=0, atol=1e-5)
    sentences = ["a person walks forward", "jumps"]
    for tokens, latent in zip(language.token_features(sentences), bundle.encode_texts(sentences), strict=True):
        expected = network.text_encoder.mean(
            torch.from_numpy(tokens)[None], torch.ones(1, len(tokens), dtype=torch.bool)
        )
        np.testing.assert_allclose(latent, torch.nn.functional.normalize(expected)[0], rtol=0, atol=1e-5)
    assert bundle.calibration["background"].tolist() == [0, 1, 2]

    again = Bundle.load(export_bundle(tmp_path / "bundle", name="second", **options | {"calibration": None}))
    assert (again.name, again.calibration) == ("second", None)
    with pytest.raises(ValueError, match="must be"):
        export_bundle(tmp_path / "bundle", name="third", **options | {"mean": mean[:-1]})
    assert Bundle.load(tmp_path / "bundle").name == "second"


@pytest.mark.slow
def test_the_default_sizes_stay_small_and_true_to_fp32(tmp_path):
    """Real language model, random encoders: under 40 MB in all, cosine to fp32 above 0.999, padding-proof to 1e-4."""
    try:
        language = LanguageModel.load()
    except BundleError as error:
        pytest.skip(str(error))
    torch.manual_seed(0)
    network = TMR(default_network(SIZE, language.width)).eval().requires_grad_(False)
    bundle = Bundle.load(
        export_bundle(
            tmp_path / "bundle",
            name="random",
            motion_encoder=network.motion_encoder,
            text_encoder=network.text_encoder,
            language=language,
            mean=np.zeros(SIZE, np.float32),
            std=np.ones(SIZE, np.float32),
            feature_kind="body",
            max_frames=100,
        )
    )
    assert sum(file.stat().st_size for file in bundle.folder.iterdir()) < 25e6
    sentences = [
        "a person walks forward then turns left",
        "jump",
        "someone waves with both hands while stepping slowly backwards, then bows and sits down on a low chair",
        "a man limps to the right",
        "the figure cartwheels",
        "Invoice for March 2024, naïve café №5",
    ]
    together = bundle.encode_texts(sentences)
    full = []
    for tokens in language.token_features(sentences):
        latent = network.text_encoder.mean(torch.from_numpy(tokens)[None], torch.ones(1, len(tokens), dtype=torch.bool))
        full.append(torch.nn.functional.normalize(latent)[0].numpy())
    assert (together * full).sum(axis=1).min() > 0.998
    # Random encoders put all sentences near one place: what sets them apart must survive as well.
    error = np.linalg.norm(together - full, axis=1)
    spread = np.linalg.norm(full - np.mean(full, axis=0), axis=1)
    assert (error / spread).max() < 0.1
    for sentence, latent in zip(sentences, together, strict=True):
        alone = Bundle.load(bundle.folder).encode_texts([sentence])[0]
        np.testing.assert_allclose(alone, latent, rtol=0, atol=1e-4)
