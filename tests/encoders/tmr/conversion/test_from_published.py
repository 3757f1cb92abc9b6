"""The networks and losses give the published numbers, from the published files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.errors import BundleError  # noqa: E402
from encoders.tmr.conversion import from_published  # noqa: E402
from encoders.tmr.model.network import TMR, TMRConfig, positions, valid_mask  # noqa: E402
from encoders.tmr.training import losses  # noqa: E402
from encoders.tmr.training.false_negatives import similar_sentences  # noqa: E402
from encoders.tmr.training.objective import published_terms  # noqa: E402
from tests.encoders.published_layout import DATA, write_run  # noqa: E402

CLOSE = {"rtol": 0, "atol": 1e-5}


@pytest.fixture(scope="module")
def excerpt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The published run as its code writes it, with a decoder of random weights: the excerpt leaves that out."""
    return write_run(tmp_path_factory.mktemp("published") / "run")


@pytest.mark.parametrize(("side", "letter"), [("motion", "m"), ("text", "t")])
def test_encoders_of_a_published_run_give_the_published_gaussians(excerpt, side, letter):
    encoder = getattr(from_published.load_run(excerpt), f"{side}_encoder")
    with np.load(DATA / "published_losses.npz", allow_pickle=False) as arrays:
        x, mask = arrays[f"{side}/x"].astype(np.float32), arrays[f"{side}/mask"]
        mu, logvar = (arrays[f"dist/{letter}_{name}"][: len(x)] for name in ("mu", "logvar"))
    gaussian = encoder(torch.from_numpy(x), torch.from_numpy(mask))
    close(gaussian.mu, mu)
    close(gaussian.logvar, logvar)
    close(encoder.mean(torch.from_numpy(x[:1]), torch.from_numpy(mask[:1])), mu[:1])


def test_the_objective_of_a_published_run_is_read(excerpt):
    weights, temperature, threshold = from_published.read_weights(excerpt)
    assert weights == losses.LossWeights()
    assert (temperature, threshold) == (0.1, 0.8)


@pytest.fixture(scope="module")
def network(golden: Path) -> TMR:
    return from_published.load_run(golden / "published_run")


@pytest.fixture(scope="module")
def io(golden: Path) -> dict[str, np.ndarray]:
    with np.load(golden / "published_run_io.npz") as arrays:
        return dict(arrays)


@pytest.fixture(scope="module")
def loss_inputs(golden: Path) -> dict[str, np.ndarray]:
    with np.load(golden / "losses_in.npz") as arrays:
        return dict(arrays)


@pytest.fixture(scope="module")
def expected(golden: Path) -> dict:
    return json.loads((golden / "losses_out.json").read_text())


def tensors(arrays: dict[str, np.ndarray], *names: str) -> list:
    return [torch.from_numpy(arrays[name]) for name in names]


def similar(sentences: torch.Tensor, threshold: float) -> torch.Tensor:
    return torch.from_numpy(similar_sentences(sentences.numpy(), threshold))


def close(actual, expected) -> None:
    np.testing.assert_allclose(np.asarray(actual), expected, **CLOSE)


@pytest.mark.parametrize("side", ["motion", "text"])
def test_encoders_give_the_published_gaussians(network, io, side):
    encoder = getattr(network, f"{side}_encoder")
    x, mask = tensors(io, f"{side}/x", f"{side}/mask")
    gaussian = encoder(x, mask)
    close(gaussian.mu, io[f"{side}/mu"])
    close(gaussian.logvar, io[f"{side}/logvar"])
    close(gaussian.mu, io[f"{side}/mu_f64"])
    close(gaussian.logvar, io[f"{side}/logvar_f64"])
    close(encoder.mean(x, mask), io[f"{side}/latent_sample_mean"])


def test_an_item_alone_gives_what_it_gives_in_a_batch(network, io):
    for x, length, mu in zip(io["motion/x"], io["motion/length"], io["motion/mu_single"], strict=True):
        alone = torch.from_numpy(x[None, :length])
        close(network.motion_encoder.mean(alone, torch.ones(1, length, dtype=torch.bool))[0], mu)


def test_lengths_and_masks_say_the_same(io):
    for side in ("motion", "text"):
        (lengths,) = tensors(io, f"{side}/length")
        np.testing.assert_array_equal(valid_mask(lengths, io[f"{side}/x"].shape[1]), io[f"{side}/mask"])


def test_the_decoder_gives_the_published_motions(network, io, golden):
    (mask,) = tensors(io, "motion/mask")
    for source in ("motion", "text"):
        (latent,) = tensors(io, f"{source}/mu")
        close(network.motion_decoder(latent, mask), io[f"decoder/from_{source}_mu"])
    latent, lengths = tensors(io, "decoder/random_z", "decoder/random_z_lengths")
    close(network.motion_decoder(latent, valid_mask(lengths, 20)), io["decoder/random_z_out"])

    mean, std = from_published.load_stats(golden / "published_dataset/stats/humanml3d/guoh3dfeats")
    decoded = network.motion_decoder(torch.from_numpy(io["motion/mu"][:2]), mask[:2]).numpy()
    close(decoded * (std + 1e-12) + mean, io["decoder/from_motion_mu_denormalized"])


def test_positions_and_similarities_are_the_published_ones(network, io):
    close(positions(256, 64), io["pe/64"])
    text, motion = (
        torch.nn.functional.normalize(
            getattr(network, f"{side}_encoder").mean(*tensors(io, f"{side}/x", f"{side}/mask"))
        )
        for side in ("text", "motion")
    )
    close(text @ motion.T, io["sim/text_x_motion"])
    close((text @ motion.T) / 2 + 0.5, io["score/text_x_motion"])


def terms_of(network: TMR, arrays: dict[str, np.ndarray], mode: str) -> dict:
    motion_x, motion_mask, text_x, text_mask, sentences = tensors(
        arrays, "motion/x", "motion/mask", "text/x", "text/mask", "sent_emb"
    )
    noise = tensors(arrays, "sampled/eps_text", "sampled/eps_motion")
    if mode == "sample_mean":
        noise = [torch.zeros_like(one) for one in noise]
    return published_terms(
        network,
        (motion_x, motion_mask),
        (text_x, text_mask),
        temperature=0.1,
        ignore=similar(sentences, 0.8),
        noise=tuple(noise),
    )


@pytest.mark.parametrize("mode", ["sample_mean", "sampled"])
def test_every_loss_and_gradient_is_the_published_one(golden, loss_inputs, expected, mode):
    network = from_published.load_run(golden / "published_run").requires_grad_()
    terms = terms_of(network, loss_inputs, mode)
    weights, _, _ = from_published.read_weights(golden / "published_run")
    loss = losses.total(terms, weights)
    names = {"recons": "reconstruction", "kl": "kl", "latent": "latent", "contrastive": "contrastive"}
    for theirs, ours in names.items():
        close(terms[ours].detach(), expected[mode][theirs])
    close(loss.detach(), expected[mode]["loss"])

    loss.backward()
    gradients = {name: parameter.grad for name, parameter in network.named_parameters()}
    for name, norm in expected[f"{mode}_gradnorms"].items():
        close(gradients[name].norm(), norm)
    total = torch.stack([gradient.norm() for gradient in gradients.values()]).norm()
    close(total, expected[f"{mode}_gradnorm_total"])
    for key, gradient in loss_inputs.items():
        if key.startswith(f"grad_{mode}/"):
            close(gradients[key.split("/")[1]], gradient)


def test_the_parts_of_a_loss_are_the_published_ones(network, loss_inputs, expected):
    text = losses.Gaussian(*tensors(loss_inputs, "dist/t_mu", "dist/t_logvar"))
    motion = losses.Gaussian(*tensors(loss_inputs, "dist/m_mu", "dist/m_logvar"))
    standard = losses.Gaussian(torch.zeros_like(text.mu), torch.zeros_like(text.mu))
    kinds = {"text": text, "motion": motion, "N01": standard}
    for name, value in expected["kl_terms"].items():
        p, q = name.removeprefix("kl(").removesuffix(")").split("||")
        close(losses.kl(kinds[p], kinds[q]), value)

    target, mask = tensors(loss_inputs, "motion/x", "motion/mask")
    for mode in ("sample_mean", "sampled"):
        for source, value in expected[f"{mode}_recons_terms"].items():
            (latent,) = tensors(loss_inputs, f"{mode}/{source[0]}_latents")
            close(losses.reconstruction(target, network.motion_decoder(latent, mask)), value)


def test_three_steps_of_adamw_follow_the_published_path(golden, loss_inputs, expected):
    network = from_published.load_run(golden / "published_run").requires_grad_()
    optimiser = torch.optim.AdamW(network.parameters(), lr=1e-4)
    path = []
    for _ in range(4):
        loss = losses.total(terms_of(network, loss_inputs, "sample_mean"), losses.LossWeights())
        path.append(loss.item())
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    close(path, expected["adamw_3_steps_total_loss"])


def test_the_default_sizes_are_the_published_models_tensors(golden):
    shapes = json.loads((golden / "published_shapes.json").read_text())["shapes"]
    network = TMR(TMRConfig())
    for module, tensors_of in shapes.items():
        ours = {name: list(tensor.shape) for name, tensor in getattr(network, module).state_dict().items()}
        assert ours == tensors_of


def test_a_stored_clip_and_sentence_score_as_published(network, golden):
    encoded = golden / "published_run/encoded"
    clip, sentence = (np.load(encoded / f"{name}.npy") for name in ("012314", "a_person_jumps_up_and_then_stops"))
    cosine = clip @ sentence / np.linalg.norm(clip) / np.linalg.norm(sentence)
    assert cosine / 2 + 0.5 == pytest.approx(0.489, abs=1e-3)


@pytest.mark.parametrize("damage", ["no config", "no weights", "not tensors", "other sizes"])
def test_a_damaged_run_is_named(excerpt, tmp_path, damage):
    run = tmp_path / "run"
    (run / "last_weights").mkdir(parents=True)
    config = json.loads((excerpt / "config.json").read_text())
    if damage == "other sizes":
        config["model"]["motion_encoder"]["ff_size"] = 96
    if damage != "no config":
        (run / "config.json").write_text(json.dumps(config))
    if damage != "no weights":
        for name in from_published.MODULES:
            weights = (excerpt / f"last_weights/{name}.pt").read_bytes()
            (run / f"last_weights/{name}.pt").write_bytes(b"no pickle" if damage == "not tensors" else weights)
    with pytest.raises(BundleError, match=str(run)):
        from_published.load_run(run)
