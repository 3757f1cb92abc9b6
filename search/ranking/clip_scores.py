"""Clip scores: that of the whole-clip vector, or of the best window."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from search.spans import MAX_OVERLAP, WINDOW_BONUS, Moment, length_adjusted, temporal_iou, temporal_nms

Vectors = NDArray[np.float32]

#: A window must beat the whole clip by this much to be its score: the best of many windows is high by chance too.
WINDOW_MARGIN = 0.02

#: Clips and windows fetched first where clips are ranked; four times as many whenever the next clip is undecided.
_FIRST_ROWS = 160
_MOST_WINDOWS = 16384
#: Windows fetched for each clip wanted of several sentences; four times as many until they come from enough clips.
_PER_CLIP = 16
#: Windows fetched first where windows are ranked; four times as many whenever they have run out.
_FIRST_WINDOWS = 640
#: Clips ranked first for several sentences; as above.
_FIRST_CLIPS = 20


class WindowGallery(Protocol):
    """The windows of many clips, as `indexer.store.stored_library.StoredLibrary` has them."""

    def __len__(self) -> int:
        """How many clips."""

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """Scores, clip ids, starts and ends, each (Q, k); id -1 where there are fewer."""


class ClipGallery(WindowGallery, Protocol):
    """The whole-clip vectors, too."""

    def nearest_clips(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64]]:
        """Scores and clip ids, each (Q, k); id -1 where there are fewer."""


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
    windows: bool = True,
) -> list[ClipScore]:
    """The first k, at most, of `rank_clips`."""
    return list(islice(rank_clips(library, query, allowed=allowed, windows=windows), k))


def rank_clips(
    library: ClipGallery, query: Vectors, *, allowed: NDArray[np.int64] | None = None, windows: bool = True
) -> Iterator[ClipScore]:
    """The score of every clip for a unit vector (D,), best first, as far as it is consumed.

    A clip comes once its score is above the upper bound of all that has not been fetched (the threshold
    algorithm of Fagin, Lotem and Naor, 2001): the order does not depend on how many are consumed.

    Parameters
    ----------
    allowed : sorted int64 array, optional
        Ids of the clips to choose from; all if not given.
    windows : bool
        Whether a window may score for its clip.
    """
    if len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return
    given: set[int] = set()
    count, margin = _FIRST_ROWS, WINDOW_MARGIN if windows else 0.0
    while True:
        clips, upper_bound = _best_whole_clips(library, query, count, allowed)
        best, upper_bound = dict(clips), upper_bound + margin
        if windows:
            spans, window_bound = _best_windows(library, query, min(count, _MOST_WINDOWS), allowed)
            upper_bound = max(upper_bound, window_bound)
            for span in spans:
                if span.clip_id not in clips or span.score > clips[span.clip_id].score + margin:
                    best[span.clip_id] = span
        sure = [e for e in best.values() if e.score > upper_bound and e.clip_id not in given]
        yield from sorted(sure, key=lambda e: (-e.score, e.clip_id))
        if upper_bound == -np.inf:
            return
        given.update(e.clip_id for e in sure)
        count *= 4


def _best_whole_clips(
    library: ClipGallery, query: Vectors, count: int, allowed: NDArray[np.int64] | None
) -> tuple[dict[int, ClipScore], float]:
    """The clips with the nearest whole-clip vectors, and an upper bound of the scores of all others."""
    scores, ids = (a[0] for a in library.nearest_clips(query[None], count, allowed=allowed))
    named = zip(ids.tolist(), scores.tolist(), strict=True)
    return {i: ClipScore(i, score) for i, score in named if i >= 0}, float(scores[-1])


def _best_windows(
    library: ClipGallery, query: Vectors, count: int, allowed: NDArray[np.int64] | None
) -> tuple[list[ClipScore], float]:
    """The best window of each clip among the nearest ones, and an upper bound of the scores of other windows.

    Where the most are fetched that ever are, the others do not count.
    """
    scores, ids, starts, ends = (a[0] for a in library.nearest_windows(query[None], count, allowed=allowed))
    _, first = np.unique(ids, return_index=True)
    best = [ClipScore(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i])) for i in np.sort(first)]
    return [e for e in best if e.clip_id >= 0], float(scores[-1]) if count < _MOST_WINDOWS else -np.inf


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
        if real.sum() < count or count >= _MOST_WINDOWS:
            return
        count *= 4


def _without_overlap(
    scores: Vectors, ids: NDArray[np.int64], starts: Vectors, ends: Vectors, given: list[ClipScore]
) -> Iterator[ClipScore]:
    """The windows that overlap none of those given and no better one, best first."""
    # One time line for all clips, far enough apart that spans of different clips never overlap.
    length = float(max([ends.max(initial=0.0), *(e.end or 0.0 for e in given)])) + 1.0
    shifts = ids.astype(np.float64) * length
    begin, end = starts + shifts, ends + shifts
    free = np.ones(len(ids), bool)
    for e in given:
        shift = e.clip_id * length
        free &= temporal_iou(begin, end, (e.start or 0.0) + shift, (e.end or 0.0) + shift) <= MAX_OVERLAP
    left = np.flatnonzero(free)
    value = length_adjusted(scores[left], (ends - starts)[left], WINDOW_BONUS)
    for i in map(left.__getitem__, temporal_nms(begin[left], end[left], value)):
        yield ClipScore(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i]))


def _windows_of(library: ClipGallery, query: Vectors, k: int, allowed: NDArray[np.int64] | None) -> list[ClipScore]:
    """The best window of each of at least k clips, fewer only where there are no more."""
    count = _PER_CLIP * k
    while True:
        best, upper_bound = _best_windows(library, query, count, allowed)
        if len(best) >= k or upper_bound == -np.inf:
            return best
        count *= 4
