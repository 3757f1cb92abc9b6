"""ServedLibrary: what a server asks of its library, whatever holds it; query vectors and answers are cached."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from indexer.store.clips import Clip
from indexer.vectors.blocks import IndexRows
from search.hits import Hits
from search.library import Library
from search.query.amounts import amounts_of
from search.query.encoding import encode_queries
from search.query.filters import FilterArguments
from search.query.question import EncodedQuestion, Question
from search.ranking.text_matches import words_of
from search.server.answer_cache import AnswerCache, StaleCriterion
from search.server.lru_cache import LruCache

Vectors = NDArray[np.float32]

#: By how much a score may differ between two orders of summation.
_ROUNDING = 1e-5


class State(Protocol):
    """The state of a library that is searched."""

    @property
    def generation(self) -> int:
        """Another number whenever it has changed."""

    @property
    def count(self) -> int:
        """The number of clips."""


@dataclass(frozen=True)
class SearchRequest:
    """A search of the whole library.

    Attributes
    ----------
    question : EncodedQuestion
    k : int
        The number of hits, at most.
    filters : FilterArguments
    least : str or None
        The least strength of a hit; see `search.ranking.answers.as_hits`.
    """

    question: EncodedQuestion
    k: int
    filters: FilterArguments
    least: str | None = None


class ServedLibrary(Library):
    """A `Library` for a server. Safe to share between threads."""

    def __init__(self, folder: Path, *, bundle: Encoder | None = None) -> None:
        super().__init__(folder, bundle=bundle)
        self._query_cache: LruCache[Vectors] = LruCache(16_384)
        self.answer_cache = AnswerCache(0)

    @property
    @abstractmethod
    def snapshot(self) -> State:
        """What is searched now.

        Raises
        ------
        MotionSeekError
            If the library cannot be searched.
        """

    @abstractmethod
    def start(self) -> None:
        """Start the thread that watches for changes."""

    @abstractmethod
    def refresh(self) -> bool:
        """Catch up with the library; whether it has changed."""

    @abstractmethod
    def page(
        self, filters: FilterArguments, first: int, count: int, seed: int | None = None, sort: str | None = None
    ) -> tuple[int, list[Clip]]:
        """How many clips pass the filters, and some of them: sorted; with a seed, those first that differ most."""

    @property
    def previews(self) -> Path | None:
        """The folder of what is derived of the whole library, None where there is none."""
        return self.folder / "previews"

    @abstractmethod
    def clips_of_map(self) -> IndexRows:
        """The clips that the map shows."""

    def warm(self) -> None:
        """Load the model and search once, so that the first request does not wait for it."""
        self.search("a person walks", 1)

    def stale_criterion(self, request: SearchRequest, hits: Hits) -> StaleCriterion:
        """What makes an answer stale: an added clip that scores as much as its last hit, or has its words."""
        by_score = len(hits) == request.k and not any(map(amounts_of, request.question.wanted))
        threshold = hits[-1].score - _ROUNDING if by_score else -np.inf
        words = words_of(" ".join(request.question.wanted))
        return StaleCriterion(request.question.vectors[0], threshold, tuple(words))

    def is_encoded(self, sentence: str) -> bool:
        """Whether the query vector of a sentence is cached."""
        return self._query_cache.get(sentence) is not None

    def encode(self, question: Question) -> EncodedQuestion:
        """See `Library.encode`."""
        return EncodedQuestion(np.stack(self.encode_all(question.sentences)), question.sentences, question.how)

    def encode_all(self, sentences: Sequence[str]) -> list[Vectors]:
        """Query vectors (D,) of sentences; those that are not cached are encoded in one batch."""
        cached = {sentence: self._query_cache.get(sentence) for sentence in sentences}
        new = [sentence for sentence, vector in cached.items() if vector is None]
        encoded = dict(zip(new, encode_queries(self.bundle, new), strict=True)) if new else {}
        for sentence, vector in encoded.items():
            self._query_cache.put(sentence, vector)
        found = encoded | {sentence: vector for sentence, vector in cached.items() if vector is not None}
        return [found[sentence] for sentence in sentences]

    def search_all(self, requests: Sequence[SearchRequest]) -> list[Hits | Exception]:
        """The hits of each request, or the exception that `search` would raise."""
        return [self._hits_or_error(request) for request in requests]

    def _hits_or_error(self, request: SearchRequest) -> Hits | Exception:
        try:
            with self.reading():
                self.snapshot  # noqa: B018  raises where the library cannot be searched
                return self.search_encoded(request.question, request.k, min_strength=request.least, **request.filters)
        except Exception as error:
            return error
