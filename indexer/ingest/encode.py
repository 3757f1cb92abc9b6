"""Motions become vectors: one a clip and one a window, from features computed once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows, encode_grids
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
    vectors = bundle.encode_features(features).astype(np.float16)
    windows = encode_grids(bundle, features, [motion.duration for motion in motions])
    return [Encoded(*both) for both in zip(vectors, windows, strict=True)]
