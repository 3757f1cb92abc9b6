"""AnsweringLibrary: how a question that is encoded becomes hits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from encoders.motion import Motion
from encoders.protocol import TokenEncoder
from search.abilities.selecting import Ids, SelectableLibrary
from search.hits import Hits
from search.moments.across_library import answers_in_candidates, moments_across
from search.moments.one_motion import clip_answer
from search.moments.queried_motion import QueriedMotion
from search.query.question import EncodedQuestion
from search.ranking.alignment import RERANKED, rerank_by_alignment
from search.ranking.answers import Answer, as_hits
from search.ranking.batched import batched
from search.ranking.by_amounts import ranked_by_amounts
from search.ranking.clip_scores import ClipScore, best_clips, rank_clips
from search.ranking.galleries import ExactGallery
from search.ranking.late_interaction import rerank_by_tokens
from search.ranking.text_matches import TextMatch, fused, text_matches
from search.ranking.window_ranking import rank_by_window
from search.source import MotionSource

#: Clips of those found whose moments are looked for at once.
_REFINED = 10


class AnsweringLibrary(SelectableLibrary):
    """A library that ranks its clips and their moments."""

    #: Whether the poses of the clips are at hand.
    has_poses = True

    def text_matches(self, sentence: str, allowed: Ids | None) -> Mapping[int, TextMatch]:
        """The clips that have the words of a sentence in their names, folders, captions, tags or collections."""
        return text_matches(self, self.bundle, sentence, allowed=allowed)

    def _clip_hits(
        self,
        question: EncodedQuestion,
        k: int,
        least: str | None,
        allowed: Ids | None,
        *,
        by_window: bool = False,
        exact: bool = False,
    ) -> Hits:
        """With `by_window` clips are ranked by their best window alone."""
        matches = self.text_matches(" ".join(question.wanted), allowed)

        def answers() -> Iterator[Answer]:
            if by_window:
                ranked = rank_by_window(self, question.vectors[0], allowed=allowed)
            else:
                ranked = self._ranked(question, allowed, matches, exact)
            for batch in batched(ranked, _REFINED):
                sources = self._sources([score.clip_id for score in batch])
                for score in (score for score in batch if score.clip_id in sources):
                    motion = QueriedMotion(self.bundle, sources[score.clip_id], question)
                    matched = matches[score.clip_id].places if score.clip_id in matches else ()
                    yield clip_answer(motion, score.score)._replace(matched=matched)

        ranked = ranked_by_amounts(question, answers()) if self.has_poses else answers()
        return as_hits(self.bundle, question, ranked, k, least)

    def _ranked(
        self, question: EncodedQuestion, allowed: Ids | None, matches: Mapping[int, TextMatch], exact: bool
    ) -> Iterator[ClipScore]:
        query, encoder = question.vectors[0], self.bundle
        ranked = rank_clips(ExactGallery(self) if exact else self, query, allowed=allowed)
        takes_away = question.wanted != question.sentences  # which token vectors would bring back
        if isinstance(encoder, TokenEncoder) and len(question.sentences) == 1 and self.has_poses and not takes_away:
            ranked = rerank_by_tokens(encoder, self, question.sentences[0], ranked)
        if not matches:
            return ranked
        by_text = best_clips(self, query, len(matches), allowed=np.array(sorted(matches), np.int64))
        return fused(ranked, by_text, matches)

    def _moment_hits(self, question: EncodedQuestion, k: int, least: str | None, allowed: Ids | None) -> Hits:
        if question.how == "alone":
            answers = moments_across(self.bundle, self, self._source_of, question, allowed=allowed)
        else:
            answers = answers_in_candidates(self.bundle, self, self._sources, question, allowed=allowed)
        ranked = ranked_by_amounts(question, answers) if self.has_poses else answers
        return as_hits(self.bundle, question, ranked, k, least)

    def _aligned_hits(
        self, question: EncodedQuestion, motion: Motion, k: int, least: str | None, allowed: Ids | None
    ) -> Hits:
        """The clips most like a whole motion, the first of them by how they pass through time."""
        found = best_clips(self, question.vectors[0], max(k, RERANKED), allowed=allowed, whole_share=1.0)
        ranked = rerank_by_alignment(self.bundle, self, motion, found)
        sources = self._sources([score.clip_id for score in ranked])
        named = [(sources[score.clip_id], score) for score in ranked if score.clip_id in sources]
        answers = [Answer(source, s.moment(source.duration), (s.score,)) for source, s in named]
        return as_hits(self.bundle, question, answers, k, least)

    def _source_of(self, clip_id: int) -> MotionSource:
        return MotionSource.of_clip(self, self.clip(clip_id))

    def _sources(self, ids: Iterable[int]) -> dict[int, MotionSource]:
        return {id: MotionSource.of_clip(self, clip) for id, clip in self.clips_by_id(ids).items()}
