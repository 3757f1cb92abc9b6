"""What speaks for each clip: its whole-clip vector or its best window."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from indexer.store.stored_library import StoredLibrary
from search.moments.localisation import LARGEST_OVERLAP, fitness
from search.spans import best_first, iou

Vectors = NDArray[np.float32]

#: A window must beat the whole clip by this much to speak for it: the best of many windows is high by chance too.
WINDOW_MARGIN = 0.02

#: Clips and windows fetched first where clips are wanted; four times as many whenever they leave the next one open.
_FIRST_ROWS = 160
_MOST_WINDOWS = 16384
#: Windows fetched for each clip asked for where several sentences are, four times as many until they name enough.
_PER_CLIP = 16
#: Windows fetched first where spans are wanted; four times as many whenever they have run out.
_FIRST_WINDOWS = 640
#: Clips named first where all that answer several sentences are wanted; as above.
_FIRST_CLIPS = 20


class WindowGallery(Protocol):
    """The windows of many clips, as `indexer.store.stored_library.Library` has them."""

    def __len__(self) -> int:
        """How many clips."""

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """Scores, clip ids, starts and ends, each (Q, k); id -1 where there are fewer."""


@dataclass(frozen=True)
class ClipScore:
    """The best score of a clip and the span it comes from, in seconds; no span for the whole clip."""

    clip_id: int
    score: float
    start: float | None = None
    end: float | None = None


def best_clips(
    library: StoredLibrary,
    query: Vectors,
    k: int,
    *,
    allowed: NDArray[np.int64] | None = None,
    windows: bool = True,
) -> list[ClipScore]:
    """The first k, at most, of `clips_in_order`."""
    return list(islice(clips_in_order(library, query, allowed=allowed, windows=windows), k))


def clips_in_order(
    library: StoredLibrary, query: Vectors, *, allowed: NDArray[np.int64] | None = None, windows: bool = True
) -> Iterator[ClipScore]:
    """The best evidence of every clip for a unit vector (D,), best first, as long as one asks.

    A clip is given once nothing that has not been fetched could come before it or say more for it (the threshold
    algorithm of Fagin, Lotem and Naor, 2001): the order does not depend on how many are asked for.

    Parameters
    ----------
    allowed : sorted int64 array, optional
        The clips to choose from.
    windows : bool
        Whether windows speak for their clips, too.
    """
    if len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return
    given: set[int] = set()
    count, margin = _FIRST_ROWS, WINDOW_MARGIN if windows else 0.0
    while True:
        wholes, unseen = _wholes(library, query, count, allowed)
        best, unseen = dict(wholes), unseen + margin
        if windows:
            spans, unseen_window = _best_windows(library, query, min(count, _MOST_WINDOWS), allowed)
            unseen = max(unseen, unseen_window)
            for span in spans:
                if span.clip_id not in wholes or span.score > wholes[span.clip_id].score + margin:
                    best[span.clip_id] = span
        sure = [e for e in best.values() if e.score > unseen and e.clip_id not in given]
        yield from sorted(sure, key=lambda e: (-e.score, e.clip_id))
        if unseen == -np.inf:
            return
        given.update(e.clip_id for e in sure)
        count *= 4


def _wholes(
    library: StoredLibrary, query: Vectors, count: int, allowed: NDArray[np.int64] | None
) -> tuple[dict[int, ClipScore], float]:
    """The clips nearest as wholes, and what no other one scores more than."""
    scores, ids = (a[0] for a in library.nearest_clips(query[None], count, allowed=allowed))
    named = zip(ids.tolist(), scores.tolist(), strict=True)
    return {i: ClipScore(i, score) for i, score in named if i >= 0}, float(scores[-1])


def _best_windows(
    library: StoredLibrary, query: Vectors, count: int, allowed: NDArray[np.int64] | None
) -> tuple[list[ClipScore], float]:
    """The best window of each clip among the nearest ones, and what no other window scores more than.

    Where as many are fetched as ever are, the others have no say.
    """
    scores, ids, starts, ends = (a[0] for a in library.nearest_windows(query[None], count, allowed=allowed))
    _, first = np.unique(ids, return_index=True)
    best = [ClipScore(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i])) for i in np.sort(first)]
    return [e for e in best if e.clip_id >= 0], float(scores[-1]) if count < _MOST_WINDOWS else -np.inf


def likeliest(
    library: StoredLibrary, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
) -> list[int]:
    """The k clips most likely to hold an answer to all queries (Q, D): by the sum of their best windows."""
    if k < 1 or len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return []
    best = [{e.clip_id: e.score for e in _windows_of(library, query, k, allowed)} for query in queries]
    floors = [min(scores.values(), default=-1.0) for scores in best]
    totals = {
        clip: sum(scores.get(clip, floor) for scores, floor in zip(best, floors, strict=True))
        for clip in set().union(*best)
    }
    return sorted(totals, key=lambda clip: -totals[clip])[:k]


def likeliest_in_order(
    library: StoredLibrary, queries: Vectors, *, allowed: NDArray[np.int64] | None = None
) -> Iterator[int]:
    """The clips of `likeliest`, as many as are asked for, in an order that does not depend on how many."""
    given: set[int] = set()
    count = _FIRST_CLIPS
    while True:
        named = [clip for clip in likeliest(library, queries, count, allowed=allowed) if clip not in given]
        yield from named
        given.update(named)
        if len(given) < count:
            return
        count *= 4


def spans_in_order(
    gallery: WindowGallery, query: Vectors, *, allowed: NDArray[np.int64] | None = None
) -> Iterator[ClipScore]:
    """The best windows of all clips for a unit vector (D,) of which no two overlap, best first, as long as one asks.

    The best of few fetched windows come first, then what more fetched ones add: the order does not depend on how many
    are asked for.
    """
    if len(gallery) == 0 or (allowed is not None and len(allowed) == 0):
        return
    given: list[ClipScore] = []
    count = _FIRST_WINDOWS
    while True:
        scores, ids, starts, ends = (a[0] for a in gallery.nearest_windows(query[None], count, allowed=allowed))
        real = ids >= 0
        for evidence in _apart(scores[real], ids[real], starts[real], ends[real], given):
            given.append(evidence)
            yield evidence
        if real.sum() < count or count >= _MOST_WINDOWS:
            return
        count *= 4


def best_spans(
    gallery: WindowGallery, query: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
) -> list[ClipScore]:
    """The first k, at most, of `spans_in_order`."""
    return list(islice(spans_in_order(gallery, query, allowed=allowed), k))


def _apart(
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
        free &= iou(begin, end, (e.start or 0.0) + shift, (e.end or 0.0) + shift) <= LARGEST_OVERLAP
    left = np.flatnonzero(free)
    value = fitness(scores[left], (ends - starts)[left])
    for i in map(left.__getitem__, best_first(begin[left], end[left], value, overlap=LARGEST_OVERLAP)):
        yield ClipScore(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i]))


def _windows_of(library: StoredLibrary, query: Vectors, k: int, allowed: NDArray[np.int64] | None) -> list[ClipScore]:
    """The best window of each of at least k clips, fewer only where there are no more."""
    count = _PER_CLIP * k
    while True:
        best, unseen = _best_windows(library, query, count, allowed)
        if len(best) >= k or unseen == -np.inf:
            return best
        count *= 4
