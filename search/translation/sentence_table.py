"""The table of English sentences about movement, with their meaning in multilingual vectors and their concepts.

The multilingual vectors are those of Google's universal-sentence-encoder-multilingual-3, projected on their principal
components and kept as bytes. `python -m benchmarks.make_sentences` writes the table. It holds nothing of our own model.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from search.translation.concepts import concept_names

FILE = Path(__file__).with_name("sentences.npz")
#: Vectors are kept as whole numbers of this size.
_STEP = 1 / 127
#: How much less a common concept counts: the power of its inverse document frequency.
_RARITY = 0.5


@dataclass(frozen=True, eq=False)
class SentenceTable:
    """English sentences.

    Attributes
    ----------
    sentences : tuple of str (N,)
    basis : float32 array (512, E)
        What a multilingual vector is projected on.
    vectors : float32 array (N, E)
        Of the sentences, projected.
    rows, concepts : int64 arrays (M,)
        Which sentence names which concept.
    """

    sentences: tuple[str, ...]
    basis: NDArray[np.float32]
    vectors: NDArray[np.float32]
    rows: NDArray[np.int64]
    concepts: NDArray[np.int64]

    def likeness(self, concepts: NDArray[np.int64]) -> NDArray[np.float64]:
        """How far what the sentences name is the same as given concepts (N,), 0 to 1: the cosine of weighted sets."""
        weights = self._weights()
        asked = np.zeros(len(weights))
        asked[concepts] = weights[concepts] ** 2
        count = len(self.sentences)
        shared = np.bincount(self.rows, asked[self.concepts], count)
        sizes = np.bincount(self.rows, weights[self.concepts] ** 2, count)
        return np.asarray(shared / np.sqrt(np.maximum(sizes * asked.sum(), 1e-9)))

    def _weights(self) -> NDArray[np.float64]:
        """How much each concept counts, from how few sentences name it."""
        named = np.bincount(self.concepts, minlength=len(concept_names()))
        return np.asarray(np.log((1 + len(self.sentences)) / (1 + named)) ** _RARITY)


@cache
def sentence_table() -> SentenceTable:
    """The shipped table."""
    with np.load(FILE) as file:
        sentences = tuple(file["text"].tobytes().decode().split("\n"))
        vectors = file["vectors"].astype(np.float32) * _STEP
        rows = np.repeat(np.arange(len(sentences)), file["counts"])
        return SentenceTable(sentences, file["basis"].astype(np.float32), vectors, rows, file["concepts"].astype(int))


def write_table(
    path: Path, sentences: list[str], multilingual: NDArray[np.float32], concepts: list[NDArray[np.int64]], size: int
) -> None:
    """Write a table of sentences with their concepts and multilingual vectors (N, 512), projected to `size` numbers."""
    _, _, components = np.linalg.svd(multilingual[:: max(1, len(multilingual) // 5000)], full_matrices=False)
    basis = components[:size].T.astype(np.float16)
    projected = multilingual @ basis.astype(np.float32)
    np.savez_compressed(
        path,
        text=np.frombuffer("\n".join(sentences).encode(), np.uint8),
        basis=basis,
        vectors=np.round(projected / _STEP).astype(np.int8),
        counts=np.array([len(row) for row in concepts], np.uint8),
        concepts=np.concatenate(concepts).astype(np.uint16),
    )
