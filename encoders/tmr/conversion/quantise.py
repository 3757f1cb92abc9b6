"""Weights in 8 or 4 bits: a quarter or an eighth of the bytes, and vectors that hardly change."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def int8_rows(weights: NDArray[np.float32]) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Symmetric int8 of a matrix (N, K) with one scale a row: (values (N, K), scales (N,)), nearest of 255 steps."""
    largest = np.abs(weights).max(axis=1)
    scales = np.where(largest > 0, largest / 127, 1).astype(np.float32)
    return np.rint(weights / scales[:, None]).astype(np.int8), scales


#: Parts of its largest number up to which a block's steps reach; numbers further out are held, if wide steps cost more.
_REACHES = (1.0, 0.9, 0.8, 0.7)
#: The 16 steps of 4 bits are -7.5, -6.5, ... 7.5 times the scale.
MIDDLE = 7.5


def int4_rows(weights: NDArray[np.float32], block: int) -> tuple[NDArray[np.uint8], NDArray[np.float16]]:
    """A matrix (N, K) in 4 bits, with a scale for every `block` numbers of a row.

    Returns
    -------
    uint8 (N, K / 2)
        The first half of a row in the lower four bits, the second half in the upper four.
    float16 (N, K / block)
        The scales, each the one of four with the least squared error; numbers are ``(step - MIDDLE) * scale``.
    """
    blocks = weights.reshape(-1, block)
    largest = np.maximum(np.abs(blocks).max(axis=1, keepdims=True), np.finfo(np.float16).tiny)
    scales = np.array([reach / MIDDLE for reach in _REACHES], np.float32)[:, None, None] * largest
    scales = np.maximum(scales, np.finfo(np.float16).tiny).astype(np.float16)
    steps = np.clip(np.rint(blocks / scales.astype(np.float32) + MIDDLE), 0, 15)
    errors = np.square((steps - MIDDLE) * scales - blocks).sum(axis=-1)
    best = errors.argmin(axis=0), np.arange(len(blocks))
    low, high = np.split(steps[best].astype(np.uint8).reshape(weights.shape), 2, axis=1)
    return low | high << 4, scales[best].reshape(len(weights), -1)
