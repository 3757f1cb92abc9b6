"""Encoder: what a model must offer, so that motions can be indexed with it and searched by sentences.

`encoders.bundle.bundle.Bundle` is one; any object with these members is another, without deriving from anything.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from encoders.motion import Motion


@runtime_checkable
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
        """Arrays that scores are calibrated with, each of which may be missing; None for a model without any.

        "motions" : float array (M, D)
            Unit vectors of unrelated motion. Without them there is neither a hubness penalty nor a strength.
        "sentence_coefficients", "motion_coefficients" : float array (3,)
            The logistic curves of strength, for queries that are sentences and motions: see
            `search.ranking.strength.probability`. Without one, hits of such queries have no strength.
        "words" : str array (W,)
            Sorted, in lower case: the words that the model knows. Without them no hit is downgraded.
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


@runtime_checkable
class TokenEncoder(Encoder, Protocol):
    """An encoder that has several vectors of a motion and of a sentence, too, by which the first hits are ranked again.

    See `search.ranking.late_interaction`.
    """

    def motion_tokens(self, features: Sequence[NDArray[np.float32]]) -> list[NDArray[np.float32]]:
        """Unit vectors (n, E), one for each part of a motion, of N feature sequences (T', F)."""

    def text_tokens(self, sentences: Sequence[str]) -> list[NDArray[np.float32]]:
        """Unit vectors (m, E), one for each word that counts, of N sentences."""


def unrelated_motions(encoder: Encoder) -> NDArray[np.float32] | None:
    """The unit vectors (M, D) of unrelated motion that an encoder is calibrated with; None for one without."""
    motions = (encoder.calibration or {}).get("motions")
    return None if motions is None or len(motions) == 0 else np.asarray(motions, np.float32)
