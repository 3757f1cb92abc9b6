"""A gallery of motions with the vectors that a library would hold, scored as search scores its clips."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import encode_grids
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.vectors.blocks import IndexRows
from search.ranking.clip_scores import clip_scores

Vectors = NDArray[np.float32]


class Gallery:
    """Motions with their vectors as a whole, and of all their windows; a motion's number is its place."""

    def __init__(self, encoder: Encoder, motions: Sequence[Motion]) -> None:
        self._encoder = encoder
        features = [encoder.features(motion) for motion in motions]
        spans = np.array([(0.0, motion.duration) for motion in motions], np.float32).reshape(-1, 2)
        self.whole: Vectors = encoder.encode_features(features)
        self._clips = IndexRows(np.arange(len(motions)), spans, self.whole.astype(np.float16))
        parts = [IndexRows.none(encoder.latent_size)]
        for number, (rows, motion) in enumerate(zip(features, motions, strict=True)):
            for windows in encode_grids(encoder, [rows], [motion.duration])[0]:
                ends = np.stack([windows.starts, windows.ends], axis=1)
                parts.append(IndexRows(np.full(len(ends), number, np.int64), ends, windows.vectors))
        self._windows = IndexRows.join(parts)

    def scores(self, queries: Vectors) -> NDArray[np.float64]:
        """The clip scores (Q, N) of the motions for unit query vectors (Q, D)."""
        return clip_scores(queries, self._clips, self._windows)
