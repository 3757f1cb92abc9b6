"""TMR's own recipe: what its published configuration states, and that configuration written for a run.

The run's directory has the layout of the published code, so that whatever reads a published run reads this one, too.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from encoders.features.registry import FeatureKind
from encoders.tmr.model.network import TMRConfig, TransformerConfig
from encoders.tmr.training.losses import LossWeights

#: The names of published folders of features.
_PUBLISHED_FEATURES = {"humanml3d": "guoh3dfeats"}
EPSILON = 1e-12


@dataclass(frozen=True)
class TMRRecipe:
    """Everything that decides a training run by TMR's recipe; the defaults are the published values.

    Attributes
    ----------
    latent, layers, heads, feedforward, dropout : of both encoders and the decoder; `latent` is their width as well
    reconstruction, kl, latent_loss, contrastive : weights of the terms of the loss
    temperature : of the contrastive term
    threshold : pairs whose captions are more similar, (1 + cosine) / 2, are no negatives; 0 masks nothing
    rate, decay : of AdamW; the rate is constant
    batch, epochs : the last batch of an epoch may be smaller
    seed : of weights, order, captions, dropout and sampling
    """

    latent: int = 256
    layers: int = 6
    heads: int = 4
    feedforward: int = 1024
    dropout: float = 0.1
    reconstruction: float = 1.0
    kl: float = 1e-5
    latent_loss: float = 1e-5
    contrastive: float = 0.1
    temperature: float = 0.1
    threshold: float = 0.8
    rate: float = 1e-4
    decay: float = 0.01
    batch: int = 32
    epochs: int = 500
    seed: int = 1234

    def __post_init__(self) -> None:
        for known in fields(self):
            value = getattr(self, known.name)
            kinds = (int,) if known.type == "int" else (int, float)
            if type(value) not in kinds or not 0 <= value < float("inf"):
                raise ValueError(f"{known.name}={value!r} must be a {'whole ' * (kinds == (int,))}number from 0")
        for name in ("batch", "temperature", "layers", "latent", "heads", "feedforward"):
            if not getattr(self, name):
                raise ValueError(f"{name}={getattr(self, name)} must be more than 0")
        if 0 < self.threshold < 0.5 or self.threshold > 1 or self.dropout >= 1:
            raise ValueError(
                f"threshold={self.threshold} must be 0, or from 0.5 to 1, and dropout={self.dropout} below 1"
            )

    @property
    def weights(self) -> LossWeights:
        """Of the terms of the loss."""
        return LossWeights(self.reconstruction, self.kl, self.latent_loss, self.contrastive)

    def network(self, features: int, token_features: int) -> TMRConfig:
        """The sizes of the networks for motions and tokens of so many numbers."""
        one = TransformerConfig(features, self.latent, self.layers, self.heads, self.feedforward, dropout=self.dropout)
        return TMRConfig(one, replace(one, features=token_features), one, self.latent)

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, as JSON takes them."""
        return asdict(self)

    def published_config(self, kind: FeatureKind, token_features: int, language_model: str) -> dict[str, Any]:
        """What the published code's config.json would say of this run."""
        transformer = {
            "latent_dim": self.latent,
            "ff_size": self.feedforward,
            "num_layers": self.layers,
            "num_heads": self.heads,
            "dropout": self.dropout,
            "activation": "gelu",
        }
        return {
            "data": {
                "motion_loader": {
                    "base_dir": f"datasets/motions/{_PUBLISHED_FEATURES.get(kind.name, kind.name)}",
                    "normalizer": {"base_dir": "stats", "eps": EPSILON},
                    "fps": kind.fps,
                    "nfeats": kind.size,
                },
                "text_to_token_emb": {"modelname": language_model},
            },
            "model": {
                "motion_encoder": {"nfeats": kind.size, "vae": True, **transformer},
                "text_encoder": {"nfeats": token_features, "vae": True, **transformer},
                "motion_decoder": {"nfeats": kind.size, **transformer},
                "vae": True,
                "lmd": {
                    "recons": self.reconstruction,
                    "latent": self.latent_loss,
                    "kl": self.kl,
                    "contrastive": self.contrastive,
                },
                "lr": self.rate,
                "temperature": self.temperature,
                "threshold_selfsim": self.threshold,
                "threshold_selfsim_metrics": 0.95,
            },
            "trainer": {"max_epochs": self.epochs},
            "dataloader": {"batch_size": self.batch},
            "seed": self.seed,
            "ckpt": "last",
        }
