"""What the networks promise beyond the published numbers."""

from __future__ import annotations

import json

import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.tmr.model.network import (  # noqa: E402
    TMR,
    Gaussian,
    TMRConfig,
    TransformerConfig,
    group_frames,
    positions,
    valid_mask,
)
from encoders.tmr.training import losses  # noqa: E402

SMALL = {"width": 16, "layers": 2, "heads": 2, "feedforward": 24, "dropout": 0.0}


def network(frames_per_token: int = 1, latent: int = 16) -> TMR:
    torch.manual_seed(0)
    config = TMRConfig(
        motion=TransformerConfig(features=7, frames_per_token=frames_per_token, **SMALL),
        text=TransformerConfig(features=5, **SMALL),
        decoder=TransformerConfig(features=7, frames_per_token=frames_per_token, **SMALL),
        latent=latent,
    )
    return TMR(config).eval()


@pytest.mark.parametrize("frames_per_token", [1, 3, 4])
@pytest.mark.parametrize("latent", [16, 10])
def test_padding_changes_nothing(frames_per_token, latent):
    model = network(frames_per_token, latent)
    lengths = torch.tensor([1, 2, 3, 4, 5, 8, 11, 13])
    mask = valid_mask(lengths, 20)
    x = torch.randn(len(lengths), 20, 7)
    together = model.motion_encoder(x, mask)
    decoded = model.motion_decoder(together.mu, mask)
    assert together.mu.shape == together.logvar.shape == (len(lengths), latent)
    for row, length in enumerate(lengths.tolist()):
        alone_mask = torch.ones(1, length, dtype=torch.bool)
        alone = model.motion_encoder(x[row : row + 1, :length], alone_mask)
        torch.testing.assert_close(together.mu[row], alone.mu[0], rtol=0, atol=1e-5)
        torch.testing.assert_close(together.logvar[row], alone.logvar[0], rtol=0, atol=1e-5)
        motion = model.motion_decoder(alone.mu, alone_mask)[0]
        torch.testing.assert_close(decoded[row, :length], motion, rtol=0, atol=1e-5)
    assert (decoded[~mask] == 0).all()
    assert decoded.shape == x.shape


def test_the_mean_alone_is_the_gaussians_mean():
    model = network(frames_per_token=4)
    x, mask = torch.randn(3, 10, 7), valid_mask(torch.tensor([10, 4, 7]), 10)
    torch.testing.assert_close(model.motion_encoder.mean(x, mask), model.motion_encoder(x, mask).mu)


def test_frames_are_stacked_in_order_and_zero_past_the_end():
    x = torch.arange(1, 11).reshape(2, 5, 1).float()
    tokens, mask = group_frames(x, valid_mask(torch.tensor([5, 3]), 5), 2)
    assert tokens.tolist() == [[[1, 2], [3, 4], [5, 0]], [[6, 7], [8, 0], [0, 0]]]
    assert mask.tolist() == [[True, True, True], [True, True, False]]


def test_a_configuration_survives_json():
    config = network(4, 10).config
    assert TMRConfig.from_dict(json.loads(json.dumps(config.to_dict()))) == config
    without = TMRConfig(decoder=None)
    assert TMRConfig.from_dict(json.loads(json.dumps(without.to_dict()))) == without
    assert TMR(without).motion_decoder is None


@pytest.mark.parametrize("sizes", [{"width": 10, "heads": 4}, {"width": 9, "heads": 3}, {"frames_per_token": 0}])
def test_sizes_that_do_not_fit_are_refused(sizes):
    with pytest.raises(ValueError, match="must be"):
        TransformerConfig(features=3, **sizes)


def test_attention_is_that_of_torch():
    """The same weights in torch's own encoder give the same outputs at the tokens that are read."""
    encoder = network().motion_encoder
    layer = torch.nn.TransformerEncoderLayer(16, 2, 24, 0.0, "gelu", batch_first=True)
    reference = torch.nn.TransformerEncoder(layer, 2, enable_nested_tensor=False).eval()
    reference.load_state_dict(encoder.seqTransEncoder.state_dict())
    x, mask = torch.randn(3, 9, 7), valid_mask(torch.tensor([9, 1, 5]), 9)
    tokens = torch.cat((encoder.tokens.expand(3, -1, -1), encoder.projection(x)), 1) + positions(11, 16)
    padding = ~torch.nn.functional.pad(mask, (2, 0), value=True)
    expected = reference(tokens, src_key_padding_mask=padding)
    mu, logvar = encoder(x, mask)
    torch.testing.assert_close(mu, expected[:, 0], rtol=0, atol=1e-5)
    torch.testing.assert_close(logvar, expected[:, 1], rtol=0, atol=1e-5)


def test_training_reaches_every_parameter_but_the_attention_to_one_token():
    model = network(frames_per_token=2, latent=12).train()
    x, mask = torch.randn(4, 9, 7), valid_mask(torch.tensor([9, 4, 6, 7]), 9)
    text_x, text_mask = torch.randn(4, 5, 5), valid_mask(torch.tensor([5, 4, 2, 3]), 5)
    text, motion = model.text_encoder(text_x, text_mask), model.motion_encoder(x, mask)
    temperature = torch.tensor(0.1, requires_grad=True)
    terms = {
        "reconstruction": losses.reconstruction(
            x * mask[..., None], *(model.motion_decoder(g.sample(), mask) for g in (text, motion))
        ),
        "kl": losses.kl_terms(text, motion),
        "latent": losses.latent_loss(text.sample(), motion.sample()),
        "contrastive": losses.contrastive(text.sample(), motion.sample(), temperature),
    }
    losses.total(terms, losses.LossWeights()).backward()
    assert temperature.grad.abs() > 0
    for name, parameter in model.named_parameters():
        assert parameter.grad is not None, name
        assert parameter.grad.abs().sum() > 0, name


def test_pairs_left_out_are_no_negatives():
    text = torch.eye(3)
    motion = torch.tensor([[1.0, 0, 0], [0.9, 0.1, 0], [0, 0, 1]])
    ignore = torch.zeros(3, 3, dtype=torch.bool)
    plain = losses.contrastive(text, motion, 0.1, ignore)
    ignore[0, 1] = True
    assert losses.contrastive(text, motion, 0.1, ignore) < plain
    own = torch.ones(3, 3, dtype=torch.bool)
    assert losses.contrastive(text, motion, 0.1, own) == 0


def test_divergence_of_a_gaussian_from_itself_is_zero():
    gaussian = Gaussian(torch.randn(3, 4), torch.randn(3, 4))
    assert losses.kl(gaussian, gaussian) == pytest.approx(0, abs=1e-7)
    assert losses.kl(gaussian, Gaussian(gaussian.mu + 1, gaussian.logvar)) > 0
