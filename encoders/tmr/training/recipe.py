"""The recipe: everything that decides a training run.

Beyond what is published, each switched by a field: a learned temperature, hard negatives (captions with the order,
side, direction or count changed), sentences about anything but motion as negatives, weight averaging, random crops,
and a share of real clips in every batch.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from typing import Any

from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.model.network import Config, Tower
from encoders.tmr.training.losses import Weights

_CHOICES = {"filter": ("facts", "none"), "contrast": ("infonce", "margin", "none")}
_FEATURES, _TOKEN_FEATURES = FEATURE_KINDS["body"].size, 384


def default_network(features: int = _FEATURES, token_features: int = _TOKEN_FEATURES) -> Config:
    """The sizes of the default model: encoders a quarter of published TMR's, four frames a token, and no decoder."""
    return Config(
        motion=Tower(features=features, width=256, layers=3, feedforward=768, frames_per_token=4),
        text=Tower(features=token_features, width=256, layers=2, feedforward=768, gist=1024),
        decoder=None,
        latent=256,
    )


@dataclass(frozen=True)
class Recipe:
    """Everything that decides a training run.

    Attributes
    ----------
    steps, batch, rate, warmup, decay : optimisation (AdamW, linear warm-up, cosine to a twentieth)
    real_share : share of each batch taken from real clips
    temperature : of the contrastive term; learned from this start where `learn_temperature`
    filter : "facts" leaves out pairs known to be no negatives, "none" leaves out nothing
    typical : a sentence that keeps quiet about a direction, both hands or a special kind stays a negative for it
    similarity : sentences nearer than this on the (1 + cosine) / 2 scale are no negatives where a real clip is involved
    contrast : "infonce", "margin" (a ranking loss with a random negative) or "none"
    hard_negatives, unrelated : captions a batch that are negatives for their own clip, or for every clip
    telling : weight, within the contrastive term, of choosing between a sentence and its changed twin
    alike : share of the made clips of a batch that come in groups the model finds alike
    hard_from : step from which clips come in such groups and captions with changed twins; before, they slow learning
    crop : share of single-action clips of which a random part is shown
    noise, bias : standard deviations of frame noise and of a constant offset a clip, in standardised units
    yaw, tilt : standard deviations in degrees by which a clip's frame is turned about the vertical, and tilted
    posture : standard deviation in degrees by which arms and trunk are carried otherwise, a clip
    words_lost : chance of each word piece to be left out of a sentence
    averaging : decay of the running mean of weights that is kept
    gist_steps : steps at the end in which the gist alone learns
    sampled : the contrastive term sees sampled latents, as published, instead of means
    decoded : motions a batch that are reconstructed
    seed : of weights, batches and the clips that are made
    """

    network: Config = field(default_factory=default_network)
    weights: Weights = field(default_factory=lambda: Weights(contrastive=1.0))
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
    telling: float = 2.0
    unrelated: int = 8
    alike: float = 0.5
    hard_from: int = 600
    crop: float = 0.5
    noise: float = 0.03
    bias: float = 0.1
    yaw: float = 4.0
    tilt: float = 1.0
    posture: float = 0.0
    words_lost: float = 0.05
    averaging: float = 0.995
    gist_steps: int = 2500
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
        values["network"] = Config.from_dict(values["network"])
        values["weights"] = Weights(**values["weights"])
        return cls(**values)


def _check_number(name: str, value: Any, default: Any) -> None:
    """Raise ValueError where a number of the default's kind is due, and it is none, or below zero."""
    if type(default) not in (bool, int, float):
        return
    allowed = (int, float) if type(default) is float else (type(default),)
    if type(value) not in allowed or not value >= 0:
        kind = {bool: "true or false", int: "a whole number from 0", float: "a number from 0"}[type(default)]
        raise ValueError(f"{name}={value!r} must be {kind}")
