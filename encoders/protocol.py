"""Encoder: what a model must offer, so that motions can be indexed with it and searched by sentences.

`encoders.bundle.bundle.Bundle` is one; any object with these members is another, without deriving from anything.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from encoders.motion import Motion


class Encoder(Protocol):
    """Motions and sentences become unit vectors of one space. Its methods may be called from several threads."""

    @property
    def name(self) -> str:
        """What people call the model."""

    @property
    def fingerprint(self) -> str:
        """Two encoders of one fingerprint give the same vectors; a library holds vectors of one fingerprint."""

    @property
    def feature_kind(self) -> str:
        """Name of its features, a key of `encoders.features.registry.FEATURE_KINDS` for those of the project."""

    @property
    def fps(self) -> float:
        """Feature frames a second."""

    @property
    def max_frames(self) -> int:
        """Longest motion, in feature frames, that is encoded as a whole."""

    @property
    def latent_size(self) -> int:
        """Size D of a vector."""

    @property
    def calibration(self) -> Mapping[str, NDArray[Any]] | None:
        """Arrays that `search.ranking` calibrates scores with, None for a model without.

        Among them "motions": unit vectors (M, D) of unrelated motion.
        """

    def features(self, motion: Motion) -> NDArray[np.float32]:
        """The features (T', F) of a motion; windows of the motion are slices of them."""

    def encode_features(self, features: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
        """Unit vectors (N, D) of N feature sequences (T', F) of any lengths."""

    def encode_windows(
        self, features: NDArray[np.float32], starts: NDArray[np.integer], length: int
    ) -> NDArray[np.float32]:
        """Unit vectors (N, D) of the windows ``features[start : start + length]`` at starts (N,)."""

    def encode_motions(self, motions: Sequence[Motion]) -> NDArray[np.float32]:
        """Unit vectors (N, D) of motions of any duration and frame rate."""

    def encode_texts(self, sentences: Sequence[str]) -> NDArray[np.float32]:
        """Unit vectors (N, D) of sentences."""
