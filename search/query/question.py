"""Question: what is asked of a take, as one or several sentences, in order or at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from encoders.errors import QueryError
from encoders.protocol import Encoder
from search.moments.window_scores import Vectors
from search.query.encoding import encode_queries
from search.query.steps import split


@dataclass(frozen=True)
class Question:
    """Sentences and how they go together.

    Attributes
    ----------
    sentences : tuple of str
    how : str
        "alone" for one sentence, "then" for steps in order, "while" for things at the same time.
    """

    sentences: tuple[str, ...]
    how: str = "alone"

    @classmethod
    def of(
        cls,
        sentence: str | None,
        steps: Sequence[str] = (),
        meanwhile: Sequence[str] = (),
        *,
        split_steps: bool = True,
    ) -> Question:
        """The question that a sentence, explicit steps, or things at the same time make; any of them may be missing.

        Raises
        ------
        QueryError
            If nothing is asked, or both an order and things at the same time are.
        """
        given = [text for text in (sentence, *steps, *meanwhile) if text is not None]
        if not given or not all(any(character.isalnum() for character in text) for text in given):
            raise QueryError('the sentence is empty; describe a movement in words, such as "a person waves"')
        if meanwhile and steps:
            raise QueryError("steps in order and things at the same time cannot be asked together; ask one of the two")
        if meanwhile:
            return cls(tuple(given), "while" if len(given) > 1 else "alone")
        if not steps and split_steps:
            given = split(given[0])
        return cls(tuple(given), "then" if len(given) > 1 else "alone")

    def encode(self, bundle: Encoder) -> Vectors:
        """The sentences as unit vectors (S, D)."""
        return encode_queries(bundle, self.sentences)

    def __str__(self) -> str:
        return f", {self.how} ".join(self.sentences)
