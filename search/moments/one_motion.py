"""The answers to a question in one motion: its best moments, or its steps in order."""

from __future__ import annotations

from itertools import islice

from search.hits import Hits, Step
from search.moments.localisation import rank_moments
from search.moments.queried_motion import QueriedMotion
from search.moments.sequences import enclosing, find_sequence
from search.ranking.answers import Answer, as_hits


def find(motion: QueriedMotion, k: int) -> list[Answer]:
    """At most k answers, best first: of a question in steps there is at most one, with its steps."""
    question, source = motion.question, motion.source
    if question.how != "then":
        return [Answer(source, moment) for moment in islice(rank_moments(motion), k)]
    sequence = find_sequence(motion)
    if not sequence:
        return []
    steps = (Step(text, m.start, m.end, m.score) for text, m in zip(question.sentences, sequence, strict=True))
    return [Answer(source, enclosing(sequence), tuple(steps))]


def moments_of(motion: QueriedMotion, k: int) -> Hits:
    """At most k moments of one motion as hits, best first."""
    return as_hits(motion.encoder, motion.question, find(motion, k))
