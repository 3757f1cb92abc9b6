"""A model bundle at work: motions and sentences become unit vectors, with onnxruntime and tokenizers alone."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_path
from encoders.bundle.batched_encoder import Array, BatchedEncoder, Integers
from encoders.bundle.calibration_file import read_arrays
from encoders.bundle.manifest import CALIBRATION, MOTION, TEXT, TOKENIZER, Manifest, read_manifest
from encoders.bundle.sessions import open_session, run
from encoders.bundle.tokenizer_file import read_tokenizer
from encoders.errors import BundleError
from encoders.features.registry import feature_kind

if TYPE_CHECKING:
    from onnxruntime import InferenceSession
    from tokenizers import Tokenizer

DEFAULT = Path(__file__).parent / "default"


class Bundle(BatchedEncoder):
    """A loaded bundle; `Bundle.load` makes one. Safe to share between threads.

    Attributes
    ----------
    manifest : mapping
        The contents of manifest.json.
    """

    def __init__(self, folder: Path, manifest: Manifest, threads: int | None = None) -> None:
        kind = feature_kind(manifest.feature_kind)
        super().__init__(manifest.name, manifest.fingerprint, kind, manifest.max_frames, manifest.latent_size)
        self.folder = folder
        self.manifest: Mapping[str, Any] = manifest.values
        self._threads = threads
        self._lock = threading.RLock()
        self._sessions: dict[str, InferenceSession] = {}

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

    def _tokenize(self, sentences: list[str]) -> list[list[int]]:
        return [list(encoding.ids) for encoding in self._tokenizer.encode_batch(sentences)]

    def _motion_latents(self, features: Array, lengths: Integers) -> Array:
        return self._run(MOTION, {"features": features, "lengths": lengths})

    def _text_latents(self, ids: Integers, mask: Integers) -> Array:
        return self._run(TEXT, {"input_ids": ids, "attention_mask": mask})

    def _run(self, name: str, feed: dict[str, NDArray[Any]]) -> Array:
        """Vectors, one for each row of the inputs."""
        latents = run(self._session(name), self.folder / name, feed)
        rows = len(next(iter(feed.values())))
        if latents.shape != (rows, self.latent_size) or latents.dtype.kind != "f":
            raise BundleError(f"{self.folder / name}: gives no vectors of {self.latent_size} numbers")
        return np.asarray(latents, np.float32)

    def _session(self, name: str) -> InferenceSession:
        with self._lock:
            if name not in self._sessions:
                session = open_session(self.folder / name, self._threads, int8=name == MOTION)
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


def _fixed(shape: Sequence[int | str]) -> list[int | None]:
    """A graph's shape with None for every free dimension."""
    return [size if isinstance(size, int) else None for size in shape]
