"""Token features of many sentences under the frozen language model, computed once and kept flat."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.tmr.text.language_model import LanguageModel, mean_embeddings


class TokenTable:
    """Features of the tokens of each distinct sentence.

    Attributes
    ----------
    features : float16 (sum of L, width); offsets : int64 (N + 1)
    sentences : float32 (N, width), unit sentence embeddings
    """

    def __init__(
        self, texts: Sequence[str], language: LanguageModel, cache: Path | None = None, *, bf16: bool = False
    ) -> None:
        model = f"{language.name} bf16" if bf16 else language.name
        stored = None if cache is None else cache / f"tokens-{_digest(texts, model)}.npz"
        if stored is not None and stored.exists():
            with np.load(stored, allow_pickle=False) as arrays:
                self.features, self.offsets = arrays["features"], arrays["offsets"]
                self.sentences = arrays["sentences"]
            return
        blocks, means = [], []
        for start in range(0, len(texts), 4096):
            rows = language.token_features(texts[start : start + 4096], bf16=bf16)
            blocks += [row.astype(np.float16) for row in rows]
            means.append(mean_embeddings(rows))
        self.features = np.concatenate(blocks)
        self.offsets = np.cumsum([0, *map(len, blocks)])
        self.sentences = np.concatenate(means)
        if stored is not None:
            cache.mkdir(parents=True, exist_ok=True)  # type: ignore[union-attr]
            partial = stored.with_suffix(".partial.npz")  # an interrupted run leaves no partial table
            np.savez(partial, features=self.features, offsets=self.offsets, sentences=self.sentences)
            os.replace(partial, stored)

    def rows(self, indices: Sequence[int]) -> list[NDArray[np.float16]]:
        """Token features (L, width) of some sentences."""
        return [self.features[self.offsets[i] : self.offsets[i + 1]] for i in indices]


def _digest(texts: Sequence[str], model: str) -> str:
    digest = hashlib.sha256(model.encode())
    for text in texts:
        digest.update(text.encode() + b"\n")
    return digest.hexdigest()[:16]
