"""Arrays of mixed lengths as padded tensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from encoders.bundle import batching
from encoders.tmr.model.network import valid_mask


def pad(rows: Sequence[NDArray[Any]]) -> tuple[Tensor, Tensor]:
    """Rows (L, F) of mixed lengths -> float32 (B, L, F), zero-padded, and boolean mask (B, L)."""
    padded, lengths = batching.pad(rows)
    mask = valid_mask(torch.from_numpy(lengths), padded.shape[1])
    return torch.from_numpy(padded.astype(np.float32, copy=False)), mask
