"""What TMR's recipe trains on: clips with captions, features of the captions' tokens, and statistics of the clips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]


@dataclass(frozen=True)
class CaptionedClips:
    """N motions, each with one caption or several; each caption is about a clip of its motion.

    Attributes
    ----------
    captions : sequence of N sequences of str
    clip : callable
        (number of a motion, number of one of its captions) -> features (T, F).
    """

    captions: Sequence[Sequence[str]]
    clip: Callable[[int, int], Array]

    def __len__(self) -> int:
        return len(self.captions)


@dataclass(frozen=True)
class TextFeatures:
    """What frozen language models make of captions.

    Attributes
    ----------
    language_model, sentence_model : str
        Their names.
    width : int
        Numbers a token.
    tokens : callable
        Sentences -> features (L, width) of the tokens of each.
    sentences : callable
        Sentences -> unit vectors (N, E), whose similarity tells false negatives.
    """

    language_model: str
    width: int
    tokens: Callable[[Sequence[str]], Sequence[NDArray[np.floating]]]
    sentence_model: str
    sentences: Callable[[Sequence[str]], Array]


def statistics(clips: CaptionedClips) -> tuple[Array, Array]:
    """Mean and standard deviation (F,) of the frames of the first clip of every motion, as TMR's code takes them.

    The deviation is the unbiased one; 1 for a feature that never changes.
    """
    if not len(clips):
        raise ValueError("no clips, no statistics")
    # Sums of squares about a frame that occurs stay precise.
    first = clips.clip(0, 0)[0].astype(np.float64)
    count, total, squares = 0, np.zeros_like(first), np.zeros_like(first)
    for index in range(len(clips)):
        rows = clips.clip(index, 0) - first
        count, total, squares = count + len(rows), total + rows.sum(0), squares + np.square(rows).sum(0)
    mean = total / count
    std = np.sqrt(np.maximum(squares - count * mean**2, 0) / max(count - 1, 1))
    return (first + mean).astype(np.float32), np.where(std > 1e-8, std, 1).astype(np.float32)
