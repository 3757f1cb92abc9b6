"""The best moments of all clips of a library: the nearest windows say in which clips they are, and where."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.moments.localisation import moments_at
from search.moments.one_motion import answer_of, find
from search.moments.queried_motion import QueriedMotion
from search.query.question import EncodedQuestion
from search.ranking.answers import Answer
from search.ranking.batched import batched
from search.ranking.galleries import ClipGallery, WindowGallery
from search.ranking.window_ranking import rank_candidate_clips, rank_windows
from search.source import MotionSource
from search.spans import Moment

#: Windows of one batch, and motions whose similarity over time is kept for the next batches.
_BATCH, _KEPT = 10, 48
#: Clips searched in one batch when several sentences are asked, and answers of each.
_CLIPS, _OF_EACH = 20, 10


def moments_across(
    encoder: Encoder,
    gallery: WindowGallery,
    source_of: Callable[[int], MotionSource],
    question: EncodedQuestion,
    *,
    allowed: NDArray[np.int64] | None = None,
) -> Iterator[Answer]:
    """The moments of all clips, each one that its clip has by itself, best first within each batch of windows.

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
    known: set[tuple[int, Moment]] = set()
    for batch in batched(rank_windows(gallery, question.vectors[0], allowed=allowed), _BATCH):
        new: list[tuple[int, Moment]] = []
        for clip_id in dict.fromkeys(window.clip_id for window in batch):
            places = [window.moment(window.end or 0.0) for window in batch if window.clip_id == clip_id]
            new += [(clip_id, moment) for moment in moments_at(queried(clip_id), places)]
        new = sorted((found for found in new if found not in known), key=lambda found: -found[1].rank_score)
        known.update(new)
        yield from (answer_of(queried(clip_id), moment) for clip_id, moment in new)


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
            for answer in islice(find(QueriedMotion(encoder, source, question)), _OF_EACH)
        ]
        yield from sorted(found, key=lambda answer: -answer.moment.rank_score)
