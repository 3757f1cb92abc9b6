"""Three steps asked in one sentence, "A, then B, then C": are all of them found where they happen?"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
from numpy.random import Generator

from encoders.corpus.composition.long_takes import AnnotatedTake, Event
from encoders.protocol import Encoder
from search.evaluate.moment_metrics import Spans
from search.moments.one_take import find
from search.query.question import Question
from search.source import MotionSource
from search.spans import iou

_STEPS = 3


def draw_steps(take: AnnotatedTake, rng: Generator, count: int) -> list[tuple[Event, ...]]:
    """Up to `count` runs of three things that follow one another in a take."""
    firsts = rng.permutation(max(len(take.events) - _STEPS + 1, 0))[:count]
    return [take.events[i : i + _STEPS] for i in sorted(firsts)]


def ask_in_order(bundle: Encoder, source: MotionSource, take: AnnotatedTake, steps: tuple[Event, ...]) -> float:
    """How well the worst of the steps found overlaps its truth, 0 to 1; 0 where the sentence is split otherwise.

    The sentence goes the way of every question: it is split, and its steps are found as a chain.
    """
    texts = [step.sentence.strip(" .,;") for step in steps]
    question = Question.of(", then ".join(texts))
    if len(question.sentences) != len(steps):
        return 0.0
    found = find(bundle, source, question, question.encode(bundle), 1)
    if not found:
        return 0.0
    truth = {marked.sentence: marked.spans for marked in take.annotations}
    return chain_overlap([(step.start, step.end) for step in found[0][1]], [truth[s.sentence] for s in steps])


def chain_overlap(found: Spans, truths: list[Spans]) -> float:
    """The overlap of the worst step with its truth, in the best choice of true spans that follow one another."""
    chains = (chain for chain in product(*truths) if all(a[0] < b[0] for a, b in pairwise(chain)))
    overlaps = (
        min(float(iou([a], [b], *true)[0]) for (a, b), true in zip(found, chain, strict=True)) for chain in chains
    )
    return max(overlaps, default=0.0)


def figures(overlaps: list[float]) -> dict[str, float]:
    """Percent of the questions all of whose steps are found."""
    worst = np.array(overlaps)
    return {"questions": float(len(worst))} | {f"all at {t}": 100 * float((worst >= t).mean()) for t in (0.3, 0.5, 0.7)}
