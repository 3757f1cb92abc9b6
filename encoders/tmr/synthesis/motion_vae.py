"""The generator's networks: a motion encoder and decoder as TMR's, and a Gaussian of motions for each sentence.

After TEMOS (Petrovich, Black and Varol, ECCV 2022). Its text encoder is here a perceptron on the vectors of a model
that is trained already and stays as it is: a library that was indexed with that model needs no indexing again.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import torch.nn.functional as F
from torch import Tensor, nn

from encoders.tmr.model.network import Decoder, Gaussian, TransformerConfig, TransformerEncoder

#: Bounds of the logarithm of a sentence's variances: narrower ones are of no use, wider ones than the prior neither.
NARROWEST, WIDEST = -6.0, 1.0


@dataclass(frozen=True)
class VAEConfig:
    """Sizes of the generator; `features` and `sentence` are numbers of a feature frame and of a sentence's vector."""

    features: int
    sentence: int
    latent: int = 64
    width: int = 192
    layers: int = 4
    feedforward: int = 576
    frames_per_token: int = 4

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, as JSON takes them."""
        return asdict(self)


class TextGaussian(nn.Module):
    """A sentence's unit vector -> the Gaussian of the motions it may mean."""

    def __init__(self, sentence: int, latent: int, width: int = 512, dropout: float = 0.1) -> None:
        super().__init__()
        self.widen = nn.Linear(sentence, width)
        self.mix = nn.Linear(width, width)
        self.narrow = nn.Linear(width, 2 * latent)
        self.dropout = nn.Dropout(dropout)

    def forward(self, vectors: Tensor) -> Gaussian:
        """Unit vectors (B, D) -> a Gaussian over (B, latent)."""
        x = vectors * vectors.shape[-1] ** 0.5
        for layer in (self.widen, self.mix):
            x = self.dropout(F.gelu(layer(x)))
        mu, logvar = self.narrow(x).chunk(2, dim=-1)
        return Gaussian(mu, logvar.clamp(NARROWEST, WIDEST))


class MotionVAE(nn.Module):
    """A motion -> a Gaussian -> the motion; a sentence -> a Gaussian of the same space."""

    def __init__(self, config: VAEConfig) -> None:
        super().__init__()
        sizes = TransformerConfig(
            config.features,
            config.width,
            config.layers,
            heads=4,
            feedforward=config.feedforward,
            frames_per_token=config.frames_per_token,
        )
        self.config = config
        self.motion_encoder = TransformerEncoder(sizes, config.latent)
        self.motion_decoder = Decoder(sizes, config.latent)
        self.text_gaussian = TextGaussian(config.sentence, config.latent)
