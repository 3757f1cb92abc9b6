"""Candidates: spans of real clips that could show a sentence for the seconds that a time line asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from math import ceil

import numpy as np
from numpy.typing import NDArray

from indexer.store.stored_library import StoredLibrary
from search.compose.timeline import Interval
from search.ranking.clip_scores import rank_windows
from search.source import MotionSource
from search.spans import Moment

#: How much faster or slower than it was performed a span may be shown.
FASTEST, SLOWEST = 1.25, 0.8
#: Shortest cut in seconds that is compared with a sentence.
_SHORTEST = 0.5
#: Seconds by which cuts must differ in length to be two.
_SAME = 0.1
#: Taken off the score for each time that a span is shown again, and for each doubling of its speed.
_REPEAT, _WARP = 0.03, 0.05


@dataclass(frozen=True)
class Candidate:
    """A cut of a clip that shows a sentence.

    Attributes
    ----------
    source : MotionSource
    start, end : float
        Seconds from where the clip's motion begins.
    repeats : int
        How often it is shown, one after the other.
    rate : float
        Seconds of the clip in a second of the time line.
    score : float
        Cosine similarity of the cut to the sentence.
    fit : float
        The score, less what repeating and warping cost.
    """

    source: MotionSource
    start: float
    end: float
    repeats: int
    rate: float
    score: float
    fit: float

    @property
    def duration(self) -> float:
        """Seconds of the clip that are shown each time."""
        return self.end - self.start


def candidates(
    library: StoredLibrary, interval: Interval, query: NDArray[np.float32], most: int, allowed: NDArray[np.int64] | None
) -> list[Candidate]:
    """At most `most` candidates for an interval, the best fitting first.

    They are cut around the windows nearest to the sentence, and each is encoded as it would be shown.

    Parameters
    ----------
    query : array (D,)
        Unit vector of the interval's sentence.
    allowed : sorted int64 array, optional
        Ids of the clips to choose from; all if not given.
    """
    windows = list(islice(rank_windows(library, query, allowed=allowed), most))
    clips = library.clips_by_id({window.clip_id for window in windows})
    sources = {id: MotionSource.of_clip(library, clip) for id, clip in clips.items()}
    cuts = [
        (source, *cut)
        for window in windows
        for source in [sources[window.clip_id]]
        for cut in _cuts(window.moment(source.duration), source.duration, interval.duration)
    ]
    if not cuts:
        return []
    vectors = library.bundle.encode_motions([source.read(start, end) for source, start, end in cuts])
    found = [
        _candidate(source, start, end, interval.duration, float(score))
        for (source, start, end), score in zip(cuts, vectors @ query, strict=True)
    ]
    return sorted(found, key=lambda candidate: -candidate.fit)[:most]


def _candidate(source: MotionSource, start: float, end: float, wanted: float, score: float) -> Candidate:
    repeats = max(1, ceil(wanted * SLOWEST / (end - start) - 1e-6))
    rate = (end - start) * repeats / wanted
    fit = score - _REPEAT * (repeats - 1) - _WARP * abs(np.log2(rate))
    return Candidate(source, start, end, repeats, rate, score, float(fit))


def _cuts(window: Moment, duration: float, wanted: float) -> Sequence[tuple[float, float]]:
    """Cuts around a window of a clip that can be shown for the seconds wanted: the window, and one of that length."""
    middle = (window.start + window.end) / 2
    tight = _within(middle, max(min(window.end - window.start, FASTEST * wanted), _SHORTEST), duration)
    whole = _within(middle, wanted, duration)
    return [tight] if abs((whole[1] - whole[0]) - (tight[1] - tight[0])) < _SAME else [tight, whole]


def _within(middle: float, length: float, duration: float) -> tuple[float, float]:
    """A span of a length about a middle, moved into the clip."""
    length = min(length, duration)
    start = min(max(middle - length / 2, 0.0), duration - length)
    return start, start + length


def ends(candidate: Candidate, fps: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The joints (3, 22, 3) at a candidate's first frames and at its last."""
    reach = 3 / fps
    first = candidate.source.read(candidate.start, min(candidate.start + reach, candidate.end)).joints
    last = candidate.source.read(max(candidate.end - reach, candidate.start), candidate.end).joints
    pick = np.array([0, -1])
    return first[pick].astype(np.float64), last[pick].astype(np.float64)
