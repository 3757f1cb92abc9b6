"""Composition: the motion of a time line, and what each part of it was made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from encoders.errors import QueryError
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from indexer.store.stored_library import StoredLibrary
from search.compose.candidates import Candidate, candidates, ends
from search.compose.choosing import SPREAD, USED, Edge, best_path, join_costs
from search.compose.feet import planted, standing
from search.compose.joining import Piece, joined
from search.compose.rotations import Rotated
from search.compose.stitching import overlaid
from search.compose.timeline import Cut, Interval, Timeline
from search.query.encoding import encode_queries
from search.source import MotionSource

#: Seconds in which one piece goes over into the next, and a body part into another: STMC's overlap.
TRANSITION = 0.5
#: Candidates of a sentence.
_CANDIDATES = 24


@dataclass(frozen=True)
class Chosen:
    """What shows an interval: a cut of a clip, with the TMR-score of what became of it in the motion."""

    interval: Interval
    candidate: Candidate
    score: float


@dataclass(frozen=True)
class Composition:
    """A motion made for a time line.

    Attributes
    ----------
    motion : Motion
    chosen : tuple of Chosen
        One for each interval, in their order.
    joins : tuple of float
        Seconds at which one piece goes over into the next.
    """

    motion: Motion
    chosen: tuple[Chosen, ...]
    joins: tuple[float, ...] = field(default=())


def compose(
    timeline: Timeline,
    library: StoredLibrary,
    *,
    samples: int = 1,
    seed: int = 0,
    after: MotionSource | None = None,
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
    after : MotionSource, optional
        A motion that comes before the time line; the result begins with it.
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
    cuts = timeline.cuts()
    order = list(dict.fromkeys(cut.base for cut in cuts))
    edges = {i: [_edges(candidate) for candidate in offered[i]] for i in order}
    begin = None if after is None else _last_edge(after)
    rng, used, found = np.random.default_rng(seed), set[tuple[object, ...]](), []
    for number in range(samples):
        fits = [_fits(options, used, rng if number else None) for options in offered]
        choice = _choose(order, fits, edges, begin)
        picked = [options[choice[i]] for i, options in enumerate(offered)]
        used |= {_key(candidate) for candidate in picked}
        found.append(_made(timeline, cuts, picked, library.bundle, after, transition))
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


def _last_edge(after: MotionSource) -> Edge:
    joints = after.read(max(after.duration - 4 / FPS, 0.0), None).joints.astype(np.float64)
    return Edge.of(joints[[0, -1]], 1, 3 / FPS)


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


def _made(
    timeline: Timeline,
    cuts: Sequence[Cut],
    picked: Sequence[Candidate],
    encoder: Encoder,
    after: MotionSource | None,
    transition: float,
) -> Composition:
    """Join and stitch what was picked."""
    overlap = round(transition * FPS)
    rotated = {id(c.source): Rotated.of(c.source.motion.resample(FPS)) for c in picked}
    frame = [round(FPS * one.start) for one in timeline.intervals]
    pieces: list[Piece] = []
    if after is not None:
        before = Rotated.of(after.motion.resample(FPS))
        pieces.append(Piece(before, 0.0, 1.0, len(before)))
    for cut, last in _stretches(cuts):
        i, start, end = cut.base, round(FPS * cut.start), round(FPS * last)
        pieces += _pieces(picked[i], rotated[id(picked[i].source)], start - frame[i], end - frame[i])
    body = joined(pieces, overlap)
    rests = _rests(pieces)
    offset = 0 if after is None else pieces[0].frames
    for i, one in sorted(enumerate(timeline.intervals), key=lambda numbered: -len(numbered[1].parts)):
        parts = {part for cut in cuts for part, owner in cut.owners.items() if owner == i and cut.base != i}
        if parts:
            count = round(FPS * one.end) - frame[i]
            layer = joined(
                _pieces(picked[i], rotated[id(picked[i].source)], -overlap // 2, count + overlap // 2), overlap
            )
            body = overlaid(body, layer, parts, offset + frame[i] - overlap // 2, overlap)
    joints = planted(body.joints(), rests, FPS)
    motion = Motion(joints.astype(np.float32), FPS)
    crops = [
        motion.crop((offset + f) / FPS, (offset / FPS) + one.end)
        for f, one in zip(frame, timeline.intervals, strict=True)
    ]
    vectors = encoder.encode_motions(crops)
    texts = encoder.encode_texts([one.text for one in timeline.intervals])
    scores = ((vectors * texts).sum(axis=1) + 1) / 2
    chosen = [Chosen(one, c, float(s)) for one, c, s in zip(timeline.intervals, picked, scores, strict=True)]
    lengths = np.cumsum([piece.frames for piece in pieces])[:-1]
    return Composition(motion, tuple(chosen), tuple(float(frames) / FPS for frames in lengths))


def _stretches(cuts: Sequence[Cut]) -> list[tuple[Cut, float]]:
    """The first cut of each stretch that one interval leads, and where the stretch ends."""
    found: list[tuple[Cut, float]] = []
    for cut in cuts:
        if found and found[-1][0].base == cut.base:
            found[-1] = (found[-1][0], cut.end)
        else:
            found.append((cut, cut.end))
    return found


def _pieces(candidate: Candidate, source: Rotated, start: int, end: int) -> list[Piece]:
    """Frames `start` to `end` of what a candidate shows, one piece for each time that its cut is shown."""
    once = candidate.duration * FPS / candidate.rate
    pieces = []
    for time in range(candidate.repeats):
        first = start if time == 0 else max(start, round(time * once))
        last = end if time == candidate.repeats - 1 else min(end, round((time + 1) * once))
        if last > first:
            at = candidate.start * FPS + (first - time * once) * candidate.rate
            pieces.append(Piece(source, at, candidate.rate, last - first))
    return pieces


def _rests(pieces: Sequence[Piece]) -> NDArray[np.bool_]:
    """Whether each foot rests (T, 2) in what the pieces show."""
    found = []
    for piece in pieces:
        at = np.clip(np.rint(piece.first + piece.rate * np.arange(piece.frames)), 0, len(piece.source) - 1)
        found.append(standing(piece.source.joints(), FPS)[at.astype(int)])
    return np.concatenate(found)
