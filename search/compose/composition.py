"""Composition: the motion of a time line, and what each part of it was made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_count, checked_number, shown, whole_number
from encoders.errors import ArgumentError, QueryError
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.store.stored_library import StoredLibrary
from search.compose.assembling import assembled
from search.compose.candidates import Candidate, candidates
from search.compose.choosing import SPREAD, USED, Joins, refined
from search.compose.stitched import StitchedScores
from search.compose.timeline import MAX_TRANSITION, TRANSITION, Interval, Pin, Timeline
from search.query.encoding import encode_queries

#: Windows near to a sentence around which cuts are made, and how many of the cuts are candidates.
_WINDOWS, _CANDIDATES = 24, 8


@dataclass(frozen=True)
class Chosen:
    """What shows an interval: a cut of a clip; with the TMR-score, 0 to 1, of what became of it in the motion."""

    interval: Interval
    candidate: Candidate
    tmr_score: float


@dataclass(frozen=True)
class Composition:
    """A motion made for a time line.

    Attributes
    ----------
    timeline : Timeline
    motion : Motion
    chosen : tuple of Chosen
        One for each interval, in their order.
    joins : tuple of float
        Seconds at which one piece goes over into the next.
    offered : tuple of tuples of Candidate
        What could show each interval, the best alone first.
    """

    timeline: Timeline
    motion: Motion
    chosen: tuple[Chosen, ...]
    joins: tuple[float, ...]
    offered: tuple[tuple[Candidate, ...], ...]


def compose(
    timeline: Timeline,
    library: StoredLibrary,
    *,
    samples: int = 1,
    seed: int = 0,
    after: Motion | None = None,
    transition: float = TRANSITION,
    allowed: NDArray[np.int64] | None = None,
) -> list[Composition]:
    """Motions for a time line out of the clips of a library, the best first.

    Parameters
    ----------
    samples : int
        How many different ones.
    seed : int
        Chooses the samples after the first.
    after : Motion, optional
        What comes before the time line; the result begins with it.
    transition : float
        Seconds in which one piece goes over into the next.
    allowed : sorted int64 array, optional
        Ids of the clips to choose from; all if not given.

    Raises
    ------
    ArgumentError
        If a value is of a wrong type or out of range.
    QueryError
        If the library holds nothing for a sentence.
    """
    samples, transition = _checked(timeline, samples, seed, transition)
    intervals = timeline.intervals
    queries = encode_queries(library.bundle, [interval.text for interval in intervals])
    offered = [
        candidates(library, interval, query, _WINDOWS, _CANDIDATES, allowed)
        for interval, query in zip(intervals, queries, strict=True)
    ]
    for interval, options in zip(intervals, offered, strict=True):
        if not options:
            raise QueryError(f"{interval}: there is no clip that could show it")
    chosen_from = [
        options if interval.pin is None else [_pinned(library, interval, interval.pin, query)]
        for interval, options, query in zip(intervals, offered, queries, strict=True)
    ]
    joins = Joins.of(timeline, chosen_from, after)
    stitched = StitchedScores(timeline, chosen_from, queries, library.bundle, transition)
    rng, used, found = np.random.default_rng(seed), set[tuple[object, ...]](), []
    for number in range(samples):
        costs = [_costs(options, used, rng if number else None) for options in chosen_from]
        first = joins.best([np.array([one.score for one in o]) - c for o, c in zip(chosen_from, costs, strict=True)])
        choice = refined(first, costs, joins, stitched)
        picked = [options[i] for options, i in zip(chosen_from, choice, strict=True)]
        used |= {_key(candidate) for candidate in picked}
        found.append(_composition(timeline, picked, offered, library.bundle, after, transition))
    return found


def _checked(timeline: Timeline, samples: int, seed: int, transition: float) -> tuple[int, float]:
    if not isinstance(timeline, Timeline):
        raise ArgumentError(f"timeline={shown(timeline)} must be a Timeline; make one with Timeline.of")
    seconds = checked_number("transition", transition)
    if not 0 < seconds <= MAX_TRANSITION or whole_number(seed) is None or seed < 0:
        raise ArgumentError(
            f"transition={shown(transition)} must be 0 to {MAX_TRANSITION:g} seconds, and seed={shown(seed)} 0 or more"
        )
    return checked_count(samples, "samples"), seconds


def _pinned(library: StoredLibrary, interval: Interval, pin: Pin, query: NDArray[np.float32]) -> Candidate:
    """The cut of the clip that an interval is pinned to which lies nearest."""
    its = candidates(library, interval, query, _WINDOWS, 2 * _WINDOWS, np.array([pin.clip_id]))
    if not its:
        raise QueryError(f"{interval}: the library has no clip #{pin.clip_id}; choose another")
    return min(its, key=lambda one: abs(one.source.start + (one.start + one.end) / 2 - pin.at))


def _costs(
    options: Sequence[Candidate], used: set[tuple[object, ...]], rng: np.random.Generator | None
) -> NDArray[np.float64]:
    costs = np.array([candidate.cost + USED * (_key(candidate) in used) for candidate in options])
    return costs if rng is None else costs - SPREAD * rng.gumbel(size=len(costs))


def _key(candidate: Candidate) -> tuple[object, ...]:
    return candidate.source.root, candidate.source.path, round(candidate.start), round(candidate.end)


def _composition(
    timeline: Timeline,
    picked: Sequence[Candidate],
    offered: Sequence[Sequence[Candidate]],
    encoder: Encoder,
    before: Motion | None,
    transition: float,
) -> Composition:
    """The composition of what was picked, each interval scored as it came out."""
    made = assembled(timeline, picked, before, transition)
    crops = [made.motion.crop(made.start + one.start, made.start + one.end) for one in timeline.intervals]
    texts = encode_queries(encoder, [one.text for one in timeline.intervals], paraphrased=False)
    scores = ((encoder.encode_motions(crops) * texts).sum(axis=1) + 1) / 2
    chosen = [
        Chosen(one, candidate, float(score))
        for one, candidate, score in zip(timeline.intervals, picked, scores, strict=True)
    ]
    return Composition(timeline, made.motion, tuple(chosen), made.joins, tuple(map(tuple, offered)))
