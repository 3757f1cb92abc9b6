"""Questions about a motion without a library: a file, a `Motion`, or an array of joints."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from encoders.arguments import checked_count, checked_span
from encoders.bundle.bundle import Bundle
from encoders.protocol import Encoder
from indexer.argument_checks import checked_encoder, checked_rate, checked_up
from search.hits import Hits
from search.moments.one_motion import moments_of
from search.moments.queried_motion import QueriedMotion
from search.moments.segments import Segment, segment_motion
from search.query.question import Question
from search.ranking.answers import checked_strength
from search.ranking.description import Description, describe_motion
from search.references import Ref, source_of, span_of
from search.source import MotionSource


def moments(
    text: str | None,
    ref: Ref,
    k: int = 10,
    *,
    then: Sequence[str] = (),
    meanwhile: Sequence[str] = (),
    split_steps: bool = True,
    min_strength: str | None = None,
    fps: float | None = None,
    up: str | None = None,
    bundle: Encoder | None = None,
) -> Hits:
    """The moments of a motion at which a sentence happens, best first.

    Parameters
    ----------
    text : str or None
        A sentence; None where `then` or `meanwhile` say all.
    ref : path, Motion, hit or array (T, 22, 3)
        The motion to search in.
    k : int
        Maximum number of hits.
    then : sequence of str
        Steps that follow, where the sentence does not state them itself ("walks, then sits down").
    meanwhile : sequence of str
        What happens at the same time.
    split_steps : bool
        Whether a sentence that states steps is split into them.
    min_strength : str, optional
        The least strength of a hit: "weak", "plausible" or "strong". If not given, weak ones are left out where the
        first is better.
    fps : float, optional
        Frames a second of an array, 20 if not given, or the true frame rate of a file.
    up : str, optional
        The axis that is up in an array or a file, "x", "y", "z", "-x", "-y" or "-z", whatever it says.
    bundle : Encoder, optional
        The model; the shipped one if not given.

    Raises
    ------
    QueryError
        If the sentence is empty; its subclass `ArgumentError` if a value is of a wrong type or out of range.
    UnreadableMotion
        If a file cannot be read.
    """
    k, question = checked_count(k), Question.of(text, then, meanwhile, split_steps=split_steps)
    encoder, least = _encoder(bundle), checked_strength(min_strength)
    return moments_of(QueriedMotion(encoder, _source(ref, fps, up), question.encode(encoder)), k, least)


def describe(
    ref: Ref,
    k: int = 5,
    start: float | None = None,
    end: float | None = None,
    *,
    fps: float | None = None,
    up: str | None = None,
    bundle: Encoder | None = None,
) -> list[Description]:
    """The sentences of the shipped vocabulary that fit a motion, or a span of it in seconds, best; see `moments`.

    Returns
    -------
    list of Description
        Pairs (sentence, score) with their `strength`; best first. The score is a cosine less what is taken from
        sentences near every motion.

    Raises
    ------
    QueryError
        If the span is empty or lies outside the motion.
    """
    motion = _source(ref, fps, up).cut(*checked_span(*span_of(ref, start, end)))
    return describe_motion(_encoder(bundle), motion, checked_count(k))


def segment(
    ref: Ref,
    labels: Sequence[str] | None = None,
    *,
    fps: float | None = None,
    up: str | None = None,
    bundle: Encoder | None = None,
) -> list[Segment]:
    """Label a motion from beginning to end, without gaps; see `moments`.

    Parameters
    ----------
    labels : sequence of str, optional
        The labels; the shipped vocabulary if not given. A segment that none of them fits has an empty one.
    """
    return segment_motion(_encoder(bundle), _source(ref, fps, up), labels)


def _encoder(bundle: Encoder | None) -> Encoder:
    given = checked_encoder(bundle)
    return _shipped() if given is None else given


@cache
def _shipped() -> Bundle:
    return Bundle.load()


def _source(ref: Ref, fps: float | None, up: str | None) -> MotionSource:
    return source_of(ref, fps=checked_rate(fps), up=checked_up(up))
