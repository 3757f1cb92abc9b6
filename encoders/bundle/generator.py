"""A bundle as a generator: a sentence, or a label, is a Gaussian over latents, and a latent decodes to a motion.

After TEMOS (Petrovich, Black and Varol, ECCV 2022), whose text encoder gives the Gaussian, TMR's synthesis branch,
which is the same, and ACTOR (ICCV 2021), which has one of each label. onnxruntime alone, as to encode.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random import Generator as Random
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.bundle.calibration_file import read_arrays
from encoders.bundle.generator_files import DECODER, LABELS, SENTENCES
from encoders.bundle.manifest import TEXT, TOKENIZER
from encoders.bundle.sessions import open_session
from encoders.bundle.tokenizer_file import read_tokenizer
from encoders.errors import ArgumentError, BundleError
from encoders.features.recovery import recovered_motion
from encoders.motion import Motion

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

Array = NDArray[np.float32]

#: Feature frames of the shortest motion, and motions that are decoded at once.
SHORTEST, MOST = 4, 64


@dataclass(frozen=True)
class LatentGaussian:
    """A diagonal Gaussian: mean and logarithm of the variance (Z,)."""

    mu: Array
    logvar: Array

    def sample(self, count: int, rng: Random) -> Array:
        """Draws (count, Z)."""
        noise = rng.standard_normal((count, len(self.mu))).astype(np.float32)
        drawn: Array = self.mu + noise * np.exp(self.logvar / 2)
        return drawn


class MotionGenerator:
    """The generator of a bundle.

    Raises
    ------
    BundleError
        If the bundle has no decoder.
    """

    def __init__(self, bundle: Bundle) -> None:
        if DECODER not in bundle.manifest["files"]:
            raise BundleError(
                f"{bundle.folder}: the model {bundle.name!r} has no decoder, so it finds motions and makes none; "
                "'motionseek model decoder' trains one beside it (docs/generating.md)"
            )
        self._bundle = bundle

    @property
    def longest(self) -> float:
        """Seconds of the longest motion."""
        return self._bundle.max_frames / self._bundle.fps

    @cached_property
    def labels(self) -> dict[str, LatentGaussian]:
        """The Gaussian of each label; empty where the bundle knows none."""
        if LABELS not in self._bundle.manifest["files"]:
            return {}
        path = self._bundle.folder / LABELS
        arrays = read_arrays(path)
        try:
            names, mu, logvar = (arrays[key] for key in ("names", "mu", "logvar"))
            if mu.shape != logvar.shape or mu.ndim != 2 or len(mu) != len(names) or names.dtype.kind != "U":
                raise ValueError("its arrays do not fit")
        except (KeyError, ValueError) as error:
            raise BundleError(f"{path}: holds no labels ({error})") from error
        rows = zip(names.tolist(), mu.astype(np.float32), logvar.astype(np.float32), strict=True)
        return {name: LatentGaussian(*row) for name, *row in rows}

    def of_sentence(self, sentence: str) -> LatentGaussian:
        """The Gaussian of the motions that a sentence may mean."""
        if SENTENCES in self._bundle.manifest["files"]:
            vector = self._bundle.encode_texts([sentence])
            return self._gaussian(SENTENCES, {"vector": vector}, ("mu", "logvar"))
        ids = np.array([read_tokenizer(self._bundle.folder / TOKENIZER).encode(sentence).ids], np.int64)
        return self._gaussian(TEXT, {"input_ids": ids, "attention_mask": np.ones_like(ids)}, ("latent", "logvar"))

    def of_label(self, label: str) -> LatentGaussian:
        """The Gaussian of a label's motions.

        Raises
        ------
        ArgumentError
            If the bundle does not know it.
        """
        if label in self.labels:
            return self.labels[label]
        if not self.labels:
            raise ArgumentError(f"the model {self._bundle.name!r} knows no labels; describe the motion in a sentence")
        near = difflib.get_close_matches(label, self.labels, n=3)
        hint = f"near: {', '.join(near)}" if near else f"it knows {len(self.labels)}, such as {min(self.labels)!r}"
        raise ArgumentError(f"the model {self._bundle.name!r} knows no label {label!r}; {hint}")

    def motions(self, gaussian: LatentGaussian, seconds: float, count: int, rng: Random) -> list[Motion]:
        """Motions at 20 frames a second, each of another draw.

        Parameters
        ----------
        seconds : float
            Of each motion, up to `longest`.
        count : int
            Up to `MOST`.

        Raises
        ------
        ArgumentError
            If they would be too long, too short, or too many.
        """
        frames = round(seconds * self._bundle.fps)
        shortest = SHORTEST / self._bundle.fps
        if not SHORTEST <= frames <= self._bundle.max_frames:
            raise ArgumentError(f"seconds={seconds:g}: the model makes motions of {shortest:g} to {self.longest:g} s")
        if not 1 <= count <= MOST:
            raise ArgumentError(f"count={count}: 1 to {MOST} motions are made at once")
        feed = {"latent": gaussian.sample(count, rng), "lengths": np.full(count, frames, np.int64)}
        (features,) = self._run(DECODER, feed, ("features",))
        if features.shape[:1] + features.shape[2:] != (count, self._feature_size) or features.shape[1] < frames:
            raise BundleError(f"{self._bundle.folder / DECODER}: gives no features of this model")
        if not np.isfinite(features).all():
            raise BundleError(f"{self._bundle.folder / DECODER}: gives values that are no numbers")
        return [recovered_motion(self._bundle.feature_kind, rows[:frames]) for rows in features]

    @cached_property
    def _feature_size(self) -> int:
        still = Motion(np.zeros((2, 22, 3), np.float32))
        return int(self._bundle.features(still).shape[1])

    @cached_property
    def _sessions(self) -> dict[str, InferenceSession]:
        return {}

    def _gaussian(self, name: str, feed: dict[str, Any], outputs: Sequence[str]) -> LatentGaussian:
        mu, logvar = self._run(name, feed, outputs)
        return LatentGaussian(mu[0], logvar[0])

    def _run(self, name: str, feed: dict[str, Any], outputs: Sequence[str]) -> list[Array]:
        """Outputs of a graph by their names."""
        path = self._bundle.folder / name
        if name not in self._sessions:
            self._sessions[name] = open_session(path)
        try:
            found: list[Array] = self._sessions[name].run(list(outputs), feed)
        except Exception as error:  # onnxruntime's errors have no common base but Exception
            raise BundleError(f"{path}: fails at work ({str(error)[:500]})") from error
        return found
