"""EncoderAdapter: a model of any making becomes an encoder, of two functions and what they read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.bundle.batched_encoder import Array, BatchedEncoder, Integers
from encoders.errors import ArgumentError, BundleError
from encoders.features.registry import FeatureKind, feature_kind


class EncoderAdapter(BatchedEncoder):
    """An encoder over functions that take padded batches: they may call torch, ONNX Runtime or a server.

    It computes and standardises features, batches by length, cuts motions that are too long into windows, tokenises and
    caches sentences, and brings vectors to length 1.

    Parameters
    ----------
    name, fingerprint : str
        What people call the model, and what changes whenever its vectors do, such as the sha256 of its weights.
    features : FeatureKind or str
        What it reads of a motion, with its frame rate; or the name of a registered kind.
    latent_size : int
        Numbers D of a vector.
    max_frames : int
        Longest motion, in feature frames, that is encoded as a whole.
    motions : function of features (N, T, F) float32 and lengths (N,) int64 -> (N, D)
        Features past a length are 0, the mean.
    tokenizer : function of sentences -> token ids of each; or a `tokenizers.Tokenizer`
    texts : function of input_ids (N, L) and attention_mask (N, L), int64 -> (N, D)
    mean, std : array (F,), optional
        Features are standardised by them.
    calibration : mapping of arrays, optional
        See `motionseek.Encoder.calibration`.

    Raises
    ------
    ArgumentError
        If a number is not positive, or mean and std are not of the features' size, finite and positive.
    """

    def __init__(
        self,
        *,
        name: str,
        fingerprint: str,
        features: FeatureKind | str,
        latent_size: int,
        max_frames: int,
        motions: Callable[[Array, Integers], ArrayLike],
        tokenizer: Callable[[list[str]], Sequence[Sequence[int]]] | Any,
        texts: Callable[[Integers, Integers], ArrayLike],
        mean: ArrayLike | None = None,
        std: ArrayLike | None = None,
        calibration: Mapping[str, NDArray[Any]] | None = None,
    ) -> None:
        kind = feature_kind(features) if isinstance(features, str) else features
        if latent_size < 1 or max_frames < 1:
            raise ArgumentError(f"latent_size={latent_size} and max_frames={max_frames} must be positive")
        super().__init__(name, fingerprint, kind, max_frames, latent_size)
        self._mean = _statistic("mean", 0.0 if mean is None else mean, kind)
        self._std = _statistic("std", 1.0 if std is None else std, kind)
        if not (self._std > 0).all():
            raise ArgumentError("std must be positive")
        self._motions, self._texts = motions, texts
        self._tokenizer = tokenizer
        self._calibration = calibration

    @property
    def calibration(self) -> Mapping[str, NDArray[Any]] | None:
        """The arrays that were given."""
        return self._calibration

    def _tokenize(self, sentences: list[str]) -> list[list[int]]:
        if callable(self._tokenizer):
            return [list(ids) for ids in self._tokenizer(sentences)]
        return [list(encoding.ids) for encoding in self._tokenizer.encode_batch(sentences)]

    def _motion_latents(self, features: Array, lengths: Integers) -> Array:
        counts = np.arange(features.shape[1]) < lengths[:, None]
        standardised = np.where(counts[..., None], (features - self._mean) / self._std, np.float32(0))
        return self._checked(self._motions(standardised.astype(np.float32), lengths), len(features))

    def _text_latents(self, ids: Integers, mask: Integers) -> Array:
        return self._checked(self._texts(ids, mask), len(ids))

    def _checked(self, vectors: ArrayLike, count: int) -> Array:
        given = np.asarray(vectors)
        if given.shape != (count, self.latent_size) or given.dtype.kind != "f":
            raise BundleError(f"{self.name}: {given.dtype} {given.shape}, not vectors ({count}, {self.latent_size})")
        return given


def _statistic(name: str, values: ArrayLike, kind: FeatureKind) -> Array:
    given = np.asarray(values, np.float32)
    if given.shape not in ((), (kind.size,)) or not np.isfinite(given).all():
        raise ArgumentError(f"{name} {given.shape} must be ({kind.size},), one finite number a feature")
    return np.broadcast_to(given, (kind.size,))
