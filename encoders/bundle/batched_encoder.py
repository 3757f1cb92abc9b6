"""BatchedEncoder: an encoder over two networks that take padded batches of features and of tokens."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_list, checked_sentences
from encoders.bundle.batching import length_buckets, pad
from encoders.bundle.windows import window_starts
from encoders.errors import ArgumentError
from encoders.features.registry import FeatureKind
from encoders.motion import Motion

Array = NDArray[np.float32]
Integers = NDArray[np.int64]

#: Frames and tokens of a batch: enough for full matrix products, few enough for the cores' caches.
_FRAMES_A_BATCH = 512
_TOKENS_A_BATCH = 512
#: A vocabulary to describe with, and recent questions with their paraphrases: 4 MB.
_SENTENCES_CACHED = 4096


class BatchedEncoder(ABC):
    """What every such encoder shares: batches of like length, windows of long motions, unit vectors, cached sentences.

    Attributes
    ----------
    name, fingerprint : str
        Two encoders of one fingerprint give the same vectors.
    fps : float
        Feature frames a second.
    max_frames : int
        Longest motion, in feature frames, that passes the encoder as a whole.
    latent_size : int
        Numbers a vector.
    """

    def __init__(self, name: str, fingerprint: str, kind: FeatureKind, max_frames: int, latent_size: int) -> None:
        self.name = name
        self.fingerprint = fingerprint
        self.feature_kind = kind.name
        self.fps = kind.fps
        self.max_frames = max_frames
        self.latent_size = latent_size
        self._kind = kind
        # Sentence -> a list that holds its vector once it is encoded: new sentences are encoded in batches.
        self._cached_latent = lru_cache(_SENTENCES_CACHED)(_no_latent)

    @property
    @abstractmethod
    def calibration(self) -> Mapping[str, NDArray[Any]] | None:
        """See `encoders.protocol.Encoder.calibration`."""

    @abstractmethod
    def _tokenize(self, sentences: list[str]) -> list[list[int]]:
        """Token ids of each sentence, at least one."""

    @abstractmethod
    def _motion_latents(self, features: Array, lengths: Integers) -> Array:
        """Vectors (N, D) of features (N, T, F), of which the first `lengths` (N,) count."""

    @abstractmethod
    def _text_latents(self, ids: Integers, mask: Integers) -> Array:
        """Vectors (N, D) of token ids (N, L), of which those count where the mask is 1."""

    def features(self, motion: Motion) -> Array:
        """The features (T', F) this model reads; windows of the motion are slices of them."""
        return self._kind.compute(motion)

    def features_of(self, motions: Sequence[Motion]) -> list[Array]:
        """The `features` of motions; of equal length at once, where the kind can."""
        many = self._kind.compute_many
        return many(motions) if many else [self.features(motion) for motion in motions]

    def encode_features(self, features: Sequence[Array]) -> Array:
        """Unit vectors (N, D) of N feature sequences (T', F); a longer one than the model reads as a whole is the mean
        of its half-overlapping windows."""
        features = checked_list("features", features, np.ndarray)
        for sequence in features:
            self._check(sequence)
        latents = np.empty((len(features), self.latent_size), np.float32)
        whole = [i for i, sequence in enumerate(features) if len(sequence) <= self.max_frames]
        for batch in length_buckets([len(features[i]) for i in whole], _FRAMES_A_BATCH):
            rows = [whole[i] for i in batch]
            latents[rows] = self._encode(*pad([features[i] for i in rows]))
        for i in sorted(set(range(len(features))) - set(whole)):
            starts = window_starts(len(features[i]), self.max_frames, self.max_frames // 2)
            latents[i] = normalised(self.encode_windows(features[i], starts, self.max_frames).mean(axis=0))
        return latents

    def encode_windows(self, features: Array, starts: NDArray[np.integer], length: int) -> Array:
        """Unit vectors (N, D) of the windows ``features[start : start + length]``; memory does not grow with N."""
        self._check(features)
        starts = np.asarray(starts, np.int64)
        if length < 1 or (len(starts) and (starts.min() < 0 or starts.max() + length > len(features))):
            raise ArgumentError(f"windows of {length} frames must lie inside the {len(features)} frames")
        latents = np.empty((len(starts), self.latent_size), np.float32)
        size = max(1, _FRAMES_A_BATCH // length)
        for first in range(0, len(starts), size):
            batch = starts[first : first + size]
            windows = features[batch[:, None] + np.arange(length)]
            latents[first : first + size] = self._encode(windows, np.full(len(batch), length, np.int64))
        return latents

    def encode_motions(self, motions: Sequence[Motion]) -> Array:
        """Unit vectors (N, D), see `encode_features`."""
        return self.encode_features(self.features_of(checked_list("motions", motions, Motion)))

    def encode_texts(self, sentences: Sequence[str]) -> Array:
        """Unit vectors (N, D) of N sentences; those of the last few thousand are cached."""
        sentences = checked_sentences("sentences", sentences)
        cached = {sentence: self._cached_latent(sentence) for sentence in sentences}
        new = [sentence for sentence, latent in cached.items() if not latent]
        for sentence, latent in zip(new, self._encode_new_texts(new), strict=True):
            cached[sentence][:] = [latent]
        return np.array([cached[sentence][0] for sentence in sentences], np.float32).reshape(-1, self.latent_size)

    def _encode_new_texts(self, sentences: list[str]) -> Array:
        latents = np.empty((len(sentences), self.latent_size), np.float32)
        if not sentences:
            return latents
        ids = [np.array(row, np.int64) for row in self._tokenize(sentences)]
        for batch in length_buckets([len(row) for row in ids], _TOKENS_A_BATCH):
            padded, lengths = pad([ids[i] for i in batch])
            mask = (np.arange(padded.shape[1]) < lengths[:, None]).astype(np.int64)
            latents[batch] = normalised(self._text_latents(padded, mask))
        return latents

    def _encode(self, features: Array, lengths: Integers) -> Array:
        return normalised(self._motion_latents(np.asarray(features, np.float32), lengths))

    def _check(self, features: Array) -> None:
        size = self._kind.size
        if features.ndim != 2 or features.shape[1] != size or len(features) == 0:
            raise ArgumentError(f"features {features.shape} must be (T', {size}) with T' >= 1")


def normalised(latents: Array) -> Array:
    """Unit vectors (N, D); zero stays zero."""
    return np.asarray(latents / np.maximum(np.linalg.norm(latents, axis=-1, keepdims=True), 1e-12), np.float32)


def _no_latent(sentence: str) -> list[Array]:
    """The entry of a sentence that is not encoded yet."""
    return []
