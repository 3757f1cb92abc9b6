"""Embed many motions and sentences with a torch model, for validation while it trains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray

from encoders.tmr.model.network import TMR
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.model.padding import pad
from encoders.tmr.text.token_features import TokenTable
from encoders.tmr.training.pairs import PairStore


def embed_motions(
    model: TMR, store: PairStore, normaliser: Normaliser, max_frames: int, batch: int = 256
) -> NDArray[np.float32]:
    """Unit vectors (N, D) of a store's motions, cut to their first `max_frames`."""
    order = np.argsort(store.lengths, kind="stable")
    out = np.empty((len(store), model.config.latent), np.float32)
    for start in range(0, len(order), batch):
        rows = order[start : start + batch]
        x, mask = pad(
            [(store.motion(i)[:max_frames].astype(np.float32) - normaliser.mean) / normaliser.std for i in rows]
        )
        with torch.inference_mode():
            out[rows] = F.normalize(model.motion_encoder.mean(x, mask), dim=-1).numpy()
    return out


def embed_texts(model: TMR, tokens: TokenTable, indices: Sequence[int], batch: int = 512) -> NDArray[np.float32]:
    """Unit vectors (N, D) of sentences of a token table."""
    out = np.empty((len(indices), model.config.latent), np.float32)
    for start in range(0, len(indices), batch):
        x, mask = pad(tokens.rows(indices[start : start + batch]))
        with torch.inference_mode():
            out[start : start + batch] = F.normalize(model.text_encoder.mean(x, mask), dim=-1).numpy()
    return out
