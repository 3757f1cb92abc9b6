"""Candidates: spans of real clips that could show a sentence for the seconds that a time line asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice
from math import ceil

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.batched_encoder import BatchedEncoder
from encoders.geometry import interpolate
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from indexer.store.stored_library import StoredLibrary
from search.compose.rotations import Rotated
from search.compose.timeline import Interval
from search.ranking.window_ranking import rank_windows
from search.source import MotionSource
from search.spans import Moment

Span = tuple[float, float]

#: How much faster or slower than it was performed a span may be shown.
FASTEST, SLOWEST = 1.25, 0.8
#: Shortest cut in seconds, and so the shortest clip, that is compared with a sentence.
_SHORTEST = 0.5
#: Seconds by which cuts must differ in length to be two.
_SAME = 0.1
#: Seconds of a clip that are read around a cut, to be seen in the transitions.
_AROUND = 2.0
#: Taken off the score for each time that a span is shown again, and for each doubling of its speed.
_REPEAT, _WARP = 0.01, 0.05


@dataclass(frozen=True, eq=False)
class _Cut:
    """A cut, and the clip around it: its motion, and where in the clip's motion that begins, in seconds."""

    source: MotionSource
    start: float
    end: float
    wanted: float
    around: Motion
    begin: float

    @property
    def repeats(self) -> int:
        return max(1, ceil(self.wanted * SLOWEST / (self.end - self.start) - 1e-6))

    @property
    def rate(self) -> float:
        return (self.end - self.start) * self.repeats / self.wanted

    @property
    def cost(self) -> float:
        """What repeating and warping cost in similarity."""
        return float(_REPEAT * (self.repeats - 1) + _WARP * abs(np.log2(self.rate)))

    @property
    def first(self) -> float:
        return (self.start - self.begin) * FPS

    def shown_once(self) -> Motion:
        """The cut at the speed at which it is shown."""
        frames = max(round((self.end - self.start) * FPS / self.rate), 1)
        at = np.clip(self.first + self.rate * np.arange(frames), 0, len(self.around) - 1)
        return Motion(interpolate(self.around.joints, at), FPS)


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
        Cosine similarity to the sentence of the cut, shown as often and as fast.
    cost : float
        What repeating and warping cost in similarity.
    around : Rotated
        The clip around the cut.
    first : float
        Where in it, in frames, the cut begins.
    """

    source: MotionSource
    start: float
    end: float
    repeats: int
    rate: float
    score: float
    cost: float
    around: Rotated = field(repr=False, compare=False)
    first: float = field(repr=False, compare=False)

    @property
    def duration(self) -> float:
        """Seconds of the clip that are shown each time."""
        return self.end - self.start

    def ends(self, reach: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Joints (2, 22, 3) at its first frame and `reach` frames on, and `reach` before its last frame and there."""
        last = min(round(self.first + self.duration * FPS), len(self.around) - 1)
        first = min(round(self.first), last)
        joints = self.around[np.array([first, min(first + reach, last), max(last - reach, first), last])].joints()
        return joints[:2], joints[2:]


def candidates(
    library: StoredLibrary,
    interval: Interval,
    query: NDArray[np.float32],
    windows: int,
    most: int,
    allowed: NDArray[np.int64] | None,
) -> list[Candidate]:
    """At most `most` candidates for an interval, the best first: cuts around the windows nearest to the sentence.

    Parameters
    ----------
    query : array (D,)
        Unit vector of the interval's sentence.
    allowed : sorted int64 array, optional
        Ids of the clips to choose from; all if not given.
    """
    cuts = _cuts_near(library, query, windows, allowed, interval.duration)
    if not cuts:
        return []
    scores = (_encoded(cuts, library.bundle) @ query).tolist()
    best = sorted(range(len(cuts)), key=lambda i: cuts[i].cost - scores[i])[:most]
    return [
        Candidate(cut.source, cut.start, cut.end, cut.repeats, cut.rate, scores[i], cut.cost, around, cut.first)
        for i, around in zip(best, _rotated([cuts[i].around for i in best]), strict=True)
        for cut in [cuts[i]]
    ]


def _encoded(cuts: Sequence[_Cut], encoder: Encoder) -> NDArray[np.float32]:
    """Unit vectors (N, D) of cuts as often and as fast as they are shown."""
    motions = [cut.shown_once() for cut in cuts]
    if isinstance(encoder, BatchedEncoder):
        features = encoder.features_of(motions)
    else:
        features = [encoder.features(motion) for motion in motions]
    # Features do not know of places, so that repeats need not be joined for them.
    tiled = [np.tile(rows, (cut.repeats, 1)) for rows, cut in zip(features, cuts, strict=True)]
    return encoder.encode_features(tiled)


def _cuts_near(
    library: StoredLibrary, query: NDArray[np.float32], windows: int, allowed: NDArray[np.int64] | None, wanted: float
) -> list[_Cut]:
    """Cuts around the windows nearest to a query that can be shown for the seconds wanted."""
    near = list(islice(rank_windows(library, query, allowed=allowed), windows))
    clips = library.clips_by_id({window.clip_id for window in near})
    sources = {id: MotionSource.of_clip(library, clip) for id, clip in clips.items()}
    found = []
    for window in near:
        source = sources[window.clip_id]
        if source.duration < _SHORTEST:
            continue  # a pose is no motion
        spans = _spans(window.moment(source.duration), source.duration, wanted)
        begin = max(min(start for start, _ in spans) - _AROUND, 0.0)
        around = source.read(begin, min(max(end for _, end in spans) + _AROUND, source.duration)).resample(FPS)
        found += [_Cut(source, start, end, wanted, around, begin) for start, end in spans]
    return found


def _rotated(motions: Sequence[Motion]) -> list[Rotated]:
    """Motions as rotations, all at once: for short ones what it takes hardly depends on their length."""
    ends = np.cumsum([len(motion) for motion in motions])
    whole = Rotated.of(Motion(np.concatenate([motion.joints for motion in motions]), FPS))
    return [whole[end - len(motion) : end] for motion, end in zip(motions, ends.tolist(), strict=True)]


def _spans(window: Moment, duration: float, wanted: float) -> list[Span]:
    """Cuts around a window of a clip that can be shown for the seconds wanted: the window, and one of that length."""
    middle = (window.start + window.end) / 2
    tight = _within(middle, max(min(window.end - window.start, FASTEST * wanted), _SHORTEST), duration)
    whole = _within(middle, wanted, duration)
    return [tight] if abs((whole[1] - whole[0]) - (tight[1] - tight[0])) < _SAME else [tight, whole]


def _within(middle: float, length: float, duration: float) -> Span:
    """A span of a length about a middle, moved into the clip."""
    length = min(length, duration)
    start = min(max(middle - length / 2, 0.0), duration - length)
    return start, start + length
