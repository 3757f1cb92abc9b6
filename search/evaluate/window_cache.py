"""An encoder that encodes no window twice, so that many queries of one take cost little more than one."""

from __future__ import annotations

from collections.abc import Collection
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder

_DIGEST_BYTES = 16


class WindowCache:
    """Behaves like the encoder it wraps, and caches the vector of every window by the window's content."""

    def __init__(self, encoder: Encoder) -> None:
        self.name, self.fingerprint, self.feature_kind = encoder.name, encoder.fingerprint, encoder.feature_kind
        self.fps, self.max_frames, self.latent_size = encoder.fps, encoder.max_frames, encoder.latent_size
        self.calibration = encoder.calibration
        self.features, self.encode_features = encoder.features, encoder.encode_features
        self.encode_motions, self.encode_texts = encoder.encode_motions, encoder.encode_texts
        self._encode_windows = encoder.encode_windows
        self._vectors: dict[int, dict[bytes, NDArray[np.float32]]] = {}

    def encode_windows(
        self, features: NDArray[np.float32], starts: NDArray[np.integer], length: int
    ) -> NDArray[np.float32]:
        """See `Encoder.encode_windows`."""
        cached = self._vectors.setdefault(length, {})
        keys = [_digest(features[start : start + length]) for start in starts]
        new = {key: start for key, start in zip(keys, starts, strict=True) if key not in cached}
        if new:
            vectors = self._encode_windows(features, np.array([*new.values()]), length)
            cached.update(zip(new, vectors, strict=True))
        return np.array([cached[key] for key in keys], np.float32).reshape(-1, self.latent_size)

    def keep_only(self, lengths: Collection[int]) -> None:
        """Drop the windows of all other lengths, in feature frames."""
        self._vectors = {length: vectors for length, vectors in self._vectors.items() if length in lengths}


def _digest(window: NDArray[np.float32]) -> bytes:
    return blake2b(np.ascontiguousarray(window).data, digest_size=_DIGEST_BYTES).digest()
