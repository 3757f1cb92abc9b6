"""Where in a take it happens: coarse windows propose places, similarity around them says from when to when."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from encoders.bundle import windows
from encoders.protocol import Encoder
from search.moments.boundaries import STRIDE, frame_curve, grow
from search.moments.window_scores import Scored, Vectors, join, score_windows
from search.ranking.paging import rounds
from search.spans import best_first, iou

#: Answers overlap by at most this intersection over union.
LARGEST_OVERLAP = 0.3
#: Places looked at closely in a round.
_ROUND = 30
#: What doubling a window's length is worth in cosine, when places are proposed and when answers are ranked: a window
#: inside a long action scores like the whole of it.
_PLACE_BONUS, _ANSWER_BONUS = 0.03, 0.02
#: How far around a proposed place is looked at first, and how long a stretch at most, in seconds.
REACH, _LONGEST = 4.0, 600.0

#: (start, end) in seconds -> features of a part of the take that holds that span, and the second the part begins at.
Region = Callable[[float, float], tuple[Vectors, float]]


@dataclass(frozen=True)
class Moment:
    """A span of a take, in seconds, and its similarity to the query: the mean over its instants, and the highest."""

    start: float
    end: float
    score: float
    peak: float | None = field(default=None, compare=False)

    @property
    def height(self) -> float:
        """What its strength is judged by: as a clip's is, by the window that fits best."""
        return self.score if self.peak is None else self.peak


def score_take(encoder: Encoder, features: Vectors, fps: float, queries: Vectors) -> list[Scored]:
    """The coarse windows of a take that no library holds, compared with queries (Q, D)."""
    coarse = windows.grid(len(features), fps).values()
    return [score_windows(encoder, features, fps, starts, size, queries) for starts, size in coarse]


def score_stored(stored: Sequence[windows.Windows], queries: Vectors) -> list[Scored]:
    """The stored windows of a clip compared with queries (Q, D)."""
    return [
        Scored(w.starts.astype(np.float64), w.ends.astype(np.float64), queries @ w.vectors.astype(np.float32).T)
        for w in stored
    ]


def fitness(scores: NDArray[np.floating], seconds: NDArray[np.floating]) -> NDArray[np.float64]:
    """How well windows answer: their similarity, and a little for their length."""
    return np.asarray(scores + _PLACE_BONUS * np.log2(np.maximum(seconds, 0.1)), np.float64)


def propose(coarse: Scored) -> Iterator[Moment]:
    """Places worth a close look: the windows that overlap no better one, best first."""
    scores = coarse.scores.min(axis=0)
    for i in best_first(coarse.starts, coarse.ends, fitness(scores, coarse.lengths), overlap=LARGEST_OVERLAP):
        yield Moment(float(coarse.starts[i]), float(coarse.ends[i]), float(scores[i]))


def background_level(encoder: Encoder, coarse: Sequence[Scored], queries: Vectors) -> float:
    """What motion that does not fit scores: the median of the take or that of unrelated motion, whichever is lower.

    The take's own would mislead where one action fills it.
    """
    level = float(np.median(coarse[0].scores.min(axis=0)))
    if encoder.calibration is None:
        return level
    unrelated = encoder.calibration["motions"].astype(np.float32) @ queries.T
    return min(level, float(np.median(unrelated.min(axis=1))))


def refine(
    encoder: Encoder, region: Region, fps: float, queries: Vectors, places: Sequence[Moment], level: float
) -> list[Moment]:
    """The moments near proposed places, best first.

    Parameters
    ----------
    region : callable
        See `Region`.
    fps : float
        Feature frames a second.
    queries : float32 array (Q, D)
        Unit vectors.
    level : float
        See `background_level`.
    """
    found: list[Moment] = []
    for start, end, inside in _stretches(places, REACH):
        found += _grown(encoder, region, fps, queries, level, start, end, inside)
    starts, ends, scores = (np.array([getattr(m, name) for m in found]) for name in ("start", "end", "score"))
    value = scores + _ANSWER_BONUS * np.log2(np.maximum(ends - starts, 0.1))
    return [found[i] for i in best_first(starts, ends, value, overlap=LARGEST_OVERLAP)]


def rank(
    encoder: Encoder, region: Region, fps: float, queries: Vectors, coarse: Scored, level: float
) -> Iterator[Moment]:
    """The moments of a take, best first within each round of places; see `refine`.

    Parameters
    ----------
    coarse : Scored
        The windows that propose places, compared with the queries.
    """
    known: list[Moment] = []
    for places in rounds(propose(coarse), _ROUND):
        found = unknown(refine(encoder, region, fps, queries, places, level), known)
        known += found
        yield from found


def unknown(found: Sequence[Moment], known: Sequence[Moment]) -> list[Moment]:
    """The moments that overlap none of those known."""
    starts, ends = [m.start for m in known], [m.end for m in known]
    return [m for m in found if iou(starts, ends, m.start, m.end).max(initial=0.0) <= LARGEST_OVERLAP]


def localise(
    encoder: Encoder,
    features: Vectors,
    fps: float,
    queries: Vectors,
    k: int,
    *,
    coarse: Sequence[Scored] = (),
) -> list[Moment]:
    """The best moments of a take, best first.

    Parameters
    ----------
    features : float32 array (T', F)
        Of the whole take.
    fps : float
        Feature frames a second.
    queries : float32 array (Q, D)
        Unit vectors; where there are several, a span must fit them all and counts as much as its worst.
    k : int
        At most so many.
    coarse : sequence of Scored
        The take's coarse windows compared with the queries, where a library has them.
    """
    coarse = coarse or score_take(encoder, features, fps, queries)
    level = background_level(encoder, coarse, queries)
    ranked = rank(encoder, lambda start, end: (features, 0.0), fps, queries, join(coarse), level)
    return list(islice(ranked, k))


def stretch(region: Region, fps: float, start: float, end: float) -> tuple[Vectors, float]:
    """The features of a take from `start` to `end`, in seconds, as far as it goes, and the second they begin at.

    They begin at a multiple of `STRIDE` frames of the take, so that a curve is the same wherever a stretch is cut.
    """
    features, offset = region(start, end)
    first = min(max(round((start - offset) * fps), 0), len(features) - 1)
    first -= min((round(offset * fps) + first) % STRIDE, first)
    last = min(max(round((end - offset) * fps), first + 1), len(features))
    return features[first:last], offset + first / fps


def frames_in(place: Moment, offset: float, fps: float, frames: int) -> tuple[int, int]:
    """A span as a range of frames, at least one, of a stretch of so many that begins at second `offset`."""
    first = min(max(round((place.start - offset) * fps), 0), frames - 1)
    return first, min(max(round((place.end - offset) * fps), first + 1), frames)


def _grown(
    encoder: Encoder,
    region: Region,
    fps: float,
    queries: Vectors,
    level: float,
    start: float,
    end: float,
    places: Sequence[Moment],
) -> list[Moment]:
    """The moments at places in one stretch of time; the stretch is widened while one of them goes on beyond it."""
    part, offset = stretch(region, fps, start, end)
    similarity = frame_curve(encoder, part, fps, queries).min(axis=0)
    spans = [grow(similarity, level, fps, *frames_in(place, offset, fps, len(part))) for place in places]
    goes_on_before = start > 0 and min(a for a, _ in spans) == 0
    goes_on_after = offset + len(part) / fps >= end - 1 / fps and max(b for _, b in spans) == len(part)
    if (goes_on_before or goes_on_after) and end - start < _LONGEST:
        wider = (
            (max(start - (end - start), 0.0) if goes_on_before else start),
            (end + (end - start) if goes_on_after else end),
        )
        return _grown(encoder, region, fps, queries, level, *wider, places)
    return [
        Moment(offset + a / fps, offset + b / fps, float(similarity[a:b].mean()), float(similarity[a:b].max()))
        for a, b in spans
    ]


def _stretches(places: Sequence[Moment], reach: float) -> list[tuple[float, float, list[Moment]]]:
    """Stretches of time that hold the places and `reach` on either side, those that overlap made one."""
    joined: list[tuple[float, float, list[Moment]]] = []
    for place in sorted(places, key=lambda p: p.start):
        start, end = max(place.start - reach, 0.0), place.end + reach
        if joined and start <= joined[-1][1]:
            before, until, inside = joined.pop()
            start, end, inside = before, max(until, end), [*inside, place]
        else:
            inside = [place]
        joined.append((start, end, inside))
    return joined
