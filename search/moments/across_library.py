"""The best moments of all clips of a library: the nearest windows are candidates, and each is refined in its clip."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from itertools import islice
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.moments.localisation import refine, without_overlap
from search.moments.one_motion import find
from search.moments.queried_motion import QueriedMotion
from search.query.question import EncodedQuestion
from search.ranking.answers import Answer
from search.ranking.batched import batched
from search.ranking.clip_scores import ClipGallery, ClipScore, WindowGallery, rank_candidate_clips, rank_windows
from search.source import MotionSource
from search.spans import Moment

#: A clip's id and a moment of it.
LocatedMoment: TypeAlias = "tuple[int, Moment]"

#: Candidates refined in one batch, and motions whose features are kept for the next batches.
_BATCH, _KEPT = 10, 48
#: Clips searched in one batch when several sentences are asked, and answers of each.
_CLIPS, _OF_EACH = 20, 10


def best_moments(
    encoder: Encoder,
    gallery: WindowGallery,
    source_of: Callable[[int], MotionSource],
    question: EncodedQuestion,
    k: int,
    *,
    allowed: NDArray[np.int64] | None = None,
) -> list[LocatedMoment]:
    """At most k moments, best first within each batch of candidates.

    Parameters
    ----------
    gallery : WindowGallery
        The windows of all clips.
    source_of : callable
        Clip id -> the clip.
    question : EncodedQuestion
        With one vector.
    allowed : sorted int64 array, optional
        Ids of the clips to search in; all if not given.
    """
    queried = lru_cache(_KEPT)(lambda clip_id: QueriedMotion(encoder, source_of(clip_id), question))
    return list(islice(_ranked(queried, rank_windows(gallery, question.vectors[0], allowed=allowed)), k))


def answers_in_candidates(
    encoder: Encoder,
    gallery: ClipGallery,
    sources_of: Callable[[Iterable[int]], Mapping[int, MotionSource]],
    question: EncodedQuestion,
    *,
    allowed: NDArray[np.int64] | None = None,
) -> Iterator[Answer]:
    """Answers in the clips in which all sentences of a question are likely, best first in each batch of clips.

    Parameters
    ----------
    sources_of : callable
        Clip ids -> the clips by id.
    """
    for ids in batched(rank_candidate_clips(gallery, question.vectors, allowed=allowed), _CLIPS):
        found = [
            answer
            for source in sources_of(ids).values()
            for answer in find(QueriedMotion(encoder, source, question), _OF_EACH)
        ]
        yield from sorted(found, key=lambda answer: -answer.moment.score)


def _ranked(queried: Callable[[int], QueriedMotion], windows: Iterator[ClipScore]) -> Iterator[LocatedMoment]:
    known: list[LocatedMoment] = []
    for batch in batched(windows, _BATCH):
        found = [
            (clip_id, moment)
            for clip_id in dict.fromkeys(window.clip_id for window in batch)
            for moment in without_overlap(
                refine(queried(clip_id), [w.moment(w.end or 0.0) for w in batch if w.clip_id == clip_id]),
                [moment for clip, moment in known if clip == clip_id],
            )
        ]
        found.sort(key=lambda located: -located[1].score)
        known += found
        yield from found
