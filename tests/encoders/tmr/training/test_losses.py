"""TMR's losses give the published numbers, from an excerpt of them."""

from __future__ import annotations

import json

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.tmr.training import losses  # noqa: E402
from encoders.tmr.training.false_negatives import similar_sentences  # noqa: E402
from tests.conftest import ROOT  # noqa: E402

DATA = ROOT / "tests" / "data"
CLOSE = {"rtol": 0, "atol": 1e-5}


@pytest.fixture(scope="module")
def loss_inputs() -> dict[str, np.ndarray]:
    with np.load(DATA / "published_losses.npz", allow_pickle=False) as arrays:
        return dict(arrays)


@pytest.fixture(scope="module")
def expected() -> dict:
    return json.loads((DATA / "published_losses.json").read_text())


def tensors(arrays: dict[str, np.ndarray], *names: str) -> list:
    return [torch.from_numpy(arrays[name]) for name in names]


def similar(sentences: torch.Tensor, threshold: float) -> torch.Tensor:
    return torch.from_numpy(similar_sentences(sentences.numpy(), threshold))


def close(actual, expected) -> None:
    np.testing.assert_allclose(np.asarray(actual), expected, **CLOSE)


def test_latents_are_drawn_as_published(loss_inputs):
    for side, letter in (("text", "t"), ("motion", "m")):
        gaussian = losses.Gaussian(*tensors(loss_inputs, f"dist/{letter}_mu", f"dist/{letter}_logvar"))
        (noise,) = tensors(loss_inputs, f"sampled/eps_{side}")
        close(gaussian.mu, loss_inputs[f"sample_mean/{letter}_latents"])
        close(gaussian.sample(noise), loss_inputs[f"sampled/{letter}_latents"])


@pytest.mark.parametrize("mode", ["sample_mean", "sampled"])
def test_the_terms_between_latents_are_the_published_ones(loss_inputs, expected, mode):
    text, motion, sentences = tensors(loss_inputs, f"{mode}/t_latents", f"{mode}/m_latents", "sent_emb")
    close(losses.latent_loss(text, motion), expected[mode]["latent"])
    close(losses.contrastive(text, motion, 0.1, similar(sentences, 0.8)), expected[mode]["contrastive"])


def test_every_divergence_is_the_published_one(loss_inputs, expected):
    text = losses.Gaussian(*tensors(loss_inputs, "dist/t_mu", "dist/t_logvar"))
    motion = losses.Gaussian(*tensors(loss_inputs, "dist/m_mu", "dist/m_logvar"))
    standard = losses.Gaussian(torch.zeros_like(text.mu), torch.zeros_like(text.mu))
    kinds = {"text": text, "motion": motion, "N01": standard}
    for name, value in expected["kl_terms"].items():
        p, q = name.removeprefix("kl(").removesuffix(")").split("||")
        close(losses.kl(kinds[p], kinds[q]), value)
    close(losses.kl_terms(text, motion), expected["sampled"]["kl"])


def test_infonce_at_every_temperature_and_threshold(loss_inputs, expected):
    text, motion, sentences = tensors(loss_inputs, "sample_mean/t_latents", "sample_mean/m_latents", "sent_emb")
    for case in expected["infonce_on_sample_mean_latents"]:
        filtered = case["sent_emb"] and case["threshold_selfsim"]
        ignore = similar(sentences, case["threshold_selfsim"]) if filtered else None
        close(losses.contrastive(text, motion, case["temperature"], ignore), case["loss"])
    left_out = similar(sentences, 0.8).nonzero().tolist()
    assert left_out == expected["masked_pairs_threshold_0.8"]
    identical = sentences[:1].expand_as(sentences)
    close(
        losses.contrastive(text, motion, 0.1, similar(identical, 0.8)),
        expected["infonce_all_texts_identical_0.8"],
    )


def test_a_low_threshold_never_leaves_out_the_pair_itself(loss_inputs):
    """Where the published code gives NaN."""
    text, motion, sentences = tensors(loss_inputs, "sample_mean/t_latents", "sample_mean/m_latents", "sent_emb")
    assert torch.isfinite(losses.contrastive(text, motion, 0.1, similar(sentences, 0.4)))
