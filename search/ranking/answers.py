"""Answers become hits: calibrated, downgraded where the sentence is out of vocabulary, and ranked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

from encoders.errors import ArgumentError
from encoders.protocol import Encoder
from search.hits import PLAUSIBLE, STRONG, WEAK, Hits, Step
from search.query.question import EncodedQuestion
from search.ranking.strength import Judge
from search.source import MotionSource
from search.spans import Moment

#: The degrees of strength, the least first.
DEGREES = (WEAK, PLAUSIBLE, STRONG)
#: So many answers in a row that are too weak end the list.
_PATIENCE = 5


def checked_strength(value: object) -> str | None:
    """The least strength of a hit that a user asks for; None for the default.

    Raises
    ------
    ArgumentError
        If it is none of the degrees.
    """
    if value is None or value in DEGREES:
        return value
    raise ArgumentError(f"min_strength={value!r} must be one of {', '.join(DEGREES)}")


class Answer(NamedTuple):
    """A moment of a motion.

    Attributes
    ----------
    source : MotionSource
    moment : Moment
    peaks : tuple of float
        The highest similarity to each query vector of the question.
    steps : tuple of Step
        Where the question has some.
    matched : tuple of str
        Where its clip has the words of the question; see `search.ranking.text_matches`.
    """

    source: MotionSource
    moment: Moment
    peaks: tuple[float, ...]
    steps: tuple[Step, ...] = ()
    matched: tuple[str, ...] = ()


def as_hits(
    encoder: Encoder, question: EncodedQuestion, answers: Iterable[Answer], k: int, least: str | None = None
) -> Hits:
    """The first k answers, best first, as hits with rank and strength; no more of them are consumed than needed.

    Parameters
    ----------
    least : str, optional
        The least strength of a hit. If not given, weak answers are left out unless the first one is weak, too; but
        those are listed that have the words of the question.
    """
    listed = islice(_listed(encoder, question, answers, least), k)
    return Hits(
        replace(answer.source.hit(rank, answer.moment, strength, answer.steps), matched=answer.matched)
        for rank, (answer, strength) in enumerate(listed, start=1)
    )


def _listed(
    encoder: Encoder, question: EncodedQuestion, answers: Iterable[Answer], least: str | None
) -> Iterator[tuple[Answer, str]]:
    """The answers that are strong enough, with their strength; which ones does not depend on how many are consumed."""
    judge, rejected, is_given = Judge(encoder, question), 0, least is not None
    for answer in answers:
        strength = judge(answer.peaks)
        if answer.matched and not is_given:
            least = PLAUSIBLE
            yield answer, strength
            continue
        least = least or (WEAK if strength == WEAK else PLAUSIBLE)
        if strength and DEGREES.index(strength) < DEGREES.index(least):
            rejected += 1
            if rejected == _PATIENCE:
                return
            continue
        rejected = 0
        yield answer, strength
