"""The same movement at the same time: what tells one performance from others that mean the same.

Vectors say that two clips mean the same; many clips of an archive do. So the clips nearest in meaning are compared once
more, moment by moment, and those that move alike all the way through come first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import interpolate
from encoders.motion import Motion
from encoders.protocol import Encoder

#: Clips nearest in meaning that are looked at closely, and the longest that are, in seconds.
LOOKED_AT, LONGEST = 60, 60.0

_MOMENTS = 32
_LENGTHS_ALIKE = 1.3  # durations that differ by more cannot be one movement at one pace
_UNLIKE = 1.5  # mean squared difference, in variances, of clips that share nothing in time; unrelated ones have 2
_WEIGHT = 0.2


def likeness(bundle: Encoder, motion: Motion, others: Sequence[Motion]) -> NDArray[np.float64]:
    """What likeness in time adds to the cosine of each other motion (N,): 0 to 0.3.

    Both motions are seen at 32 moments spread evenly; features are weighed by their spread over all motions at hand.
    """
    tracks = np.stack([_track(bundle.features(m)) for m in (motion, *others)])
    spread = np.maximum(tracks.std(axis=(0, 1)), 0.02)
    apart = np.mean(((tracks[1:] - tracks[0]) / spread) ** 2, axis=(1, 2))
    ratio = np.array([max(m.duration, motion.duration) / min(m.duration, motion.duration) for m in others])
    return np.where(ratio <= _LENGTHS_ALIKE, _WEIGHT * np.clip(_UNLIKE - apart, 0, None), 0.0)


def _track(features: NDArray[np.float32]) -> NDArray[np.float64]:
    """Features (T, F) at evenly spread moments (32, F)."""
    return interpolate(features.astype(np.float64), np.linspace(0, len(features) - 1, _MOMENTS))
