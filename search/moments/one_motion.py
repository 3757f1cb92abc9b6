"""The answers to a question in one motion: its best moments, or its steps in order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from search.hits import Hits, Step
from search.moments.localisation import best_moment, rank_moments
from search.moments.queried_motion import QueriedMotion
from search.moments.sequences import enclosing, find_sequence
from search.ranking.answers import Answer, as_hits
from search.ranking.by_amounts import ranked_by_amounts
from search.spans import Moment


def find(motion: QueriedMotion) -> Iterator[Answer]:
    """The answers, best first: of a question in steps there is at most one, with its steps."""
    question = motion.question
    if question.how != "then":
        yield from (answer_of(motion, moment) for moment in rank_moments(motion))
    elif sequence := find_sequence(motion):
        steps = (Step(text, m.start, m.end, m.score) for text, m in zip(question.sentences, sequence, strict=True))
        yield Answer(motion.source, enclosing(sequence), tuple(m.peak_score for m in sequence), tuple(steps))


def answer_of(motion: QueriedMotion, moment: Moment) -> Answer:
    """A moment as an answer."""
    return Answer(motion.source, moment, motion.peaks(moment))


def clip_answer(motion: QueriedMotion, score: float) -> Answer:
    """The best moment of a clip as an answer with the score of the clip."""
    answer = answer_of(motion, best_moment(motion))
    return answer._replace(moment=replace(answer.moment, score=score))


def moments_of(motion: QueriedMotion, k: int, least: str | None = None) -> Hits:
    """At most k moments of one motion as hits, best first; see `search.ranking.answers.as_hits`."""
    answers = ranked_by_amounts(motion.question, find(motion))
    return as_hits(motion.encoder, motion.question, answers, k, least)
