"""Moments of one motion: windows are candidates, similarity around them decides from when to when."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from search.moments.boundaries import grow
from search.moments.queried_motion import QueriedMotion
from search.moments.window_scores import WindowScores, join
from search.ranking.batched import batched
from search.spans import MAX_OVERLAP, MOMENT_BONUS, WINDOW_BONUS, Moment, length_adjusted, temporal_iou, temporal_nms

#: Candidates refined in one batch.
_BATCH = 30
#: How far around a candidate similarity is taken at first, and the longest stretch, in seconds.
REACH, _LONGEST = 4.0, 600.0


def rank_moments(motion: QueriedMotion, windows: WindowScores | None = None) -> Iterator[Moment]:
    """The moments of a motion, best first within each batch of candidates; see `refine`.

    Parameters
    ----------
    windows : WindowScores, optional
        The windows that are candidates; those of the library's grid if not given.
    """
    known: list[Moment] = []
    for batch in batched(candidates(join(motion.windows) if windows is None else windows), _BATCH):
        found = without_overlap(refine(motion, batch), known)
        known += found
        yield from found


def candidates(windows: WindowScores) -> Iterator[Moment]:
    """The windows that remain after non-maximum suppression, best first."""
    scores = windows.scores.min(axis=0)
    for i in temporal_nms(windows.starts, windows.ends, length_adjusted(scores, windows.lengths, WINDOW_BONUS)):
        yield Moment(float(windows.starts[i]), float(windows.ends[i]), float(scores[i]))


def refine(motion: QueriedMotion, places: Sequence[Moment]) -> list[Moment]:
    """The moments around candidates, with boundaries where similarity over time rises and falls, best first."""
    found: list[Moment] = []
    for start, end, inside in _stretches(places, REACH):
        found += _grown(motion, start, end, inside)
    starts, ends, scores = (np.array([getattr(m, name) for m in found]) for name in ("start", "end", "score"))
    return [found[i] for i in temporal_nms(starts, ends, length_adjusted(scores, ends - starts, MOMENT_BONUS))]


def without_overlap(found: Sequence[Moment], known: Sequence[Moment]) -> list[Moment]:
    """The moments found that overlap none of those known."""
    starts, ends = [m.start for m in known], [m.end for m in known]
    return [m for m in found if temporal_iou(starts, ends, m.start, m.end).max(initial=0.0) <= MAX_OVERLAP]


def frames_in(place: Moment, offset: float, fps: float, frames: int) -> tuple[int, int]:
    """A place as a range of at least one of the frames of a stretch that begins at `offset` seconds."""
    first = min(max(round((place.start - offset) * fps), 0), frames - 1)
    return first, min(max(round((place.end - offset) * fps), first + 1), frames)


def _grown(motion: QueriedMotion, start: float, end: float, places: Sequence[Moment]) -> list[Moment]:
    """The moments at places in one stretch of time; the stretch is widened while one of them goes on beyond it."""
    part, offset = motion.stretch(start, end)
    similarity = motion.frame_curve(part).min(axis=0)
    level, fps = motion.background_level, motion.fps
    spans = [grow(similarity, level, fps, *frames_in(place, offset, fps, len(part))) for place in places]
    goes_on_before = start > 0 and min(a for a, _ in spans) == 0
    goes_on_after = offset + len(part) / fps >= end - 1 / fps and max(b for _, b in spans) == len(part)
    if (goes_on_before or goes_on_after) and end - start < _LONGEST:
        wider = (
            (max(start - (end - start), 0.0) if goes_on_before else start),
            (end + (end - start) if goes_on_after else end),
        )
        return _grown(motion, *wider, places)
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
