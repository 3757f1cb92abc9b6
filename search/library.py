"""Library: an indexed folder that answers questions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from encoders.errors import QueryError
from encoders.motion import Motion
from indexer.store.clips import Clip
from indexer.store.stored_library import StoredLibrary
from search.hits import Hits
from search.moments.across_library import LocatedMoment, best_moments
from search.moments.one_motion import find, moments_of
from search.moments.queried_motion import QueriedMotion
from search.query.filters import Filters
from search.query.question import EncodedQuestion, Question
from search.ranking.alignment import LONGEST, RERANKED, alignment_bonus
from search.ranking.answers import Answer, as_hits
from search.ranking.batched import batched
from search.ranking.clip_scores import ClipScore, best_clips, rank_candidate_clips
from search.ranking.description import describe_motion
from search.source import MotionSource, find_clip, find_source

Ref: TypeAlias = "str | PathLike[str] | Motion | MotionSource"
Ids = NDArray[np.int64]

#: Candidate clips searched in one batch when several sentences are asked of the library, and answers of each.
_BATCH, _OF_EACH = 20, 10
#: The shortest cut that can be compared, in seconds.
_SHORTEST_CUT = 0.5


class Library(StoredLibrary):
    """An indexed folder that answers questions.

    Every question takes the fields of `search.query.filters.Filters` as keyword arguments and answers with at most
    `k` hits, best first. A `ref` is a motion, a file, or a clip of the library by path, name or "#id".
    """

    def search(self, text: str, k: int = 10, **filters: Any) -> Hits:
        """The clips that fit a sentence best, each with the span that does.

        Raises
        ------
        QueryError
            If the sentence is empty or a filter makes no sense.
        """
        return self.search_encoded(Question.of(text, split_steps=False).encode(self.bundle), k, **filters)

    def search_encoded(self, question: EncodedQuestion, k: int = 10, **filters: Any) -> Hits:
        """The clips that fit a question that is encoded already; see `search`."""
        return self._clip_hits(question, k, self.allowed(**filters))

    def moments(
        self,
        text: str | None,
        ref: Ref | None = None,
        k: int = 10,
        *,
        then: Sequence[str] = (),
        meanwhile: Sequence[str] = (),
        **filters: Any,
    ) -> Hits:
        """Where a sentence happens: in one motion, or anywhere in the library.

        Parameters
        ----------
        then : sequence of str
            Steps that follow, where the sentence does not say them itself ("walks, then sits down").
        meanwhile : sequence of str
            What happens at the same time.

        Raises
        ------
        QueryError
            If the sentence is empty.
        UnreadableMotion, LibraryError
            If `ref` names nothing that can be read.
        """
        return self.answer(Question.of(text, then, meanwhile), ref, k, **filters)

    def answer(self, question: Question, ref: Ref | None = None, k: int = 10, **filters: Any) -> Hits:
        """The moments that answer a question, in one motion or anywhere in the library; see `moments`."""
        encoded = question.encode(self.bundle)
        if ref is not None:
            return moments_of(QueriedMotion(self.bundle, self.source(ref), encoded), k)
        return self._moment_hits(encoded, k, self.allowed(**filters))

    def describe(self, ref: Ref, k: int = 5) -> list[tuple[str, float]]:
        """The sentences that fit a motion best: the library's captions and the shipped vocabulary."""
        captions, _, vectors = self.caption_vectors()
        return describe_motion(self.bundle, self.source(ref).motion, k, captions, vectors)

    def similar(
        self,
        ref: Ref,
        k: int = 10,
        start: float | None = None,
        end: float | None = None,
        *,
        moments: bool = False,
        **filters: Any,
    ) -> Hits:
        """The clips, or with `moments` the spans, most like a motion or a cut of it; never from the clip itself.

        Raises
        ------
        QueryError
            If the cut lies outside the motion or is too short.
        """
        source = self.source(ref)
        motion = source.cut(start, end)
        is_cut = start is not None or end is not None
        if is_cut and motion.duration < _SHORTEST_CUT:
            raise QueryError(
                f"{source.path}: a cut of {motion.duration:.2f} s shows too little movement to compare; "
                f"take at least {_SHORTEST_CUT:g} s"
            )
        question = EncodedQuestion(self.bundle.encode_motions([motion]), kind="motion")
        allowed = self.allowed(**filters)
        if source.clip_id >= 0:
            allowed = np.setdiff1d(self.ids() if allowed is None else allowed, [source.clip_id])
        if moments:
            return self._moment_hits(question, k, allowed)
        if is_cut:
            return self._clip_hits(question, k, allowed)
        found = best_clips(self, question.vectors[0], max(k, RERANKED), allowed=allowed, windows=False)
        return self._hits(question, self._rerank_by_alignment(motion, found)[:k])

    def _rerank_by_alignment(self, motion: Motion, found: list[ClipScore]) -> list[ClipScore]:
        """The nearest clips, those first that also move alike moment by moment; scores rise accordingly."""
        clips = self.clips([score.clip_id for score in found])
        near = [score for score in found[:RERANKED] if clips[score.clip_id].duration <= LONGEST]
        if not near or motion.duration > LONGEST:
            return found
        bonuses = alignment_bonus(self.bundle, motion, [self.motion(score.clip_id) for score in near])
        bonus = {score.clip_id: float(b) for score, b in zip(near, bonuses, strict=True)}
        raised = [replace(s, score=min(1.0, s.score + bonus.get(s.clip_id, 0.0))) for s in found]
        return sorted(raised, key=lambda s: -s.score)

    def source(self, ref: Ref) -> MotionSource:
        """What a reference names.

        Raises
        ------
        UnreadableMotion, LibraryError
            If it names nothing that can be read.
        """
        if isinstance(ref, MotionSource):
            return ref
        return MotionSource.of_motion(ref) if isinstance(ref, Motion) else find_source(ref, self)

    def known(self, ref: str | PathLike[str]) -> Clip | None:
        """The clip a reference names, or None for a file that is not in the library."""
        return find_clip(self, ref)

    def allowed(self, **filters: Any) -> Ids | None:
        """The clips that pass the filters, as sorted ids; None for all.

        Raises
        ------
        QueryError
            If there is no such filter, or its value makes no sense.
        """
        unknown = sorted(set(filters) - set(Filters.__dataclass_fields__))
        if unknown:
            raise QueryError(f"no filter {', '.join(unknown)}; there are {', '.join(Filters.__dataclass_fields__)}")
        condition, values = Filters(**filters).where()
        return self.ids(condition, values) if condition else None

    def _clip_hits(self, question: EncodedQuestion, k: int, allowed: Ids | None) -> Hits:
        return self._hits(question, best_clips(self, question.vectors[0], k, allowed=allowed))

    def _hits(self, question: EncodedQuestion, found: Sequence[ClipScore]) -> Hits:
        clips = self.clips([score.clip_id for score in found])
        located = [(score.clip_id, score.moment(clips[score.clip_id].duration)) for score in found]
        return as_hits(self.bundle, question, self._answers(located))

    def _moment_hits(self, question: EncodedQuestion, k: int, allowed: Ids | None) -> Hits:
        """The best spans over all clips."""
        if question.how == "alone":
            found = best_moments(self.bundle, self, self._source_of, question, k, allowed=allowed)
            return as_hits(self.bundle, question, self._answers(found))
        return as_hits(self.bundle, question, list(islice(self._find_in_candidates(question, allowed), k)))

    def _find_in_candidates(self, question: EncodedQuestion, allowed: Ids | None) -> Iterator[Answer]:
        """Answers in the clips in which all sentences are likely, best first in each batch of clips."""
        for ids in batched(rank_candidate_clips(self, question.vectors, allowed=allowed), _BATCH):
            sources = (MotionSource.of_clip(self, clip) for clip in self.clips(ids).values())
            found = [
                answer for source in sources for answer in find(QueriedMotion(self.bundle, source, question), _OF_EACH)
            ]
            yield from sorted(found, key=lambda answer: -answer.moment.score)

    def _source_of(self, clip_id: int) -> MotionSource:
        return MotionSource.of_clip(self, self.clip(clip_id))

    def _answers(self, located: Sequence[LocatedMoment]) -> list[Answer]:
        clips = self.clips([clip_id for clip_id, _ in located])
        return [Answer(MotionSource.of_clip(self, clips[clip_id]), moment) for clip_id, moment in located]
