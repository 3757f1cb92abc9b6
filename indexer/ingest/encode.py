"""Motions become vectors: one a clip and one a window, from features computed once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.bundle.windows import encode_grids
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.store.clip_vectors import ClipVectors


def encode(bundle: Encoder, motions: Sequence[Motion]) -> list[ClipVectors]:
    """The vectors of motions and of their windows; all of them go through the model together, sorted by length."""
    features = [bundle.features(motion) for motion in motions]
    vectors = bundle.encode_features(features).astype(np.float16)
    windows = encode_grids(bundle, features, [motion.duration for motion in motions])
    return [ClipVectors(*both) for both in zip(vectors, windows, strict=True)]
