"""Questions about one motion: where does it happen, what is it, how does similarity run over time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import LENGTHS as STORED_LENGTHS
from encoders.bundle.windows import WINDOWS_A_LENGTH
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.store.clips import Caption
from search.hits import Hit, Hits, Step
from search.moments.boundaries import frame_curve
from search.moments.localisation import Moment, Region, background_level, rank, score_stored
from search.moments.sequences import best_chain, candidates, refine_chain, whole
from search.moments.window_scores import Scored, Vectors, curve, join
from search.query.question import Question
from search.query.vocabulary import vocabulary
from search.ranking.hubness import hubness_penalty
from search.ranking.strength import downgrade, judge
from search.source import MotionSource

Found = tuple[Moment, tuple[Step, ...]]

#: Takes up to so many seconds are read as a whole; of longer ones in a library, only where something is.
LONG = 300.0
#: Seconds of motion read around a part of a long clip: what features see of a take beyond a window is slow.
_ROOM = 8.0
#: Parts of a long clip begin at multiples of so many seconds: their features are then those of the whole clip.
_GRID = 1.0
#: So many sentences nearest to a motion are compared closely.
_COMPARED = 1000


def moments_in(bundle: Encoder, source: MotionSource, question: Question, k: int) -> list[Hit]:
    """The best moments of one motion, best first."""
    queries = question.encode(bundle)
    found = find(bundle, source, question, queries, k)
    strengths = judge(bundle, queries.mean(axis=0), [moment.height for moment, _ in found])
    strengths = downgrade(bundle, question.sentences, strengths)
    return Hits(
        hit(rank, source, moment, strength, steps)
        for rank, ((moment, steps), strength) in enumerate(zip(found, strengths, strict=True), start=1)
    )


def find(bundle: Encoder, source: MotionSource, question: Question, queries: Vectors, k: int) -> list[Found]:
    """Spans of one motion that answer a question whose sentences are unit vectors (S, D), with their steps."""
    coarse, region = coarse_windows(bundle, source, queries), region_of(bundle, source)
    if question.how != "then":
        level = background_level(bundle, coarse, queries)
        ranked = rank(bundle, region, bundle.fps, queries, join(coarse), level)
        return [(moment, ()) for moment in islice(ranked, k)]
    is_long = source.duration > LONG
    chain = best_chain(join(coarse) if is_long else candidates(bundle, source.features(bundle), bundle.fps, queries))
    if not chain:
        return []
    levels = [
        background_level(bundle, score_stored(source.windows(bundle), query[None]), query[None]) for query in queries
    ]
    chain = refine_chain(bundle, region, bundle.fps, queries, chain, levels)
    steps = tuple(Step(text, m.start, m.end, m.score) for text, m in zip(question.sentences, chain, strict=True))
    return [(whole(chain), steps)]


def coarse_windows(bundle: Encoder, source: MotionSource, queries: Vectors) -> list[Scored]:
    """The windows of a motion that a library holds, or would hold, compared with queries (Q, D)."""
    return score_stored(source.windows(bundle), queries)


def region_of(bundle: Encoder, source: MotionSource) -> Region:
    """Features of parts of a motion; of a long clip of a library only what is asked for is read."""
    if source.stored and source.duration > LONG:

        def part(start: float, end: float) -> tuple[Vectors, float]:
            first = max(start - _ROOM, 0.0) // _GRID * _GRID
            return bundle.features(source.read(first, end + _ROOM)), first

        return part
    features = source.features(bundle)
    return lambda start, end: (features, 0.0)


def hit(rank: int, source: MotionSource, moment: Moment, strength: str, steps: tuple[Step, ...] = ()) -> Hit:
    """A span of a motion as an answer."""
    duration = source.duration
    end = min(moment.end, duration)
    said = caption(source.captions, moment)

    def read() -> Motion:
        return source.cut(moment.start, end)

    return Hit(
        rank, source.path, moment.score, strength, moment.start, end, duration, said, source.clip_id, steps, read
    )


def curves(bundle: Encoder, source: MotionSource, queries: Vectors) -> tuple[NDArray[np.float64], Vectors]:
    """Similarity over time, as moments are found by it; of a long motion, that of the shortest stored windows.

    Parameters
    ----------
    queries : float32 array (Q, D)

    Returns
    -------
    times : float64 array (T,)
        Seconds.
    similarity : float32 array (Q, T)
    """
    if source.duration > LONG:
        times = np.arange(0, source.duration, STORED_LENGTHS[0] / WINDOWS_A_LENGTH, dtype=np.float64)
        return times, curve(coarse_windows(bundle, source, queries)[0], times)
    similarity = frame_curve(bundle, source.features(bundle), bundle.fps, queries)
    times = (np.arange(similarity.shape[1], dtype=np.float64) + 0.5) / bundle.fps
    return times, similarity


def describe_motion(
    bundle: Encoder, motion: Motion, k: int, texts: Sequence[str] = (), vectors: Vectors | None = None
) -> list[tuple[str, float]]:
    """The sentences that fit a motion best.

    Parameters
    ----------
    texts : sequence of str
        Captions to choose from beside the shipped vocabulary.
    vectors : float32 array (N, D)
        Theirs.

    Returns
    -------
    list of (sentence, score), best first, no sentence twice
        The score is the cosine less what `hubs.nearness` takes from sentences that lie near every motion.
    """
    motion_vector = bundle.encode_motions([motion])[0]
    words = vocabulary()
    sentences = bundle.encode_texts(list(words))
    if vectors is not None and len(texts):
        words, sentences = (*texts, *words), np.concatenate([vectors, sentences])
    cosines = sentences @ motion_vector
    near = np.argsort(-cosines, kind="stable")[: max(_COMPARED, 10 * k)]
    scores = cosines[near] - hubness_penalty(bundle, sentences[near])
    best: dict[str, float] = {}
    for i in np.argsort(-scores, kind="stable"):
        best.setdefault(words[near[i]], float(scores[i]))
        if len(best) == k:
            break
    return list(best.items())


def caption(captions: Sequence[Caption], moment: Moment) -> str:
    """The caption that says most about a span: the one timed to overlap it longest, else one of the whole clip."""
    timed = [
        (min(c.end, moment.end) - max(c.start or 0.0, moment.start), c.text) for c in captions if c.end is not None
    ]
    if timed and max(timed)[0] > 0:
        return max(timed)[1]
    return next((c.text for c in captions if c.end is None), "")
