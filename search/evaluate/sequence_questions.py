"""Queries for three steps in one sentence, "A, then B, then C": are all of them found where they happen?"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
from numpy.random import Generator

from encoders.corpus.composition.long_takes import AnnotatedTake, Event
from encoders.protocol import Encoder
from search.evaluate.moment_metrics import Spans
from search.moments.one_motion import find
from search.moments.queried_motion import QueriedMotion
from search.query.question import Question
from search.source import MotionSource
from search.spans import temporal_iou

_STEPS = 3


def draw_sequences(take: AnnotatedTake, rng: Generator, count: int) -> list[tuple[Event, ...]]:
    """Up to `count` sequences of three events that follow one another in a take."""
    firsts = rng.permutation(max(len(take.events) - _STEPS + 1, 0))[:count]
    return [take.events[i : i + _STEPS] for i in sorted(firsts)]


def search_sequence(encoder: Encoder, source: MotionSource, take: AnnotatedTake, events: tuple[Event, ...]) -> float:
    """Overlap of the worst step with its truth, 0 to 1; 0 where the sentence is not split into these steps.

    The sentence is parsed as any query: it is split into steps, which are found together.
    """
    texts = [event.sentence.strip(" .,;") for event in events]
    question = Question.of(", then ".join(texts))
    if len(question.sentences) != len(events):
        return 0.0
    found = next(find(QueriedMotion(encoder, source, question.encode(encoder))), None)
    if found is None:
        return 0.0
    truth = {annotation.sentence: annotation.spans for annotation in take.annotations}
    return sequence_overlap([(step.start, step.end) for step in found.steps], [truth[e.sentence] for e in events])


def sequence_overlap(found: Spans, truths: list[Spans]) -> float:
    """Intersection over union of the worst step with its truth, for the best true spans that follow one another."""
    sequences = (spans for spans in product(*truths) if all(a[0] < b[0] for a, b in pairwise(spans)))
    overlaps = (
        min(float(temporal_iou([a], [b], *true)[0]) for (a, b), true in zip(found, spans, strict=True))
        for spans in sequences
    )
    return max(overlaps, default=0.0)


def sequence_figures(overlaps: list[float]) -> dict[str, float]:
    """Percent of the queries all of whose steps are found, by threshold."""
    worst = np.array(overlaps)
    return {"questions": float(len(worst))} | {f"all at {t}": 100 * float((worst >= t).mean()) for t in (0.3, 0.5, 0.7)}
