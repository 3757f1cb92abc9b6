"""Moments of one motion: each grows around a peak of similarity over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from search.moments.boundaries import grow, local_maxima
from search.moments.queried_motion import QueriedMotion
from search.spans import MAX_SHARED, MOMENT_BONUS, Moment, length_adjusted, shared_part, temporal_iou, temporal_nms


def rank_moments(motion: QueriedMotion) -> Iterator[Moment]:
    """The moments of a motion, best first, none of which contains another.

    Every peak of similarity over time begins one, with boundaries where it rises and falls. They are ranked by the
    height of their peak and a bonus for length.
    """
    peaks = local_maxima(_worst(motion))
    first, end, ranked = _grown(motion, peaks)
    starts, ends = first / motion.fps, end / motion.fps
    for i in temporal_nms(starts, ends, ranked, overlap=shared_part, most=MAX_SHARED):
        yield _moment(motion, int(peaks[i]), int(first[i]), int(end[i]))


def best_moment(motion: QueriedMotion) -> Moment:
    """The first of `rank_moments`. Peaks that even the longest moment would not lift above it are left out."""
    similarity = _worst(motion)
    peaks = local_maxima(similarity)
    heights = similarity[peaks]
    _, _, least = _grown(motion, peaks[[heights.argmax()]])
    longest = np.array([len(similarity) / motion.fps])
    peaks = peaks[length_adjusted(heights, longest, MOMENT_BONUS) >= least - 1e-6]
    first, end, ranked = _grown(motion, peaks)
    best = int(ranked.argmax())
    return _moment(motion, int(peaks[best]), int(first[best]), int(end[best]))


def moments_at(motion: QueriedMotion, places: Sequence[Moment]) -> list[Moment]:
    """The moments of `rank_moments` that overlap places most, in the order of the places, each once."""
    found = list(rank_moments(motion))
    starts, ends = [m.start for m in found], [m.end for m in found]
    nearest = (int(temporal_iou(starts, ends, place.start, place.end).argmax()) for place in places)
    return [found[i] for i in dict.fromkeys(nearest)]


def _worst(motion: QueriedMotion) -> NDArray[np.float32]:
    """Similarity over time (T',) to the query that fits worst."""
    worst: NDArray[np.float32] = motion.similarity.min(axis=0)
    return worst


def _grown(
    motion: QueriedMotion, peaks: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """The moments around peaks (P,) as first and end frames, and what they are ranked by."""
    similarity = _worst(motion)
    first, end = grow(similarity, motion.background_level, motion.fps, peaks)
    return first, end, length_adjusted(similarity[peaks], (end - first) / motion.fps, MOMENT_BONUS)


def _moment(motion: QueriedMotion, peak: int, first: int, end: int) -> Moment:
    similarity, end_time = _worst(motion), min(end / motion.fps, motion.source.duration)
    return Moment(first / motion.fps, end_time, float(similarity[first:end].mean()), float(similarity[peak]))
