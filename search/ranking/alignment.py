"""Alignment in time: clips that move alike moment by moment come before others of the same meaning.

Many clips of an archive mean the same and have near vectors. So the nearest ones are compared once more, frame by
frame, and those that move alike all the way through are ranked first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import interpolate
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.store.stored_library import StoredLibrary
from search.ranking.clip_scores import ClipScore

#: The nearest clips that are reranked, and the longest of them, in seconds.
RERANKED, LONGEST = 60, 60.0

_MOMENTS = 32
_MAX_RATIO = 1.3  # durations that differ by more cannot be one movement at one pace
_UNRELATED = 1.5  # mean squared difference, in variances, of clips that share nothing in time; unrelated ones have 2
_WEIGHT = 0.2


def alignment_bonus(encoder: Encoder, motion: Motion, others: Sequence[Motion]) -> NDArray[np.float64]:
    """What alignment in time adds to the cosine of each other motion (N,): 0 to 0.3.

    Motions are compared at 32 evenly spaced instants; features are weighted by their spread over all given motions.
    """
    tracks = np.stack([_track(encoder.features(m)) for m in (motion, *others)])
    spread = np.maximum(tracks.std(axis=(0, 1)), 0.02)
    apart = np.mean(((tracks[1:] - tracks[0]) / spread) ** 2, axis=(1, 2))
    ratio = np.array([max(m.duration, motion.duration) / min(m.duration, motion.duration) for m in others])
    return np.where(ratio <= _MAX_RATIO, _WEIGHT * np.clip(_UNRELATED - apart, 0, None), 0.0)


def rerank_by_alignment(
    encoder: Encoder, library: StoredLibrary, motion: Motion, found: list[ClipScore]
) -> list[ClipScore]:
    """The clips nearest to a motion, best first, those first that also move alike moment by moment.

    The score of each of the first `RERANKED` rises by its `alignment_bonus`; very long clips stay as they are.
    """
    clips = library.clips_by_id([score.clip_id for score in found])
    near = [score for score in found[:RERANKED] if clips[score.clip_id].duration <= LONGEST]
    if not near or motion.duration > LONGEST:
        return found
    bonuses = alignment_bonus(encoder, motion, [library.motion(score.clip_id) for score in near])
    bonus = {score.clip_id: float(b) for score, b in zip(near, bonuses, strict=True)}
    raised = [replace(s, score=min(1.0, s.score + bonus.get(s.clip_id, 0.0))) for s in found]
    return sorted(raised, key=lambda s: -s.score)


def _track(features: NDArray[np.float32]) -> NDArray[np.float64]:
    """Features (T, F) at evenly spread moments (32, F)."""
    return interpolate(features.astype(np.float64), np.linspace(0, len(features) - 1, _MOMENTS))
