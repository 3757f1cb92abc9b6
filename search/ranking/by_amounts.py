"""Answers ranked by the amounts that a question asks for: the first are measured, and those that agree come first."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from encoders.motion import Motion
from search.query.amounts import Amounts, amounts_of
from search.query.question import EncodedQuestion
from search.ranking.answers import Answer
from search.ranking.measured_amounts import MOST_TIMES, times_done, turned

#: Answers that are measured.
MEASURED = 40
#: How much full agreement counts beside a cosine: angles are measured more surely than counts (`benchmarks.amounts`).
_OF_TIMES, _OF_DEGREES = 0.25, 0.5
#: Seconds of a clip that is measured as a whole, too, at most.
_SHORT = 12.0
#: Degrees, and share of those asked for, by which a turn may differ.
_NEAR, _NEAR_SHARE = 10.0, 0.15


def ranked_by_amounts(question: EncodedQuestion, answers: Iterator[Answer]) -> Iterator[Answer]:
    """The answers, the first `MEASURED` ordered by score and agreement; as they are where no amount is asked for."""
    amounts = amounts_of(question.wanted[0]) if len(question.sentences) == 1 else Amounts()
    if not amounts:
        yield from answers
        return
    first = list(islice(answers, MEASURED))
    worth = [answer.moment.score + _bonus_of(answer, amounts) for answer in first]
    yield from (first[i] for i in np.argsort(-np.array(worth), kind="stable"))
    yield from answers


def _bonus_of(answer: Answer, amounts: Amounts) -> float:
    """The bonus of the span of an answer or, where that is higher, of its whole clip, if it is short."""
    source, moment = answer.source, answer.moment
    best = bonus(source.read(moment.start, min(moment.end, source.duration)), amounts)
    return max(best, bonus(source.motion, amounts)) if source.duration <= _SHORT else best


def bonus(motion: Motion, amounts: Amounts) -> float:
    """What is added to the cosine of a motion that does something as often as is asked for, or turns by as much."""
    if amounts.degrees:
        angle = turned(motion)
        error = abs((angle * amounts.side if amounts.side else abs(angle)) - amounts.degrees)
        return float(_OF_DEGREES * np.exp(-((error / (_NEAR + _NEAR_SHARE * amounts.degrees)) ** 2)))
    return float(_OF_TIMES * times_done(motion)[amounts.times]) if amounts.times <= MOST_TIMES else 0.0
