"""A generator from training to motions: losses, graphs as the networks, bundles that keep their libraries."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.bundle.bundle import Bundle  # noqa: E402
from encoders.bundle.generator import MotionGenerator  # noqa: E402
from encoders.bundle.sessions import open_session  # noqa: E402
from encoders.tmr.conversion.decoder_graph import decoder_graph, gaussian_graph  # noqa: E402
from encoders.tmr.conversion.to_bundle import export_bundle  # noqa: E402
from encoders.tmr.conversion.with_decoder import add_generator  # noqa: E402
from encoders.tmr.model.network import TMR, TMRConfig, TransformerConfig, valid_mask  # noqa: E402
from encoders.tmr.model.normaliser import Normaliser  # noqa: E402
from encoders.tmr.synthesis.captioned_motions import CaptionedMotions, captioned_motions  # noqa: E402
from encoders.tmr.synthesis.motion_vae import MotionVAE, VAEConfig  # noqa: E402
from encoders.tmr.synthesis.vae_training import VAERecipe, label_gaussians, train_vae  # noqa: E402
from encoders.tmr.training.pairs import Pair, PairStore  # noqa: E402
from tests.encoders.tiny_bundle import tiny_language  # noqa: E402
from tests.search.conftest import made_motion  # noqa: E402

SIZES = {"latent": 8, "width": 16, "layers": 2, "feedforward": 24, "frames_per_token": 3}


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> Bundle:
    return Bundle.load(tiny_bundle)


@pytest.fixture(scope="module")
def data(bundle: Bundle) -> CaptionedMotions:
    features = [bundle.features(made_motion(3.0 + i % 3, i)) for i in range(12)]
    pairs = [
        Pair(rows, (f"a person {'walks' if i % 2 else 'jumps'}",), facts=frozenset({"walk" if i % 2 else "jump"}))
        for i, rows in enumerate(features)
    ]
    return captioned_motions([PairStore(pairs)], bundle, bundle.max_frames)


@pytest.fixture(scope="module")
def model(bundle: Bundle, data: CaptionedMotions) -> MotionVAE:
    torch.manual_seed(0)
    return MotionVAE(VAEConfig(data.motions[0].shape[1], bundle.latent_size, **SIZES)).eval().requires_grad_(False)


def test_graphs_give_what_the_networks_give(tmp_path: Path, model: MotionVAE, bundle: Bundle) -> None:
    import onnx

    size = model.config.features
    rng = np.random.default_rng(0)
    mean, std = rng.normal(size=size).astype(np.float32), rng.uniform(1, 2, size).astype(np.float32)
    onnx.save(decoder_graph(model.motion_decoder, mean, std), tmp_path / "decoder.onnx")
    onnx.save(gaussian_graph(model.text_gaussian), tmp_path / "sentences.onnx")
    latent, lengths = rng.normal(size=(4, 8)).astype(np.float32), np.array([7, 4, 12, 1])
    (found,) = open_session(tmp_path / "decoder.onnx").run(["features"], {"latent": latent, "lengths": lengths})
    want = model.motion_decoder(torch.from_numpy(latent), valid_mask(torch.from_numpy(lengths), 12)).numpy()
    for row, other, length in zip(found, want, lengths, strict=True):
        assert np.allclose(row[:length], other[:length] * std + mean, atol=1e-5)
    vectors = bundle.encode_texts(["a person walks", "someone jumps"])
    mu, logvar = open_session(tmp_path / "sentences.onnx").run(["mu", "logvar"], {"vector": vectors})
    gaussian = model.text_gaussian(torch.from_numpy(vectors))
    assert np.allclose(mu, gaussian.mu, atol=1e-5)
    assert np.allclose(logvar, gaussian.logvar, atol=1e-5)


def test_training_learns_and_goes_on_where_it_was_stopped(tmp_path: Path, data: CaptionedMotions) -> None:
    normaliser = Normaliser.of(np.concatenate([rows.astype(np.float32) for rows in data.motions]))
    said: list[str] = []
    recipe = VAERecipe(steps=30, batch=12, warmup=5, rate=3e-3, reported=30, sizes=SIZES)
    _, steps = train_vae(tmp_path, data, normaliser, recipe, say=said.append)
    _, more = train_vae(tmp_path, data, normaliser, replace(recipe, steps=60), say=said.append)
    assert (steps, more) == (30, 60)
    errors = [float(line.split("reconstruction ")[1].split()[0]) for line in said]
    assert errors[1] < 0.8 * errors[0], said


def test_a_bundle_with_a_decoder_is_the_same_model_and_makes_motions(
    tmp_path: Path, model: MotionVAE, data: CaptionedMotions, bundle: Bundle
) -> None:
    normaliser = Normaliser.of(np.concatenate([rows.astype(np.float32) for rows in data.motions]))
    labels = label_gaussians(model, data, normaliser)
    assert labels[0] == ["jump", "walk"]
    made = Bundle.load(add_generator(bundle.folder, tmp_path / "made", model, normaliser, labels, {"steps": 1}))
    assert made.fingerprint == bundle.fingerprint
    assert made.manifest["generator"] == {"steps": 1}
    generator = MotionGenerator(made)
    gaussian = generator.of_sentence("a person walks")
    first, second = generator.motions(gaussian, 2.0, 2, np.random.default_rng(0))
    assert (first.fps, len(first)) == (20.0, 39), "20 feature frames at 10 a second"
    assert not np.allclose(first.joints, second.joints)
    assert generator.motions(gaussian, 2.0, 1, np.random.default_rng(0))[0] == first
    assert len(generator.motions(generator.of_label("walk"), 1.0, 1, np.random.default_rng(0))) == 1


def test_a_published_run_samples_from_its_text_encoder(tmp_path: Path) -> None:
    torch.manual_seed(1)
    language = tiny_language()
    small = {"width": 16, "layers": 2, "heads": 4, "feedforward": 24}
    network = TMR(
        TMRConfig(
            motion=TransformerConfig(features=263, **small),
            text=TransformerConfig(features=language.width, **small),
            decoder=TransformerConfig(features=263, **small),
            latent=16,
        )
    )
    network.eval().requires_grad_(False)
    folder = export_bundle(
        tmp_path / "published",
        name="published",
        motion_encoder=network.motion_encoder,
        text_encoder=network.text_encoder,
        language=language,
        mean=np.zeros(263, np.float32),
        std=np.ones(263, np.float32),
        feature_kind="humanml3d",
        max_frames=200,
        weights="float32",
        decoder=network.motion_decoder,
    )
    bundle = Bundle.load(folder)
    gaussian = MotionGenerator(bundle).of_sentence("a person walks")
    (tokens,) = language.token_features(["a person walks"])
    x = torch.from_numpy(np.asarray(tokens, np.float32))[None]
    want = network.text_encoder(x, torch.ones(1, x.shape[1], dtype=torch.bool))
    assert np.allclose(gaussian.mu, want.mu[0], atol=1e-4)
    assert np.allclose(gaussian.logvar, want.logvar[0], atol=1e-4)
    (vector,) = bundle.encode_texts(["a person walks"])
    assert np.allclose(vector, gaussian.mu / np.linalg.norm(gaussian.mu), atol=1e-5)
    (motion,) = MotionGenerator(bundle).motions(gaussian, 3.0, 1, np.random.default_rng(0))
    assert len(motion) == 60


def test_a_published_decoder_decodes_as_published(tmp_path: Path, golden: Path) -> None:
    import onnx

    from encoders.tmr.conversion.from_published import load_run

    decoder = load_run(golden / "published_run").motion_decoder
    assert decoder is not None
    onnx.save(decoder_graph(decoder, np.zeros(263), np.ones(263)), tmp_path / "decoder.onnx")
    session = open_session(tmp_path / "decoder.onnx")
    with np.load(golden / "published_run_io.npz") as want:
        for latent, lengths, out in (
            ("decoder/random_z", "decoder/random_z_lengths", "decoder/random_z_out"),
            ("motion/mu", "motion/length", "decoder/from_motion_mu"),
            ("text/mu", "motion/length", "decoder/from_text_mu"),
        ):
            feed = {"latent": want[latent], "lengths": want[lengths].astype(np.int64)}
            (found,) = session.run(["features"], feed)
            for row, other, length in zip(found, want[out], feed["lengths"], strict=True):
                assert np.allclose(row[:length], other[:length], atol=1e-4)
