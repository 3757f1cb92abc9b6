"""A run directory at work without a bundle: features and token features become unit vectors, in torch.

So that a run is evaluated as it is, with token features that were computed beforehand and no language model at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from encoders.bundle.batching import length_buckets
from encoders.errors import BundleError
from encoders.tmr.conversion.from_published import load_run, load_stats
from encoders.tmr.model.network import TMR, TransformerEncoder
from encoders.tmr.model.padding import pad

#: What published TMR adds to a deviation.
EPSILON = 1e-12
_FRAMES_A_BATCH = 4096


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
        network = load_run(run)
        mean, std = load_stats(stats, network.config.motion.features)
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
    device = encoder.tokens.device
    for batch in length_buckets([len(row) for row in rows], _FRAMES_A_BATCH):
        x, mask = pad([rows[i] for i in batch])
        with torch.inference_mode():
            unit: Tensor = F.normalize(encoder.mean(x.to(device), mask.to(device)), dim=-1)
        out[batch] = unit.cpu().numpy()
    return out
