"""A model bundle at work: motions and sentences become unit vectors, with onnxruntime and tokenizers alone."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_list, checked_path, checked_sentences
from encoders.bundle.batching import length_buckets, pad
from encoders.bundle.calibration_file import read_arrays
from encoders.bundle.manifest import CALIBRATION, MOTION, TEXT, TOKENIZER, Manifest, read_manifest
from encoders.bundle.sessions import open_session, run
from encoders.bundle.tokenizer_file import read_tokenizer
from encoders.bundle.windows import window_starts
from encoders.errors import ArgumentError, BundleError
from encoders.features.registry import feature_kind
from encoders.motion import Motion

if TYPE_CHECKING:
    from onnxruntime import InferenceSession
    from tokenizers import Tokenizer

Array = NDArray[np.float32]

DEFAULT = Path(__file__).parent / "default"

#: Frames and tokens of a batch: enough for full matrix products, few enough for the cores' caches.
_FRAMES_A_BATCH = 512
_TOKENS_A_BATCH = 512
#: A vocabulary to describe with, and recent questions with their paraphrases: 4 MB.
_SENTENCES_CACHED = 4096


class Bundle:
    """A loaded bundle; `Bundle.load` makes one. Safe to share between threads.

    Attributes
    ----------
    name, fingerprint : str
        Two bundles of one fingerprint give the same vectors.
    fps : float
        Feature frames a second.
    max_frames : int
        Longest motion, in feature frames, that passes the encoder as a whole.
    latent_size : int
        Numbers a vector.
    manifest : mapping
        The contents of manifest.json.
    """

    def __init__(self, folder: Path, manifest: Manifest, threads: int | None = None) -> None:
        self.folder = folder
        self.name = manifest.name
        self.fingerprint = manifest.fingerprint
        self.feature_kind = manifest.feature_kind
        self._kind = feature_kind(manifest.feature_kind)
        self.fps = self._kind.fps
        self.max_frames = manifest.max_frames
        self.latent_size = manifest.latent_size
        self.manifest: Mapping[str, Any] = manifest.values
        self._threads = threads
        self._lock = threading.RLock()
        self._sessions: dict[str, InferenceSession] = {}
        # Sentence -> a list that holds its vector once it is encoded: new sentences are encoded in batches.
        self._cached_latent = lru_cache(_SENTENCES_CACHED)(_no_latent)

    @classmethod
    def load(cls, folder: str | Path | None = None, *, threads: int | None = None) -> Bundle:
        """Open a bundle folder, None for the default one, and check it.

        Graphs are loaded on first use: encoding motions alone never loads the language model.

        Parameters
        ----------
        threads : int, optional
            Threads of each graph; by default one a core.

        Raises
        ------
        BundleError
            If the folder is no bundle or is damaged; see `read_manifest`.
        """
        folder = DEFAULT if folder is None else checked_path("folder", folder)
        return cls(folder, read_manifest(folder), threads)

    @property
    def megabytes(self) -> float:
        """What its files take on disk, in units of 10^6 bytes."""
        sizes = [(self.folder / name).stat().st_size for name in self.manifest["files"]]
        return float(sum(sizes)) / 1e6

    @cached_property
    def calibration(self) -> dict[str, NDArray[Any]] | None:
        """The arrays that scores are calibrated with, if any; float16 ones as float32."""
        if CALIBRATION not in self.manifest["files"]:
            return None
        arrays = read_arrays(self.folder / CALIBRATION)
        return {name: a.astype(np.float32) if a.dtype == np.float16 else a for name, a in arrays.items()}

    def features(self, motion: Motion) -> Array:
        """The features (T', F) this model reads; windows of the motion are slices of them."""
        return self._kind.compute(motion)

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
            latents[i] = _normalised(self.encode_windows(features[i], starts, self.max_frames).mean(axis=0))
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
        return self.encode_features([self.features(motion) for motion in checked_list("motions", motions, Motion)])

    def encode_texts(self, sentences: Sequence[str]) -> Array:
        """Unit vectors (N, D) of N sentences; those of the last few thousand are cached."""
        sentences = checked_sentences("sentences", sentences)
        cached = {sentence: self._cached_latent(sentence) for sentence in sentences}
        new = [sentence for sentence, latent in cached.items() if not latent]
        for sentence, latent in zip(new, self._encode_new_texts(new), strict=True):
            cached[sentence][:] = [latent]
        return np.array([cached[sentence][0] for sentence in sentences], np.float32).reshape(-1, self.latent_size)

    def _encode_new_texts(self, sentences: Sequence[str]) -> Array:
        latents = np.empty((len(sentences), self.latent_size), np.float32)
        if not sentences:
            return latents
        ids = [np.array(encoding.ids, np.int64) for encoding in self._tokenizer.encode_batch(list(sentences))]
        for batch in length_buckets([len(row) for row in ids], _TOKENS_A_BATCH):
            padded, lengths = pad([ids[i] for i in batch])
            mask = (np.arange(padded.shape[1]) < lengths[:, None]).astype(np.int64)
            latents[batch] = self._run(TEXT, {"input_ids": padded, "attention_mask": mask})
        return latents

    def _check(self, features: Array) -> None:
        size = self._kind.size
        if features.ndim != 2 or features.shape[1] != size or len(features) == 0:
            raise ArgumentError(f"features {features.shape} must be (T', {size}) with T' >= 1")

    def _encode(self, features: Array, lengths: NDArray[np.int64]) -> Array:
        return self._run(MOTION, {"features": np.asarray(features, np.float32), "lengths": lengths})

    def _run(self, name: str, feed: dict[str, NDArray[Any]]) -> Array:
        """Unit vectors, one for each row of the inputs."""
        latents = run(self._session(name), self.folder / name, feed)
        rows = len(next(iter(feed.values())))
        if latents.shape != (rows, self.latent_size) or latents.dtype.kind != "f":
            raise BundleError(f"{self.folder / name}: gives no vectors of {self.latent_size} numbers")
        return _normalised(latents)

    def _session(self, name: str) -> InferenceSession:
        with self._lock:
            if name not in self._sessions:
                session = open_session(self.folder / name, self._threads)
                size = self._kind.size
                inputs = {
                    MOTION: {"features": [None, None, size], "lengths": [None]},
                    TEXT: {"input_ids": [None, None], "attention_mask": [None, None]},
                }
                found = {node.name: _fixed(node.shape) for node in session.get_inputs()}
                if found != inputs[name] or _fixed(session.get_outputs()[0].shape) != [None, self.latent_size]:
                    raise BundleError(f"{self.folder / name}: does not fit its manifest or this version's features")
                self._sessions[name] = session
            return self._sessions[name]

    @cached_property
    def _tokenizer(self) -> Tokenizer:
        return read_tokenizer(self.folder / TOKENIZER)


def _no_latent(sentence: str) -> list[Array]:
    """The entry of a sentence that is not encoded yet."""
    return []


def _fixed(shape: Sequence[int | str]) -> list[int | None]:
    """A graph's shape with None for every free dimension."""
    return [size if isinstance(size, int) else None for size in shape]


def _normalised(latents: Array) -> Array:
    return np.asarray(latents / np.maximum(np.linalg.norm(latents, axis=-1, keepdims=True), 1e-12), np.float32)
