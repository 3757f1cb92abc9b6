"""Weights as int8: a quarter of the bytes, and vectors that hardly move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def int8_rows(weights: NDArray[np.float32]) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Symmetric int8 of a matrix (N, K) with one scale a row: (values (N, K), scales (N,)), nearest of 255 steps."""
    largest = np.abs(weights).max(axis=1)
    scales = np.where(largest > 0, largest / 127, 1).astype(np.float32)
    return np.rint(weights / scales[:, None]).astype(np.int8), scales
