"""Answers become hits: calibrated, downgraded where the sentence is out of vocabulary, and ranked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from encoders.protocol import Encoder
from search.hits import Hits, Step
from search.query.question import EncodedQuestion
from search.ranking.strength import judge
from search.source import MotionSource
from search.spans import Moment


class Answer(NamedTuple):
    """A moment of a motion, with its steps where the question has some."""

    source: MotionSource
    moment: Moment
    steps: tuple[Step, ...] = ()


def as_hits(encoder: Encoder, question: EncodedQuestion, answers: Sequence[Answer]) -> Hits:
    """Answers, best first, as hits with rank and strength."""
    strengths = judge(encoder, question, [answer.moment.peak_score for answer in answers])
    return Hits(
        answer.source.hit(rank, answer.moment, strength, answer.steps)
        for rank, (answer, strength) in enumerate(zip(answers, strengths, strict=True), start=1)
    )
