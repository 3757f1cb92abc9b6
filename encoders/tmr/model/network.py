"""TMR's networks: two ACTOR-style encoders, for motion and for text, and a motion decoder.

After Petrovich, Black and Varol, "TMR: Text-to-Motion Retrieval Using Contrastive 3D Human Motion Synthesis"
(ICCV 2023), which takes its networks from TEMOS and ACTOR. Modules carry the names of the published tensors, so
published weights load strictly. What TMR does not have is off by default: several frames a token, a latent whose size
differs from the width of the network, and a head on the mean of a sentence's tokens, `SentenceHead`.

Two things are computed differently and give the same: an encoder's last layer is only computed for the tokens
that are read, and attention to the decoder's memory, which is one token, is that token's value.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn


@dataclass(frozen=True)
class TransformerConfig:
    """Sizes of one encoder or of the decoder; the defaults are those of published TMR.

    `sentence_head` is the width of the perceptron on the mean of a sequence, 0 for none.
    """

    features: int
    width: int = 256
    layers: int = 6
    heads: int = 4
    feedforward: int = 1024
    dropout: float = 0.1
    frames_per_token: int = 1
    sentence_head: int = 0

    def __post_init__(self) -> None:
        if self.width % self.heads or self.width % 2:
            raise ValueError(f"width={self.width} must be even and a multiple of heads={self.heads}")
        if self.frames_per_token < 1:
            raise ValueError(f"frames_per_token={self.frames_per_token} must be at least 1")


@dataclass(frozen=True)
class TMRConfig:
    """A whole TMR: both encoders, the decoder (None: no reconstruction) and the size of the space they share."""

    motion: TransformerConfig = field(default_factory=lambda: TransformerConfig(features=263))
    text: TransformerConfig = field(default_factory=lambda: TransformerConfig(features=768))
    decoder: TransformerConfig | None = field(default_factory=lambda: TransformerConfig(features=263))
    latent: int = 256

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, as JSON takes them."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> TMRConfig:
        """Inverse of `to_dict`."""
        decoder = values["decoder"]
        return cls(
            motion=TransformerConfig(**values["motion"]),
            text=TransformerConfig(**values["text"]),
            decoder=None if decoder is None else TransformerConfig(**decoder),
            latent=values["latent"],
        )


class Gaussian(NamedTuple):
    """Diagonal Gaussians, one a row: mean and logarithm of the variance, both (B, latent)."""

    mu: Tensor
    logvar: Tensor

    def sample(self, noise: Tensor | None = None) -> Tensor:
        """One draw a row (B, latent); `noise` (standard normal, same shape) is drawn where it is not given."""
        noise = torch.randn_like(self.mu) if noise is None else noise
        return self.mu + noise * torch.exp(0.5 * self.logvar)


def valid_mask(lengths: Tensor, size: int) -> Tensor:
    """Boolean (B, size), True on the first `lengths` (B,) places of each row."""
    return torch.arange(size, device=lengths.device)[None, :] < lengths[:, None]


def positions(count: int, width: int, device: torch.device | None = None) -> Tensor:
    """Sinusoidal positions (count, width): sine and cosine interleaved, base 10000 (Vaswani et al. 2017)."""
    rates = torch.exp(torch.arange(0, width, 2, device=device).float() * (-math.log(10000.0) / width))
    angles = torch.arange(count, device=device).float()[:, None] * rates
    return torch.stack((torch.sin(angles), torch.cos(angles)), dim=-1).reshape(count, width)


class ByteDropout(nn.Module):
    """As `nn.Dropout`, with a chance in 256ths: on a CPU random bytes are quicker to draw than random decisions."""

    def __init__(self, chance: float) -> None:
        super().__init__()
        self.dropped = round(256 * chance)

    def forward(self, x: Tensor) -> Tensor:
        """Numbers of x, any shape, are zero by that chance while training, the others larger for it."""
        if not self.training or not self.dropped:
            return x
        if x.device.type != "cpu":
            return F.dropout(x, self.dropped / 256)
        drawn = torch.empty(-(-x.numel() // 8), dtype=torch.int64).random_(-(2**63), None)
        kept = drawn.view(torch.uint8)[: x.numel()].view(x.shape) >= self.dropped
        return x * (kept.to(x.dtype) * (256 / (256 - self.dropped)))


class MultiHeadAttention(nn.Module):
    """Multi-head attention with the tensors of `nn.MultiheadAttention`, exportable at any batch and length."""

    def __init__(self, width: int, heads: int, dropout: float) -> None:
        super().__init__()
        self.heads = heads
        self.dropout = dropout
        self.in_proj_weight = nn.Parameter(torch.empty(3 * width, width))
        self.in_proj_bias = nn.Parameter(torch.zeros(3 * width))
        self.out_proj = nn.Linear(width, width)
        nn.init.xavier_uniform_(self.in_proj_weight)
        nn.init.zeros_(self.out_proj.bias)

    def forward(self, x: Tensor, mask: Tensor, keep: int | None = None) -> Tensor:
        """Self-attention of x (B, L, width) to its places where mask (B, L) is True, for the first `keep` places."""
        width = x.shape[-1]
        if keep is None:
            query, key, value = F.linear(x, self.in_proj_weight, self.in_proj_bias).chunk(3, dim=-1)
        else:
            query = F.linear(x[:, :keep], self.in_proj_weight[:width], self.in_proj_bias[:width])
            key, value = F.linear(x, self.in_proj_weight[width:], self.in_proj_bias[width:]).chunk(2, dim=-1)
        mixed = F.scaled_dot_product_attention(
            self._split(query),
            self._split(key),
            self._split(value),
            attn_mask=mask[:, None, None, :],
            dropout_p=self.dropout if self.training else 0.0,
        )
        return self.out_proj(mixed.transpose(1, 2).flatten(2))

    def to_single(self, memory: Tensor) -> Tensor:
        """Attention of any query to one memory token (B, 1, width): its value, whatever queries and keys are."""
        width = memory.shape[-1]
        return self.out_proj(F.linear(memory, self.in_proj_weight[2 * width :], self.in_proj_bias[2 * width :]))

    def _split(self, x: Tensor) -> Tensor:
        return x.unflatten(-1, (self.heads, -1)).transpose(1, 2)


class TransformerLayer(nn.Module):
    """What encoder and decoder layers share: post-norm self-attention and a feed-forward network with exact GELU."""

    def __init__(self, config: TransformerConfig) -> None:
        super().__init__()
        self.self_attn = MultiHeadAttention(config.width, config.heads, config.dropout)
        self.linear1 = nn.Linear(config.width, config.feedforward)
        self.linear2 = nn.Linear(config.feedforward, config.width)
        self.norm1 = nn.LayerNorm(config.width)
        self.norm2 = nn.LayerNorm(config.width)
        self.dropout = ByteDropout(config.dropout)

    def feed(self, x: Tensor) -> Tensor:
        """The position-wise network."""
        return self.dropout(self.linear2(self.dropout(F.gelu(self.linear1(x)))))


class EncoderLayer(TransformerLayer):
    """Named as `nn.TransformerEncoderLayer`."""

    def forward(self, x: Tensor, mask: Tensor, keep: int | None = None) -> Tensor:
        """(B, L, width) -> (B, keep or L, width)."""
        x = self.norm1(x[:, :keep] + self.dropout(self.self_attn(x, mask, keep)))
        return self.norm2(x + self.feed(x))


class DecoderLayer(TransformerLayer):
    """Named as `nn.TransformerDecoderLayer`; its memory is a single token."""

    def __init__(self, config: TransformerConfig) -> None:
        super().__init__(config)
        self.multihead_attn = MultiHeadAttention(config.width, config.heads, config.dropout)
        self.norm3 = nn.LayerNorm(config.width)

    def forward(self, x: Tensor, mask: Tensor, memory: Tensor) -> Tensor:
        """Queries (B, L, width) and memory (B, 1, width) -> (B, L, width)."""
        x = self.norm1(x + self.dropout(self.self_attn(x, mask)))
        x = self.norm2(x + self.dropout(self.multihead_attn.to_single(memory).expand_as(x)))
        return self.norm3(x + self.feed(x))


class LayerStack(nn.Module):
    """Layers under the name `layers`, as torch's transformer containers hold them."""

    def __init__(self, layers: Iterable[TransformerLayer]) -> None:
        super().__init__()
        self.layers = nn.ModuleList(layers)


class SentenceHead(nn.Module):
    """A sequence's mean feature -> a latent, through a perceptron without regard to order.

    Sentence embeddings are trained as means of tokens: this head generalises to words that training never met, where
    the token head is better at who does what when. The embedding is the sum of both directions.
    """

    def __init__(self, config: TransformerConfig, latent: int) -> None:
        super().__init__()
        self.widen = nn.Linear(config.features, config.sentence_head)
        self.mix = nn.Linear(config.sentence_head, config.sentence_head)
        self.narrow = nn.Linear(config.sentence_head, latent)
        self.dropout = ByteDropout(config.dropout)

    def forward(self, x: Tensor, mask: Tensor) -> Tensor:
        """Features (B, T, F), valid where mask (B, T) is True -> (B, latent)."""
        x = F.normalize((x * mask[..., None]).sum(1), dim=-1) * x.shape[-1] ** 0.5
        for layer in (self.widen, self.mix):
            x = self.dropout(F.gelu(layer(x)))
        return self.narrow(x)


class TransformerEncoder(nn.Module):
    """A sequence of features -> a Gaussian: two learned tokens go in front, their outputs are mu and logvar."""

    def __init__(self, config: TransformerConfig, latent: int) -> None:
        super().__init__()
        self.config = config
        self.latent = latent
        self.tokens = nn.Parameter(torch.randn(2, config.width))
        self.projection = nn.Linear(config.features * config.frames_per_token, config.width)
        self.seqTransEncoder = LayerStack(EncoderLayer(config) for _ in range(config.layers))
        self.dropout = ByteDropout(config.dropout)
        self.to_latent = nn.Identity() if latent == config.width else nn.Linear(config.width, latent)
        self.sentence_head = SentenceHead(config, latent) if config.sentence_head else None

    def forward(self, x: Tensor, mask: Tensor) -> Gaussian:
        """Features (B, T, F), valid where mask (B, T) is True -> Gaussian over (B, latent)."""
        mu, logvar = self._read(x, mask, tokens=2).unbind(1)
        return Gaussian(mu, logvar)

    def mean(self, x: Tensor, mask: Tensor) -> Tensor:
        """The embedding (B, latent): mu, or the sum of its direction and that of the sentence head."""
        mu = self._read(x, mask, tokens=1)[:, 0]
        if self.sentence_head is None:
            return mu
        return F.normalize(mu, dim=-1) + F.normalize(self.sentence_head(x, mask), dim=-1)

    def _read(self, x: Tensor, mask: Tensor, tokens: int) -> Tensor:
        x, mask = group_frames(x, mask, self.config.frames_per_token)
        x = torch.cat((self.tokens.expand(x.shape[0], -1, -1), self.projection(x)), dim=1)
        mask = F.pad(mask, (2, 0), value=True)
        x = self.dropout(x + positions(x.shape[1], self.config.width, x.device))
        for layer in self.seqTransEncoder.layers[:-1]:
            x = layer(x, mask)
        return self.to_latent(self.seqTransEncoder.layers[-1](x, mask, keep=tokens))


class Decoder(nn.Module):
    """A latent and a length -> a motion's features, all frames in one pass."""

    def __init__(self, config: TransformerConfig, latent: int) -> None:
        super().__init__()
        self.config = config
        self.seqTransDecoder = LayerStack(DecoderLayer(config) for _ in range(config.layers))
        self.final_layer = nn.Linear(config.width, config.features * config.frames_per_token)
        self.dropout = ByteDropout(config.dropout)
        self.from_latent = nn.Identity() if latent == config.width else nn.Linear(latent, config.width)

    def forward(self, latent: Tensor, mask: Tensor) -> Tensor:
        """Latents (B, latent) and mask (B, T) -> features (B, T, F), zero where the mask is False."""
        frames = mask.shape[1]
        token_mask = group_mask(mask, self.config.frames_per_token)
        memory = self.from_latent(latent)[:, None]
        queries = positions(token_mask.shape[1], self.config.width, latent.device)
        x = self.dropout(queries.expand(len(latent), -1, -1))
        for layer in self.seqTransDecoder.layers:
            x = layer(x, token_mask, memory)
        x = self.final_layer(x).reshape(len(latent), -1, self.config.features)[:, :frames]
        return x * mask[..., None]


def group_mask(mask: Tensor, size: int) -> Tensor:
    """(B, T) -> (B, ceil(T / size)): a token is valid where its first frame is."""
    return mask[:, ::size]


def group_frames(x: Tensor, mask: Tensor, size: int) -> tuple[Tensor, Tensor]:
    """Stack `size` consecutive frames into one token: (B, T, F) -> (B, ceil(T / size), size * F), and the mask.

    Frames past the end count as zeros, whatever the padding holds.
    """
    if size == 1:
        return x, mask
    batch, frames, features = x.shape
    x = F.pad(x * mask[..., None], (0, 0, 0, -frames % size))
    return x.reshape(batch, -1, size * features), group_mask(mask, size)


class TMR(nn.Module):
    """Both encoders and the decoder, under the names of the published modules."""

    def __init__(self, config: TMRConfig) -> None:
        super().__init__()
        self.config = config
        self.motion_encoder = TransformerEncoder(config.motion, config.latent)
        self.text_encoder = TransformerEncoder(config.text, config.latent)
        self.motion_decoder = None if config.decoder is None else Decoder(config.decoder, config.latent)
