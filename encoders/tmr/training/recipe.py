"""The recipe: everything that decides a training run.

Beyond what is published, each switched by a field: a learned temperature, hard negatives (captions with the order,
side, direction or count changed), out-of-domain sentences as negatives, weight averaging, random crops, and a share of
real clips in every batch.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from typing import Any

from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.model.network import TMRConfig, TransformerConfig
from encoders.tmr.training.losses import LossWeights

_CHOICES = {"filter": ("facts", "none"), "contrast": ("infonce", "margin", "none")}
_FEATURES, _TOKEN_FEATURES = FEATURE_KINDS["body"].size, 384


def default_network(features: int = _FEATURES, token_features: int = _TOKEN_FEATURES) -> TMRConfig:
    """The sizes of the default model: encoders a quarter of published TMR's, four frames a token, and no decoder."""
    return TMRConfig(
        motion=TransformerConfig(features=features, width=256, layers=3, feedforward=768, frames_per_token=4),
        text=TransformerConfig(features=token_features, width=256, layers=2, feedforward=768, sentence_head=1024),
        decoder=None,
        latent=256,
    )


@dataclass(frozen=True)
class Recipe:
    """Everything that decides a training run.

    Attributes
    ----------
    steps, batch, rate, warmup, decay : optimisation (AdamW, linear warm-up, cosine to a twentieth)
    real_share : share of real clips in each batch
    temperature : of the contrastive term; the initial value where `learn_temperature`
    filter : "facts" masks false negatives, "none" masks nothing
    typical : an underspecified caption (no direction, side or kind) stays a negative for motions with a salient one
    similarity : pairs with a real clip whose captions are more similar, on the (1 + cosine) / 2 scale, are masked too
    contrast : "infonce", "margin" (a ranking loss with a random negative) or "none"
    hard_negatives, unrelated : hard negatives and out-of-domain sentences a batch
    hard_negative_weight : weight of the hard-negative loss within the contrastive term
    similar_share : share of the synthetic clips of a batch that come in groups of nearest neighbours
    hard_from : step from which batches have such groups and hard negatives; earlier they slow learning
    crop : probability that a clip of one action is cropped at random
    noise, bias : standard deviations of frame noise and of a constant offset a clip, in standardised units
    yaw, tilt : random rotation, standard deviations in degrees about the vertical and about either horizontal axis
    pose_jitter : standard deviation in degrees of a constant offset of arms and trunk, a clip
    token_dropout : probability that a token of a sentence is dropped
    averaging : decay of the running mean of the weights that is kept
    head_steps : steps of head fine-tuning at the end
    sampled : the contrastive term sees sampled latents, as published, instead of means
    decoded : motions a batch that are reconstructed
    seed : of weights, batches and synthetic clips
    """

    network: TMRConfig = field(default_factory=default_network)
    weights: LossWeights = field(default_factory=lambda: LossWeights(contrastive=1.0))
    steps: int = 5400
    batch: int = 192
    rate: float = 1e-3
    warmup: int = 60
    decay: float = 0.02
    real_share: float = 0.15
    temperature: float = 0.07
    learn_temperature: bool = True
    filter: str = "facts"
    typical: bool = True
    similarity: float = 0.8
    contrast: str = "infonce"
    hard_negatives: int = 64
    hard_negative_weight: float = 2.0
    unrelated: int = 8
    similar_share: float = 0.5
    hard_from: int = 600
    crop: float = 0.5
    noise: float = 0.03
    bias: float = 0.1
    yaw: float = 4.0
    tilt: float = 1.0
    pose_jitter: float = 0.0
    token_dropout: float = 0.05
    averaging: float = 0.995
    head_steps: int = 2500
    sampled: bool = False
    decoded: int = 64
    max_frames: int = 128
    seed: int = 0
    bf16: bool = False

    def __post_init__(self) -> None:
        for name, choices in _CHOICES.items():
            if getattr(self, name) not in choices:
                raise ValueError(f"{name}={getattr(self, name)!r} must be one of {', '.join(choices)}")
        for known in fields(self):
            _check_number(known.name, getattr(self, known.name), known.default)
        if self.batch < 1:
            raise ValueError(f"batch={self.batch} must be positive")

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, as JSON takes them."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Recipe:
        """Inverse of `to_dict`."""
        values = dict(values)
        values["network"] = TMRConfig.from_dict(values["network"])
        values["weights"] = LossWeights(**values["weights"])
        return cls(**values)


def _check_number(name: str, value: Any, default: Any) -> None:
    """Raise ValueError where a number of the default's kind is due, and it is none, or below zero."""
    if type(default) not in (bool, int, float):
        return
    allowed = (int, float) if type(default) is float else (type(default),)
    if type(value) not in allowed or not value >= 0:
        kind = {bool: "true or false", int: "a whole number from 0", float: "a number from 0"}[type(default)]
        raise ValueError(f"{name}={value!r} must be {kind}")
