"""Training pairs: motion features and the sentences that are true of them, packed flat for quick batches."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import MotionSeekError

_LEFT, _RIGHT = re.compile(r"\bleft"), re.compile(r"\bright")

#: Key in a file -> attribute of a `PairStore`.
_STORED = {name: name for name in ("texts", "vocabulary", "captions", "facts", "meanings")} | {
    "swapped": "hard_negatives"
}


@dataclass(frozen=True)
class Pair:
    """One motion with its sentences.

    Attributes
    ----------
    features : float array (T, F)
    captions : sentences that are true of the motion
    meanings : for each caption the facts it states, or None (real clips whose captions cannot be parsed)
    facts : everything true of the motion (synthetic clips), or what its captions state (real clips), or None
    hard_negatives : for each caption a similar one that is false (order, side, direction or count changed), or empty;
        nothing at all where no caption has one
    """

    features: NDArray[np.floating]
    captions: tuple[str, ...]
    meanings: tuple[frozenset[str], ...] | None = None
    facts: frozenset[str] | None = None
    hard_negatives: tuple[str, ...] = ()


class PairStore:
    """Many pairs in flat arrays.

    Attributes
    ----------
    features : float16 (sum of T, F); offsets : int64 (N + 1)
    texts : distinct sentences; captions, hard_negatives : for each pair indices into `texts`, -1 for none
    vocabulary : distinct facts; facts : for each pair indices into it, or None
    meanings : for each pair, for each caption, indices into `vocabulary`
    """

    def __init__(self, pairs: Iterable[Pair]) -> None:
        blocks: list[NDArray[np.float16]] = []
        self.texts: list[str] = []
        self.vocabulary: list[str] = []
        self.captions: list[list[int]] = []
        self.hard_negatives: list[list[int]] = []
        self.facts: list[list[int] | None] = []
        self.meanings: list[list[list[int]] | None] = []
        text_index: dict[str, int] = {}
        fact_index: dict[str, int] = {}
        lengths = [0]
        for pair in pairs:
            blocks.append(np.asarray(pair.features, dtype=np.float16))
            lengths.append(len(pair.features))
            self.captions.append([_intern(text, text_index, self.texts) for text in pair.captions])
            negatives = pair.hard_negatives or ("",) * len(pair.captions)
            self.hard_negatives.append([_intern(text, text_index, self.texts) if text else -1 for text in negatives])
            self.facts.append(
                None if pair.facts is None else [_intern(f, fact_index, self.vocabulary) for f in sorted(pair.facts)]
            )
            self.meanings.append(
                None
                if pair.meanings is None
                else [[_intern(f, fact_index, self.vocabulary) for f in sorted(m)] for m in pair.meanings]
            )
        self.features = np.concatenate(blocks) if blocks else np.zeros((0, 0), np.float16)
        self.offsets = np.cumsum(lengths)

    def __len__(self) -> int:
        return len(self.captions)

    def motion(self, index: int) -> NDArray[np.float16]:
        """Features (T, F) of one pair."""
        return self.features[self.offsets[index] : self.offsets[index + 1]]

    @property
    def lengths(self) -> NDArray[np.int64]:
        """Frames of each pair (N,)."""
        return np.diff(self.offsets)

    def save(self, path: Path) -> None:
        """Write beside `path` and rename, so that a stopped run leaves no half a store."""
        words = json.dumps({name: getattr(self, attribute) for name, attribute in _STORED.items()})
        partial = path.with_suffix(".partial.npz")
        np.savez(
            partial, features=self.features, offsets=self.offsets, words=np.frombuffer(words.encode(), dtype=np.uint8)
        )
        os.replace(partial, path)

    @classmethod
    def load(cls, path: Path) -> PairStore:
        """Inverse of `save`.

        Raises
        ------
        MotionSeekError
            If an older version wrote it, in which hard negatives belonged to a pair and not to a caption.
        """
        store = cls(())
        with np.load(path, allow_pickle=False) as arrays:
            store.features, store.offsets = arrays["features"], arrays["offsets"]
            words = json.loads(arrays["words"].tobytes())
        for name, attribute in _STORED.items():
            setattr(store, attribute, words[name])
        store.hard_negatives = [s or [-1] * len(c) for s, c in zip(store.hard_negatives, store.captions, strict=True)]
        if any(len(s) != len(c) for s, c in zip(store.hard_negatives, store.captions, strict=True)):
            raise MotionSeekError(f"{path}: written by an older motionseek; delete it, and it is synthesised again")
        return store

    @classmethod
    def joined(cls, stores: Sequence[PairStore]) -> PairStore:
        """All pairs of several stores as one."""
        return cls(pair for store in stores for pair in store.pairs())

    def pairs(self) -> Iterable[Pair]:
        """Unpack again."""
        for i in range(len(self)):
            facts, meanings = self.facts[i], self.meanings[i]
            yield Pair(
                self.motion(i),
                tuple(self.texts[t] for t in self.captions[i]),
                None if meanings is None else tuple(frozenset(self.vocabulary[f] for f in m) for m in meanings),
                None if facts is None else frozenset(self.vocabulary[f] for f in facts),
                _false(self.texts, self.hard_negatives[i]),
            )


def sides_conflict(texts: Sequence[str]) -> NDArray[np.bool_]:
    """Pairs of sentences (B, B), one saying only left, the other only right: similar but false for each other."""
    left = np.array([bool(_LEFT.search(t)) for t in texts])
    right = np.array([bool(_RIGHT.search(t)) for t in texts])
    only_left, only_right = left & ~right, right & ~left
    conflict = only_left[:, None] & only_right[None, :]
    return conflict | conflict.T


def _false(texts: Sequence[str], negatives: Sequence[int]) -> tuple[str, ...]:
    """The sentences of a row of `hard_negatives`; none at all where all are missing."""
    return tuple(texts[t] if t >= 0 else "" for t in negatives) if any(t >= 0 for t in negatives) else ()


def _intern(item: str, index: dict[str, int], items: list[str]) -> int:
    if item not in index:
        index[item] = len(items)
        items.append(item)
    return index[item]
