"""A library that can be asked: search, moments, describe, similar."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
from search.hits import Hit, Hits, Step
from search.moments.across_clips import best_moments
from search.moments.localisation import Moment
from search.moments.one_take import caption, describe_motion, find, moments_in
from search.moments.window_scores import Vectors
from search.query.filters import Filters
from search.query.question import Question
from search.ranking.alignment import LONGEST, LOOKED_AT, likeness
from search.ranking.clip_scores import ClipScore, best_clips, likeliest_in_order
from search.ranking.paging import rounds
from search.ranking.strength import downgrade_hits, judge
from search.source import MotionSource, find_clip, find_source

Ref: TypeAlias = "str | PathLike[str] | Motion | MotionSource"
Ids = NDArray[np.int64]
Located = tuple[int, Moment, tuple[Step, ...]]

#: Clips asked by themselves in a round when several sentences are asked of the whole library, and answers of each.
_ROUND, _OF_EACH = 20, 10
#: The shortest cut that can be asked for, in seconds.
_SHORTEST_CUT = 0.5


class Library(StoredLibrary):
    """An indexed folder that answers questions.

    Every question takes the fields of `search.query.filters.Filters` as keyword arguments and answers with at most
    `k` hits, best first. A `ref` is a motion, a file, or a clip of the library by path, name or "#id".
    """

    def search(self, text: str, k: int = 10, **filters: Any) -> list[Hit]:
        """The clips that fit a sentence best, each with the span that does.

        Raises
        ------
        QueryError
            If the sentence is empty or a filter makes no sense.
        """
        query = Question.of(text, split_steps=False).encode(self.bundle)[0]
        return self._sentence_hits(text, query, k, filters)

    def moments(
        self,
        text: str | None,
        ref: Ref | None = None,
        k: int = 10,
        *,
        then: Sequence[str] = (),
        meanwhile: Sequence[str] = (),
        **filters: Any,
    ) -> list[Hit]:
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

    def answer(self, question: Question, ref: Ref | None = None, k: int = 10, **filters: Any) -> list[Hit]:
        """The moments that answer a question, in one motion or anywhere in the library; see `moments`."""
        if ref is not None:
            return moments_in(self.bundle, self.source(ref), question, k)
        queries, allowed = question.encode(self.bundle), self.allowed(**filters)
        return downgrade_hits(self.bundle, question.sentences, self._moment_hits(question, queries, k, allowed))

    def describe(self, ref: Ref, k: int = 5) -> list[tuple[str, float]]:
        """The sentences that fit a motion best: the library's captions and the shipped vocabulary."""
        texts, _, vectors = self.caption_vectors()
        return describe_motion(self.bundle, self.source(ref).motion, k, texts, vectors)

    def similar(
        self,
        ref: Ref,
        k: int = 10,
        start: float | None = None,
        end: float | None = None,
        *,
        moments: bool = False,
        **filters: Any,
    ) -> list[Hit]:
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
        vector = self.bundle.encode_motions([motion])[0]
        allowed = self.allowed(**filters)
        if source.clip_id >= 0:
            allowed = np.setdiff1d(self.ids() if allowed is None else allowed, [source.clip_id])
        if moments:
            return self._moment_hits(Question((source.path,)), vector[None], k, allowed, asked="motion")
        if is_cut:
            return self._clip_hits(vector, k, allowed, asked="motion")
        evidence = best_clips(self, vector, max(k, LOOKED_AT), allowed=allowed, windows=False)
        return self._hits(vector, self._alike_first(motion, evidence)[:k], asked="motion")

    def _alike_first(self, motion: Motion, evidence: list[ClipScore]) -> list[ClipScore]:
        """The clips nearest in meaning, those first that also move alike moment by moment; scores rise accordingly."""
        clips = self.clips([e.clip_id for e in evidence])
        near = [e for e in evidence[:LOOKED_AT] if clips[e.clip_id].duration <= LONGEST]
        if not near or motion.duration > LONGEST:
            return evidence
        gains = likeness(self.bundle, motion, [self.motion(e.clip_id) for e in near])
        gain = {e.clip_id: float(g) for e, g in zip(near, gains, strict=True)}
        raised = [replace(e, score=min(1.0, e.score + gain.get(e.clip_id, 0.0))) for e in evidence]
        return sorted(raised, key=lambda e: -e.score)

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

    def _sentence_hits(self, text: str, query: Vectors, k: int, filters: Mapping[str, Any]) -> list[Hit]:
        """The clips that fit a sentence best, whose query vector (D,) is this."""
        found = self._clip_hits(query, k, self.allowed(**filters), asked="sentence")
        return downgrade_hits(self.bundle, (text,), found)

    def _clip_hits(self, query: Vectors, k: int, allowed: Ids | None, *, asked: str, windows: bool = True) -> list[Hit]:
        return self._hits(query, best_clips(self, query, k, allowed=allowed, windows=windows), asked=asked)

    def _hits(self, query: Vectors, evidence: list[ClipScore], *, asked: str) -> list[Hit]:
        strengths = judge(self.bundle, query, [e.score for e in evidence], asked=asked)
        clips = self.clips([e.clip_id for e in evidence])
        return Hits(
            self._hit(rank, clips[e.clip_id], _span(e, clips[e.clip_id].duration), strength)
            for rank, (e, strength) in enumerate(zip(evidence, strengths, strict=True), start=1)
        )

    def _moment_hits(
        self, question: Question, queries: Vectors, k: int, allowed: Ids | None, *, asked: str = "sentence"
    ) -> list[Hit]:
        """The best spans over all clips."""
        found = (
            self._best_moments(queries, k, allowed)
            if question.how == "alone"
            else list(islice(self._answers(question, queries, allowed), k))
        )
        clips = self.clips([clip_id for clip_id, *_ in found])
        strengths = judge(self.bundle, queries.mean(axis=0), [moment.height for _, moment, _ in found], asked=asked)
        return Hits(
            self._hit(rank, clips[clip_id], moment, strength, steps)
            for rank, ((clip_id, moment, steps), strength) in enumerate(zip(found, strengths, strict=True), start=1)
        )

    def _best_moments(self, queries: Vectors, k: int, allowed: Ids | None) -> list[Located]:
        """Windows of all clips say where; each place is then looked at closely."""

        def source_of(clip_id: int) -> MotionSource:
            return MotionSource.of_clip(self, self.clip(clip_id))

        found = best_moments(self.bundle, self, source_of, queries, k, allowed=allowed)
        return [(clip_id, moment, ()) for clip_id, moment in found]

    def _answers(self, question: Question, queries: Vectors, allowed: Ids | None) -> Iterator[Located]:
        """Answers in the clips in which all sentences are likely, each clip asked by itself."""
        for ids in rounds(likeliest_in_order(self, queries, allowed=allowed), _ROUND):
            found: list[Located] = [
                (clip.id, moment, steps)
                for clip in self.clips(ids).values()
                for moment, steps in find(self.bundle, MotionSource.of_clip(self, clip), question, queries, _OF_EACH)
            ]
            yield from sorted(found, key=lambda entry: -entry[1].score)

    def _hit(self, rank: int, clip: Clip, moment: Moment, strength: str, steps: tuple[Step, ...] = ()) -> Hit:
        end = min(moment.end, clip.duration)
        said = caption(self.captions(clip.id), moment)

        def read() -> Motion:
            return self.motion(clip.id, moment.start, end)

        return Hit(
            rank, clip.path, moment.score, strength, moment.start, end, clip.duration, said, clip.id, steps, read
        )


def _span(evidence: ClipScore, duration: float) -> Moment:
    if evidence.start is None or evidence.end is None:
        return Moment(0.0, duration, evidence.score)
    return Moment(evidence.start, evidence.end, evidence.score)
