"""Standardisation of features."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_FILE = "normaliser.npz"


@dataclass(frozen=True)
class Normaliser:
    """Mean and standard deviation of every feature (F,)."""

    mean: NDArray[np.float32]
    std: NDArray[np.float32]

    @classmethod
    def of(cls, features: NDArray[np.floating]) -> Normaliser:
        """From features (N, F), at most 200,000 rows of which are used."""
        rows = features[:: max(1, len(features) // 200_000)].astype(np.float32)
        return cls(rows.mean(0), np.maximum(rows.std(0), 0.02))

    def save(self, run: Path) -> None:
        """Write it into a run's folder."""
        np.savez(run / _FILE, mean=self.mean, std=self.std)

    @classmethod
    def load(cls, run: Path) -> Normaliser:
        """Inverse of `save`."""
        with np.load(run / _FILE, allow_pickle=False) as arrays:
            return cls(arrays["mean"], arrays["std"])
