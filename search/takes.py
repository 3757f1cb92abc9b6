"""Questions about one motion: where does it happen, what is it, how does similarity run over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.bundle import Bundle
from encoders.motion import Motion
from indexer.clips import Caption
from search.chains import best_chain, candidates, whole
from search.dense import Vectors, curve, every, score_windows
from search.hits import Hit, Step
from search.moments import Moment, localise, score_stored
from search.question import Question
from search.source import Source
from search.strength import judge
from search.vocabulary import vocabulary

Found = tuple[Moment, tuple[Step, ...]]

#: The curve's windows, in seconds, and how many of them at most.
CURVE_WINDOW = 1.6
_CURVE_POINTS = 3000


def moments_in(bundle: Bundle, source: Source, question: Question, k: int) -> list[Hit]:
    """The best moments of one motion, best first."""
    queries = question.encode(bundle)
    found = find(bundle, source, question, queries, k)
    strengths = judge(bundle, queries.mean(axis=0), [moment.score for moment, _ in found])
    return [
        hit(rank, source, moment, strength, steps)
        for rank, ((moment, steps), strength) in enumerate(zip(found, strengths, strict=True), start=1)
    ]


def find(bundle: Bundle, source: Source, question: Question, queries: Vectors, k: int) -> list[Found]:
    """Spans of one motion that answer a question whose sentences are unit vectors (S, D), with their steps."""
    features = bundle.features(source.motion)
    if question.how == "then":
        chain = best_chain(candidates(bundle, features, bundle.fps, queries))
        if chain is None:
            return []
        steps = [Step(t, m.start, m.end, m.score) for t, m in zip(question.sentences, chain[0], strict=True)]
        return [(whole(chain[0]), tuple(steps))]
    coarse = score_stored(source.windows, queries)
    return [(moment, ()) for moment in localise(bundle, features, bundle.fps, queries, k, coarse=coarse)]


def hit(rank: int, source: Source, moment: Moment, strength: str, steps: tuple[Step, ...] = ()) -> Hit:
    """A span of a motion as an answer."""
    end = min(moment.end, source.duration)
    said = caption(source.captions, moment)
    return Hit(
        rank, source.path, moment.score, strength, moment.start, end, source.duration, said, source.clip_id, steps
    )


def curves(bundle: Bundle, motion: Motion, queries: Vectors) -> tuple[NDArray[np.float64], Vectors]:
    """Similarity over time: that of the window of 1.6 s around each time.

    Parameters
    ----------
    queries : float32 array (Q, D)

    Returns
    -------
    times : float64 array (T,)
        Seconds, at most ten a second.
    similarity : float32 array (Q, T)
    """
    features = bundle.features(motion)
    length = min(round(CURVE_WINDOW * bundle.fps), len(features))
    starts = every(len(features), length, max(1, -(-len(features) // _CURVE_POINTS)))
    windows = score_windows(bundle, features, bundle.fps, starts, length, queries)
    times = np.linspace(0, motion.duration, min(max(int(motion.duration * 10), 2), _CURVE_POINTS))
    return times, curve(windows, times)


def describe_motion(
    bundle: Bundle, motion: Motion, k: int, texts: Sequence[str] = (), vectors: Vectors | None = None
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
    list of (sentence, cosine similarity), best first, no sentence twice
    """
    motion_vector = bundle.encode_motions([motion])[0]
    words = vocabulary()
    scores = bundle.encode_texts(list(words)) @ motion_vector
    if vectors is not None and len(texts):
        words, scores = (*texts, *words), np.concatenate([vectors @ motion_vector, scores])
    best: dict[str, float] = {}
    for i in np.argsort(-scores, kind="stable"):
        best.setdefault(words[i], float(scores[i]))
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
