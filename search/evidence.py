"""What speaks for each clip: its whole-clip vector or its best window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from indexer.library import Library
from search.moments import OVERLAP, fitness
from search.spans import suppress

Vectors = NDArray[np.float32]

#: A window must beat the whole clip by this much to speak for it: the best of many windows is high by chance too.
WINDOW_MARGIN = 0.02

#: Windows fetched for each clip asked for, doubled until they name enough clips.
_PER_CLIP = 16
_MOST_WINDOWS = 16384


class WindowGallery(Protocol):
    """The windows of many clips, as `indexer.library.Library` has them."""

    def __len__(self) -> int:
        """How many clips."""

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """Scores, clip ids, starts and ends, each (Q, k); id -1 where there are fewer."""


@dataclass(frozen=True)
class Evidence:
    """The best score of a clip and the span it comes from, in seconds; no span for the whole clip."""

    clip_id: int
    score: float
    start: float | None = None
    end: float | None = None


def best_evidence(
    library: Library,
    query: Vectors,
    k: int,
    *,
    allowed: NDArray[np.int64] | None = None,
    whole: bool = True,
    windows: bool = True,
) -> list[Evidence]:
    """The k clips with the best evidence for a unit vector (D,), best first.

    Parameters
    ----------
    allowed : sorted int64 array, optional
        The clips to choose from.
    whole, windows : bool
        Which vectors to look at.
    """
    if k < 1 or len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return []
    best: dict[int, Evidence] = {}
    if whole:
        scores, ids = library.nearest_clips(query[None], k, allowed=allowed)
        best = {int(i): Evidence(int(i), float(s)) for i, s in zip(ids[0], scores[0], strict=True) if i >= 0}
    if windows:
        margin = WINDOW_MARGIN if whole else 0.0
        for evidence in _best_windows(library, query, k, allowed):
            if evidence.clip_id not in best or evidence.score > best[evidence.clip_id].score + margin:
                best[evidence.clip_id] = evidence
    return sorted(best.values(), key=lambda e: -e.score)[:k]


def likeliest(library: Library, queries: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None) -> list[int]:
    """The k clips most likely to hold an answer to all queries (Q, D): by the sum of their best windows."""
    if k < 1 or len(library) == 0 or (allowed is not None and len(allowed) == 0):
        return []
    best = [{e.clip_id: e.score for e in _best_windows(library, query, k, allowed)} for query in queries]
    floors = [min(scores.values(), default=-1.0) for scores in best]
    totals = {
        clip: sum(scores.get(clip, floor) for scores, floor in zip(best, floors, strict=True))
        for clip in set().union(*best)
    }
    return sorted(totals, key=lambda clip: -totals[clip])[:k]


def best_spans(
    gallery: WindowGallery, query: Vectors, k: int, *, allowed: NDArray[np.int64] | None = None
) -> list[Evidence]:
    """The k best windows of all clips for a unit vector (D,) of which no two overlap, best first."""
    if k < 1 or len(gallery) == 0 or (allowed is not None and len(allowed) == 0):
        return []
    count = _PER_CLIP * k
    while True:
        scores, ids, starts, ends = (a[0] for a in gallery.nearest_windows(query[None], count, allowed=allowed))
        real = ids >= 0
        value = fitness(scores[real], ends[real] - starts[real])
        # One time line for all clips, far enough apart that spans of different clips never overlap.
        shift = np.unique(ids[real], return_inverse=True)[1] * (float(ends[real].max(initial=0.0)) + 1.0)
        kept = suppress(starts[real] + shift, ends[real] + shift, value, k, overlap=OVERLAP)
        if len(kept) >= k or real.sum() < count or count >= _MOST_WINDOWS:
            break
        count *= 4
    return [Evidence(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i])) for i in kept]


def _best_windows(library: Library, query: Vectors, k: int, allowed: NDArray[np.int64] | None) -> list[Evidence]:
    """The best window of each of at least k clips, fewer only where there are no more."""
    count = _PER_CLIP * k
    while True:
        scores, ids, starts, ends = (a[0] for a in library.nearest_windows(query[None], count, allowed=allowed))
        real = ids >= 0
        clips, first = np.unique(ids[real], return_index=True)
        if len(clips) >= k or real.sum() < count or count >= _MOST_WINDOWS:
            break
        count *= 4
    return [Evidence(int(ids[i]), float(scores[i]), float(starts[i]), float(ends[i])) for i in np.sort(first)]
