"""Window ranking: windows by how well they match a query, and clips by their best windows alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from search.ranking.clip_scores import ClipScore
from search.ranking.galleries import MOST_WINDOWS, ClipGallery, Vectors, WindowGallery
from search.spans import MAX_OVERLAP, WINDOW_BONUS, length_adjusted, temporal_iou, temporal_nms

#: Windows fetched for each clip wanted of several sentences; four times as many until they come from enough clips.
_PER_CLIP = 16
#: Windows fetched first where windows are ranked; four times as many whenever they have run out.
_FIRST_WINDOWS = 640
#: Clips ranked first for several sentences; as above.
_FIRST_CLIPS = 20


def rank_windows(
    gallery: WindowGallery, query: Vectors, *, allowed: NDArray[np.int64] | None = None
) -> Iterator[ClipScore]:
    """The best windows of all clips for a unit vector (D,) of which no two overlap, best first.

    The best of few fetched windows come first, then what more fetched ones add: the order does not depend on how many
    are consumed.
    """
    if len(gallery) == 0 or (allowed is not None and len(allowed) == 0):
        return
    given: list[ClipScore] = []
    count = _FIRST_WINDOWS
    while True:
        scores, ids, starts, ends = (a[0] for a in gallery.nearest_windows(query[None], count, allowed=allowed))
        real = ids >= 0
        for window in _without_overlap(scores[real], ids[real], starts[real], ends[real], given):
            given.append(window)
            yield window
        if real.sum() < count or count >= MOST_WINDOWS:
            return
        count *= 4


def _without_overlap(
    scores: Vectors, ids: NDArray[np.int64], starts: Vectors, ends: Vectors, given: list[ClipScore]
) -> Iterator[ClipScore]:
    """The windows that overlap none of those given and no better one, best first."""
    # One time line for all clips, far enough apart that spans of different clips never overlap.
    length = float(max([ends.max(initial=0.0), *(e.end or 0.0 for e in given)])) + 1.0
    clips = np.unique([*ids.tolist(), *(e.clip_id for e in given)])  # numbers may be too large to multiply
    shifts = np.searchsorted(clips, ids) * length
    begin, end = starts + shifts, ends + shifts
    free = np.ones(len(ids), bool)
    for e in given:
        shift = float(np.searchsorted(clips, e.clip_id)) * length
        free &= temporal_iou(begin, end, (e.start or 0.0) + shift, (e.end or 0.0) + shift) <= MAX_OVERLAP
    left = np.flatnonzero(free)
    value = length_adjusted(scores[left], (ends - starts)[left], WINDOW_BONUS)
    for i in map(left.__getitem__, temporal_nms(begin[left], end[left], value)):
        yield ClipScore(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i]))


def rank_by_window(
    gallery: WindowGallery, query: Vectors, *, allowed: NDArray[np.int64] | None = None
) -> Iterator[ClipScore]:
    """Every clip once, by its nearest window; best first, in an order that does not depend on how many are consumed."""
    if len(gallery) == 0 or (allowed is not None and len(allowed) == 0):
        return
    given: set[int] = set()
    count = _FIRST_WINDOWS
    while True:
        scores, ids, starts, ends = (a[0] for a in gallery.nearest_windows(query[None], count, allowed=allowed))
        for row in range(int((ids >= 0).sum())):
            if int(ids[row]) not in given:
                given.add(int(ids[row]))
                yield ClipScore(int(ids[row]), float(scores[row]), float(starts[row]), float(ends[row]))
        if ids[-1] < 0 or count >= MOST_WINDOWS:
            return
        count *= 4


def rank_candidate_clips(
    library: ClipGallery, queries: Vectors, *, allowed: NDArray[np.int64] | None = None
) -> Iterator[int]:
    """The clips by how likely they hold an answer to all queries (Q, D), the sum of their best window scores.

    The order does not depend on how many are consumed.
    """
    given: set[int] = set()
    count = _FIRST_CLIPS
    while True:
        named = [clip for clip in _candidate_clips(library, queries, count, allowed=allowed) if clip not in given]
        yield from named
        given.update(named)
        if len(given) < count:
            return
        count *= 4


def _candidate_clips(
    library: ClipGallery, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
) -> list[int]:
    """The k clips most likely to hold an answer to all queries (Q, D), by the sum of their best window scores."""
    if k < 1 or len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return []
    best = [{e.clip_id: e.score for e in _windows_of(library, query, k, allowed)} for query in queries]
    floors = [min(scores.values(), default=-1.0) for scores in best]
    totals = {
        clip: sum(scores.get(clip, floor) for scores, floor in zip(best, floors, strict=True))
        for clip in set().union(*best)
    }
    return sorted(totals, key=lambda clip: -totals[clip])[:k]


def _windows_of(library: ClipGallery, query: Vectors, k: int, allowed: NDArray[np.int64] | None) -> list[ClipScore]:
    """The best window of each of at least k clips, fewer only where there are no more."""
    count = _PER_CLIP * k
    while True:
        best, upper_bound = _best_windows(library, query, count, allowed)
        if len(best) >= k or upper_bound == -np.inf:
            return best
        count *= 4


def _best_windows(
    library: ClipGallery, query: Vectors, count: int, allowed: NDArray[np.int64] | None
) -> tuple[list[ClipScore], float]:
    """The best window of each clip among the nearest ones, and an upper bound of the scores of other windows.

    Where the most are fetched that ever are, the others do not count.
    """
    scores, ids, starts, ends = (a[0] for a in library.nearest_windows(query[None], count, allowed=allowed))
    _, first = np.unique(ids, return_index=True)
    best = [ClipScore(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i])) for i in np.sort(first)]
    return [e for e in best if e.clip_id >= 0], float(scores[-1]) if count < MOST_WINDOWS else -np.inf
