"""Motions become vectors: one a clip and one a window, from features computed once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows, ends_of, grid
from encoders.motion import Motion
from encoders.protocol import Encoder


@dataclass(frozen=True)
class Encoded:
    """A clip's unit vector (D,) and its windows."""

    vector: NDArray[np.float16]
    windows: list[Windows]


def encode(bundle: Encoder, motions: Sequence[Motion]) -> list[Encoded]:
    """The vectors of motions and of their windows; all of them go through the model together, sorted by length."""
    features = [bundle.features(motion) for motion in motions]
    grids = [grid(len(rows), bundle.fps) for rows in features]
    pieces = [
        rows[first : first + size]
        for rows, lengths in zip(features, grids, strict=True)
        for firsts, size in lengths.values()
        for first in firsts
    ]
    whole = bundle.encode_motions(list(motions)).astype(np.float16)
    parts = bundle.encode_features(pieces).astype(np.float16)
    encoded, at = [], 0
    for vector, motion, lengths in zip(whole, motions, grids, strict=True):
        windows = []
        for length, (firsts, _) in lengths.items():
            starts = (firsts / bundle.fps).astype(np.float32)
            ends = ends_of(starts, length, motion.duration)
            windows.append(Windows(length, starts, ends, parts[at : at + len(firsts)]))
            at += len(firsts)
        encoded.append(Encoded(vector, windows))
    return encoded
