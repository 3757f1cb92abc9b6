"""What the generator learns from: motions, the vectors of their captions, and their labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.facts import HYPERNYMS
from encoders.protocol import Encoder
from encoders.tmr.training.pairs import PairStore

#: Captions of a clip that are used, and the fewest frames of a clip.
_CAPTIONS, _SHORTEST = 3, 8


@dataclass(frozen=True)
class CaptionedMotions:
    """Motions with captions.

    Attributes
    ----------
    motions : N float arrays (T, F)
    captions : N arrays of rows of `vectors`, one of each caption
    vectors : float16 array (sentences, D)
        Unit vectors.
    labels : N strings
        The one action that a motion shows; "" where it shows several or nobody knows.
    """

    motions: Sequence[NDArray[np.floating]]
    captions: Sequence[NDArray[np.int64]]
    vectors: NDArray[np.float16]
    labels: Sequence[str]


def captioned_motions(stores: Sequence[PairStore], encoder: Encoder, max_frames: int) -> CaptionedMotions:
    """The motions of stores that last long enough, cut to `max_frames`; their captions encoded by the encoder."""
    motions, captions, labels = [], [], []
    texts: dict[str, int] = {}
    for store in stores:
        for i, given in enumerate(store.captions):
            if len(store.motion(i)) < _SHORTEST or not given:
                continue
            rows = [texts.setdefault(store.texts[text], len(texts)) for text in given[:_CAPTIONS]]
            motions.append(store.motion(i)[:max_frames])
            captions.append(np.array(rows, np.int64))
            labels.append(_label([store.vocabulary[fact] for fact in store.facts[i] or ()]))
    return CaptionedMotions(motions, captions, encoder.encode_texts(list(texts)).astype(np.float16), labels)


def _label(facts: Sequence[str]) -> str:
    """The action of a clip that shows one alone: the most special name it has."""
    if any(mark in fact for fact in facts for mark in "<+"):
        return ""
    actions = [fact for fact in facts if "." not in fact]
    special = [action for action in actions if action not in {HYPERNYMS.get(other) for other in actions}]
    return special[0] if len(special) == 1 else ""


def batches_of(lengths: Sequence[int], size: int, rng: np.random.Generator) -> list[NDArray[np.int64]]:
    """Every motion once, in batches of motions of like length, in random order."""
    order = np.argsort(np.asarray(lengths) + rng.uniform(0, 8, len(lengths)))
    cuts = list(accumulate([size] * ((len(order) - 1) // size)))
    parts = np.split(order, cuts)
    return [parts[i] for i in rng.permutation(len(parts))]
