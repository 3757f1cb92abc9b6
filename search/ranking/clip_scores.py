"""Clip scores: how well clips as a whole, and their best windows of every length, match a query."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import LENGTHS
from indexer.vectors.blocks import IndexRows
from search.ranking.galleries import MOST_WINDOWS, ClipGallery, Vectors
from search.spans import Moment

#: How much of a clip's score is that of the clip as a whole; the rest is the mean of its best windows of each length.
WHOLE_SHARE = 0.5

#: Clips and windows fetched first where clips are ranked; four times as many whenever the next clip is undecided. And
#: candidates that are scored at once.
_FIRST_CLIPS_RANKED, _FIRST_WINDOWS_RANKED, _SCORED_AT_ONCE = 1280, 2048, 16
#: Where no more clips than these are allowed all are scored: to find their near windows costs more.
_FEW_ALLOWED = 256
#: What a score may be above its upper bound, both being rounded: clips that score the same come by their ids.
_ROUNDING = 1e-6
#: What is left of the length of a window that ends with its clip, at least.
_NEARLY = 0.9


@dataclass(frozen=True)
class ClipScore:
    """The best score of a clip and the span it comes from, in seconds; no span for the whole clip."""

    clip_id: int
    score: float
    start: float | None = None
    end: float | None = None

    def moment(self, duration: float) -> Moment:
        """The span, of a clip of `duration` seconds."""
        if self.start is None or self.end is None:
            return Moment(0.0, duration, self.score)
        return Moment(self.start, self.end, self.score)


def best_clips(
    library: ClipGallery,
    query: Vectors,
    k: int,
    *,
    allowed: NDArray[np.int64] | None = None,
    whole_share: float = WHOLE_SHARE,
) -> list[ClipScore]:
    """The first k, at most, of `rank_clips`."""
    return list(islice(rank_clips(library, query, allowed=allowed, whole_share=whole_share), k))


def rank_clips(
    library: ClipGallery,
    query: Vectors,
    *,
    allowed: NDArray[np.int64] | None = None,
    whole_share: float = WHOLE_SHARE,
) -> Iterator[ClipScore]:
    """The `clip_scores` of all clips for a unit vector (D,), best first, as far as it is consumed.

    What is near as a whole or has a near window is a candidate. Candidates are scored in the order of what they score
    at most, and a clip comes once no other can score higher (the threshold algorithm of Fagin, Lotem and Naor, 2001):
    the order does not depend on how many are consumed.

    Parameters
    ----------
    allowed : sorted int64 array, optional
        Ids of the clips to choose from; all if not given.
    whole_share : float
        How much of a score is that of the clip as a whole, 0 to 1.
    """
    if len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return
    if allowed is not None and len(allowed) <= _FEW_ALLOWED:
        yield from _all_ranked(library, query, allowed, whole_share)
        return
    scored: set[int] = set()
    at_once = getattr(library, "scored_at_once", _SCORED_AT_ONCE)
    waiting: list[tuple[float, int]] = []  # a heap of scores, negated, and clips
    factor = 1
    while True:
        near = _best_rows(library.nearest_clips(query[None], factor * _FIRST_CLIPS_RANKED, allowed=allowed))
        count = min(factor * _FIRST_WINDOWS_RANKED, MOST_WINDOWS)
        windows = _best_rows(library.nearest_windows(query[None], count, allowed=allowed))
        ids, most, most_of_others = _upper_bounds(near, windows, whole_share)
        new = ~np.isin(ids, list(scored))
        ids, most = ids[new], np.append(most[new], most_of_others)
        for first in range(0, len(ids) + 1, at_once):
            some = np.sort(ids[first : first + at_once])
            scored.update(some.tolist())
            clips, of_clips = library.vectors_of(some)
            scores = clip_scores(query[None], clips, of_clips, whole_share)[0]
            for score, clip in zip(scores.tolist(), np.sort(clips.owners).tolist(), strict=True):
                heappush(waiting, (-score, clip))
            bound = max(float(most[first + at_once :].max(initial=-np.inf)), most_of_others)
            while waiting and -waiting[0][0] > bound + _ROUNDING:
                score, clip = heappop(waiting)
                yield ClipScore(clip, -score)
        if most_of_others == -np.inf:
            return
        factor *= 4


def _all_ranked(
    library: ClipGallery, query: Vectors, ids: NDArray[np.int64], whole_share: float
) -> Iterator[ClipScore]:
    """Those of some clips that are there, all of them scored, best first."""
    clips, windows = library.vectors_of(ids)
    scores, there = clip_scores(query[None], clips, windows, whole_share)[0], np.sort(clips.owners)
    for i in np.lexsort((there, -scores)):
        yield ClipScore(int(there[i]), float(scores[i]))


def _best_rows(found: tuple[NDArray[Any], ...]) -> tuple[NDArray[Any], ...]:
    """What is found for one query, without the places that are empty, and the score of the last place."""
    scores, ids, *spans = (values[0] for values in found)
    real = ids >= 0
    return scores[real], ids[real], *(values[real] for values in spans), scores[-1]


def _upper_bounds(
    near: tuple[NDArray[Any], ...], windows: tuple[NDArray[Any], ...], whole_share: float
) -> tuple[NDArray[np.int64], NDArray[np.float64], float]:
    """What clips of the nearest rows score at most, the highest first: their ids and bounds; and all other clips."""
    whole, clips, last_whole = near
    heights, owners, starts, ends, last_window = windows
    ids = np.union1d(clips, owners).astype(np.int64)
    of_whole = np.full(len(ids), last_whole, np.float64)
    of_whole[np.searchsorted(ids, clips)] = whole
    of_windows = np.full((len(ids), len(LENGTHS)), -np.inf)
    np.maximum.at(of_windows, (np.searchsorted(ids, owners), _length(starts, ends)), heights)
    # Of a length that is not found a clip has a lower window, or none, and then the whole counts.
    of_windows = np.where(np.isfinite(of_windows), of_windows, np.maximum(of_whole, last_window)[:, None])
    most = whole_share * of_whole + (1 - whole_share) * of_windows.mean(axis=1) if whole_share < 1 else of_whole
    order = np.argsort(-most, kind="stable")
    others = float(last_whole)
    if whole_share < 1 and others > -np.inf:
        others = whole_share * others + (1 - whole_share) * max(others, float(last_window))
    return ids[order], most[order], others


def _length(starts: NDArray[np.float32], ends: NDArray[np.float32]) -> NDArray[np.int64]:
    """Which of the lengths windows have; the last ones may end a little before, with their clip."""
    return np.minimum(np.searchsorted(LENGTHS, (ends - starts) * _NEARLY), len(LENGTHS) - 1).astype(np.int64)


def clip_scores(
    queries: Vectors, clips: IndexRows, windows: IndexRows, whole_share: float = WHOLE_SHARE
) -> NDArray[np.float64]:
    """The scores (Q, n) of n clips for unit vectors (Q, D), in order of the clips' numbers.

    A clip that is wholly about a query comes before one that is partly about it, and a short action in it counts, too:
    the score is that of the whole, and the mean of those of its best windows of each length. Lengths of which a clip
    has no window count as the whole.

    Parameters
    ----------
    clips : IndexRows
        The clips as a whole.
    windows : IndexRows
        All windows of these clips.
    """
    order = np.argsort(clips.owners)
    whole = (clips.vectors.astype(np.float32, copy=False) @ queries.T)[order]
    best = np.full((len(clips), len(LENGTHS), len(queries)), -np.inf, np.float32)
    place = np.searchsorted(clips.owners[order], windows.owners)
    np.maximum.at(best, (place, _length(*windows.spans.T)), windows.vectors.astype(np.float32, copy=False) @ queries.T)
    best = np.where(np.isfinite(best), best, whole[:, None])
    return np.asarray((whole_share * whole + (1 - whole_share) * best.mean(axis=1)).T, np.float64)


def highest_scores(queries: Vectors, clips: IndexRows, windows: IndexRows) -> NDArray[np.float64]:
    """The highest of the `clip_scores` of some clips for each query (Q,), -inf for none, in bounded memory."""
    best = np.full(len(queries), -np.inf)
    for first in range(0, len(clips), _SCORED_AT_ONCE):
        some = np.isin(np.arange(len(clips)), np.arange(first, first + _SCORED_AT_ONCE))
        scores = clip_scores(queries, clips[some], windows[np.isin(windows.owners, clips.owners[some])])
        np.maximum(best, scores.max(axis=1), out=best)
    return best
