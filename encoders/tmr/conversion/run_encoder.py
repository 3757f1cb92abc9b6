"""A run directory at work without a bundle: features and token features become unit vectors, in torch.

So that a run is evaluated as it is, with token features that were computed beforehand and no language model at hand.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from encoders.bundle.batching import length_buckets
from encoders.errors import BundleError
from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.conversion.from_published import load_run, load_stats
from encoders.tmr.model.network import TMR, TransformerEncoder
from encoders.tmr.model.padding import pad

#: What published TMR adds to a deviation.
EPSILON = 1e-12
_FRAMES_A_BATCH = 4096


class RunInputs(NamedTuple):
    """What a run reads: the name of its feature kind, and of the language model whose tokens it was trained on."""

    feature_kind: str
    language_model: str


def read_inputs(run: Path) -> RunInputs:
    """What a run's config.json says of its inputs; published ones state the size of the features, not their kind.

    Raises
    ------
    BundleError
        If it is no such file, or no feature kind has that size.
    """
    path = run / "config.json"
    try:
        data = json.loads(path.read_text("utf-8"))["data"]
        loader, language = data["motion_loader"], str(data["text_to_token_emb"]["modelname"])
        kinds = [k.name for k in FEATURE_KINDS.values() if k.size == loader["nfeats"]]
        name = str(loader.get("feature_kind") or (kinds or [""])[0])
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise BundleError(f"{path}: not the configuration of a TMR run ({error!r})") from error
    if name not in FEATURE_KINDS:
        raise BundleError(f"{path}: no feature kind here has {loader['nfeats']} numbers a frame")
    return RunInputs(name, language)


@dataclass(frozen=True)
class RunEncoder:
    """The encoders of a run with the statistics of its features.

    Attributes
    ----------
    mean, std : float32 arrays (F,)
    """

    name: str
    network: TMR
    mean: NDArray[np.float32]
    std: NDArray[np.float32]

    @classmethod
    def load(cls, run: Path, stats: Path) -> RunEncoder:
        """A run as published, with the folder of its statistics.

        Raises
        ------
        BundleError
            If a file is missing or does not fit.
        """
        network, (mean, std) = load_run(run), load_stats(stats)
        size = network.config.motion.features
        if mean.shape != (size,) or std.shape != (size,):
            raise BundleError(f"{stats}: statistics of {mean.shape} and {std.shape} numbers; the run reads {size}")
        return cls(run.resolve().name, network, mean, std)

    def encode_features(self, features: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
        """Unit vectors (N, D) of clips' features (T', F), of any length, as a whole."""
        clips = [(clip - self.mean) / (self.std + EPSILON) for clip in features]
        return _encode(self.network.motion_encoder, clips)

    def encode_token_features(self, rows: Sequence[NDArray[np.floating]]) -> NDArray[np.float32]:
        """Unit vectors (N, D) of sentences' token features (L, width)."""
        width = self.network.config.text.features
        wrong = next((row.shape[1] for row in rows if row.shape[1] != width), None)
        if wrong is not None:
            raise BundleError(f"{self.name}: reads tokens of {width} numbers, not {wrong}; use its own language model")
        return _encode(self.network.text_encoder, rows)


def _encode(encoder: TransformerEncoder, rows: Sequence[NDArray[np.floating]]) -> NDArray[np.float32]:
    out = np.empty((len(rows), encoder.latent), np.float32)
    for batch in length_buckets([len(row) for row in rows], _FRAMES_A_BATCH):
        x, mask = pad([rows[i] for i in batch])
        with torch.inference_mode():
            unit: Tensor = F.normalize(encoder.mean(x, mask), dim=-1)
        out[batch] = unit.numpy()
    return out
