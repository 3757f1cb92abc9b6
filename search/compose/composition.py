"""Composition: the motion of a time line, and what each part of it was made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from encoders.errors import QueryError
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from indexer.store.stored_library import StoredLibrary
from search.compose.assembling import assembled
from search.compose.candidates import Candidate, candidates, ends
from search.compose.choosing import SPREAD, USED, Edge, best_path, join_costs
from search.compose.timeline import TRANSITION, Interval, Timeline
from search.query.encoding import encode_queries

#: Candidates of a sentence.
_CANDIDATES = 24


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
    """

    timeline: Timeline
    motion: Motion
    chosen: tuple[Chosen, ...]
    joins: tuple[float, ...]


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
    QueryError
        If the library holds nothing for a sentence.
    """
    texts = [interval.text for interval in timeline.intervals]
    queries = encode_queries(library.bundle, texts)
    offered = [
        candidates(library, interval, query, _CANDIDATES, allowed)
        for interval, query in zip(timeline.intervals, queries, strict=True)
    ]
    for interval, options in zip(timeline.intervals, offered, strict=True):
        if not options:
            raise QueryError(f"{interval}: there is no clip that could show it")
    order = list(dict.fromkeys(cut.base for cut in timeline.cuts()))
    edges = {i: [_edges(candidate) for candidate in offered[i]] for i in order}
    begin = None if after is None else _last_edge(after)
    rng, used, found = np.random.default_rng(seed), set[tuple[object, ...]](), []
    for number in range(samples):
        fits = [_fits(options, used, rng if number else None) for options in offered]
        choice = _choose(order, fits, edges, begin)
        picked = [options[choice[i]] for i, options in enumerate(offered)]
        used |= {_key(candidate) for candidate in picked}
        found.append(_composition(timeline, picked, library.bundle, after, transition))
    return found


def _fits(
    options: Sequence[Candidate], used: set[tuple[object, ...]], rng: np.random.Generator | None
) -> NDArray[np.float64]:
    fits = np.array([candidate.fit - USED * (_key(candidate) in used) for candidate in options])
    return fits if rng is None else fits + SPREAD * rng.gumbel(size=len(fits))


def _key(candidate: Candidate) -> tuple[object, ...]:
    return candidate.source.root, candidate.source.path, round(candidate.start), round(candidate.end)


def _edges(candidate: Candidate) -> tuple[Edge, Edge]:
    first, last = ends(candidate, FPS)
    return Edge.of(first, 0, 3 / FPS), Edge.of(last, 1, 3 / FPS)


def _last_edge(after: Motion) -> Edge:
    joints = after.resample(FPS).joints[-4:].astype(np.float64)
    return Edge.of(joints[[0, -1]], 1, max(len(joints) - 1, 1) / FPS)


def _choose(
    order: Sequence[int],
    fits: Sequence[NDArray[np.float64]],
    edges: Mapping[int, Sequence[tuple[Edge, Edge]]],
    begin: Edge | None,
) -> list[int]:
    """The candidate of each interval: those that lead chosen together, the others for themselves."""
    steps = [fits[i].copy() for i in order]
    if begin is not None:
        steps[0] -= join_costs([begin], [edge for edge, _ in edges[order[0]]])[0]
    joins = [join_costs([end for _, end in edges[a]], [edge for edge, _ in edges[b]]) for a, b in pairwise(order)]
    leading = dict(zip(order, best_path(steps, joins), strict=True))
    return [leading.get(i, int(fit.argmax())) for i, fit in enumerate(fits)]


def _composition(
    timeline: Timeline, picked: Sequence[Candidate], encoder: Encoder, before: Motion | None, transition: float
) -> Composition:
    """The composition of what was picked, each interval scored as it came out."""
    made = assembled(timeline, picked, before, transition)
    crops = [made.motion.crop(made.start + one.start, made.start + one.end) for one in timeline.intervals]
    texts = encoder.encode_texts([one.text for one in timeline.intervals])
    scores = ((encoder.encode_motions(crops) * texts).sum(axis=1) + 1) / 2
    chosen = [
        Chosen(one, candidate, float(score))
        for one, candidate, score in zip(timeline.intervals, picked, scores, strict=True)
    ]
    return Composition(timeline, made.motion, tuple(chosen), made.joins)
