"""Moments of one motion: each grows around a peak of similarity over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from search.moments.boundaries import grow, local_maxima
from search.moments.queried_motion import QueriedMotion
from search.spans import MAX_SHARED, MOMENT_BONUS, Moment, length_adjusted, shared_part, temporal_iou, temporal_nms


def rank_moments(motion: QueriedMotion) -> Iterator[Moment]:
    """The moments of a motion, best first, none of which contains another.

    Every peak of similarity over time begins one, with boundaries where it rises and falls. They are ranked by the
    height of their peak and a bonus for length.
    """
    similarity, fps = motion.similarity.min(axis=0), motion.fps
    peaks = local_maxima(similarity)
    first, end = grow(similarity, motion.background_level, fps, peaks)
    starts, ends, heights = first / fps, np.minimum(end / fps, motion.source.duration), similarity[peaks]
    total = np.concatenate([[0.0], np.cumsum(similarity, dtype=np.float64)])
    means = (total[end] - total[first]) / (end - first)
    ranked = length_adjusted(heights, ends - starts, MOMENT_BONUS)
    for i in temporal_nms(starts, ends, ranked, overlap=shared_part, most=MAX_SHARED):
        yield Moment(float(starts[i]), float(ends[i]), float(means[i]), float(heights[i]))


def best_moment(motion: QueriedMotion) -> Moment:
    """The first of `rank_moments`."""
    return next(rank_moments(motion))


def moments_at(motion: QueriedMotion, places: Sequence[Moment]) -> list[Moment]:
    """The moments of `rank_moments` that overlap places most, in the order of the places, each once."""
    found = list(rank_moments(motion))
    starts, ends = [m.start for m in found], [m.end for m in found]
    nearest = (int(temporal_iou(starts, ends, place.start, place.end).argmax()) for place in places)
    return [found[i] for i in dict.fromkeys(nearest)]
