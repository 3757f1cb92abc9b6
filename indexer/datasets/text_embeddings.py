"""Embeddings of a data set's sentences that were computed beforehand, as TMR publishes them.

token_embeddings/distilbert-base-uncased.npy             features of all tokens (sum of L, width)
token_embeddings/distilbert-base-uncased_slice.npy       first and last row of each sentence (N, 2)
token_embeddings/distilbert-base-uncased_index.json      {sentence: N}
sent_embeddings/sentence-transformers/all-mpnet-base-v2.npy          unit vectors (N, E)
sent_embeddings/sentence-transformers/all-mpnet-base-v2_index.json
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import DatasetError

_TOKENS, _SENTENCES = "token_embeddings", "sent_embeddings"
#: The models of published TMR, preferred where there are several.
_PUBLISHED = ("distilbert-base-uncased", "sentence-transformers/all-mpnet-base-v2")
_UNIT_TOLERANCE = 0.01


@dataclass(frozen=True)
class StoredTokens:
    """Token features of sentences.

    Attributes
    ----------
    name : str
        The language model.
    width : int
        Numbers a token.
    """

    name: str
    width: int
    _features: NDArray[np.floating]
    _slices: NDArray[np.int64]
    _rows: dict[str, int]

    @classmethod
    def open(cls, folder: Path, name: str | None = None) -> StoredTokens | None:
        """Those of a data set's folder of annotations, by the language model of that name or the published one.

        Returns
        -------
        StoredTokens or None
            None where there are none, or none of that name.

        Raises
        ------
        DatasetError
            If they cannot be read or contradict each other, or several are there and none is the published one.
        """
        file = _choose(folder / _TOKENS, name)
        if file is None:
            return None
        features, slices = _array(file, 2), _array(file.with_name(f"{file.stem}_slice.npy"), 2)
        rows = _index(file, len(slices))
        if slices.shape[1] != 2 or slices.dtype.kind not in "iu" or not _inside(slices, len(features)):
            raise DatasetError(f"{file}: its _slice.npy names rows that are not there")
        return cls(_name(folder / _TOKENS, file), features.shape[1], features, slices.astype(np.int64), rows)

    def has(self, sentences: Sequence[str]) -> bool:
        """Whether all these sentences are among them."""
        return all(sentence in self._rows for sentence in sentences)

    def rows(self, sentences: Sequence[str]) -> list[NDArray[np.float32]]:
        """Token features (L, width) of each sentence; raises KeyError for one that is not there."""
        slices = [self._slices[self._rows[sentence]] for sentence in sentences]
        return [np.array(self._features[first:last], np.float32) for first, last in slices]


@dataclass(frozen=True)
class StoredSentences:
    """Sentence embeddings: unit vectors, by the model `name`."""

    name: str
    _vectors: NDArray[np.floating]
    _rows: dict[str, int]

    @classmethod
    def open(cls, folder: Path, name: str | None = None) -> StoredSentences | None:
        """As `StoredTokens.open`; also raises DatasetError where vectors are not of unit length."""
        file = _choose(folder / _SENTENCES, name)
        if file is None:
            return None
        vectors = _array(file, 2)
        lengths = np.linalg.norm(vectors.astype(np.float32), axis=1)
        if not (np.abs(lengths - 1) <= _UNIT_TOLERANCE).all():
            raise DatasetError(f"{file}: holds vectors that are not of unit length")
        return cls(_name(folder / _SENTENCES, file), vectors, _index(file, len(vectors)))

    def has(self, sentences: Sequence[str]) -> bool:
        """Whether all these sentences are among them."""
        return all(sentence in self._rows for sentence in sentences)

    def rows(self, sentences: Sequence[str]) -> NDArray[np.float32]:
        """Unit vectors (N, E); raises KeyError for a sentence that is not there."""
        return np.array(self._vectors[[self._rows[sentence] for sentence in sentences]], np.float32)


def _choose(folder: Path, name: str | None) -> Path | None:
    """The file of embeddings by a model of that name, else of the published one, else the only one."""
    files = sorted(folder.rglob("*_index.json"))
    found = {_name(folder, file): file for file in (f.with_name(f.name.replace("_index.json", ".npy")) for f in files)}
    if name is not None:
        return found.get(name)
    for published in _PUBLISHED:
        if published in found:
            return found[published]
    if len(found) > 1:
        raise DatasetError(f"{folder}: holds embeddings by several models; name one: {', '.join(found)}")
    return next(iter(found.values()), None)


def _name(folder: Path, file: Path) -> str:
    return file.relative_to(folder).with_suffix("").as_posix()


def _array(file: Path, axes: int) -> NDArray[Any]:
    try:
        array: NDArray[Any] = np.load(file, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise DatasetError(f"{file}: no embeddings that can be read ({error})") from error
    if array.ndim != axes or array.dtype.kind not in "fiu":
        raise DatasetError(f"{file}: an array of {array.dtype} and shape {array.shape} holds no embeddings")
    return array


def _index(file: Path, count: int) -> dict[str, int]:
    path = file.with_name(f"{file.stem}_index.json")
    try:
        rows = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: no index that can be read ({error})") from error
    if not isinstance(rows, dict) or not all(type(row) is int and 0 <= row < count for row in rows.values()):
        raise DatasetError(f"{path}: must be one JSON object, {{sentence: number of one of {count} rows}}")
    return rows


def _inside(slices: NDArray[Any], rows: int) -> bool:
    first, last = slices[:, 0], slices[:, 1]
    return bool(((first >= 0) & (first < last) & (last <= rows)).all())
