"""Question: one or several sentences, in order or at the same time, and their query vectors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_flag, checked_sentences
from encoders.errors import QueryError
from encoders.protocol import Encoder, unrelated_motions
from search.query.encoding import encode_queries
from search.query.negation import parts_of
from search.query.steps import split

#: Sentences of a question: each costs as much as a question of its own.
MOST_SENTENCES = 100


@dataclass(frozen=True)
class Question:
    """Sentences and how they go together.

    Attributes
    ----------
    sentences : tuple of str
    how : str
        "alone" for one sentence, "then" for steps in order, "while" for things at the same time.
    undivided : str
        The sentence that the steps are of; empty where they were given as steps, or there are none.
    """

    sentences: tuple[str, ...]
    how: str = "alone"
    undivided: str = ""

    @classmethod
    def of(
        cls,
        sentence: str | None,
        steps: Sequence[str] = (),
        meanwhile: Sequence[str] = (),
        *,
        split_steps: bool = True,
    ) -> Question:
        """The question of a sentence, explicit steps, or things at the same time; any of them may be missing.

        Raises
        ------
        QueryError
            If there is no sentence, one is not a string, there are too many or too long ones, or both an order and
            things at the same time are given.
        """
        split_steps = checked_flag("split_steps", split_steps)
        steps, meanwhile = checked_sentences("then", steps), checked_sentences("meanwhile", meanwhile)
        given = [*([] if sentence is None else checked_sentences("sentence", [sentence])), *steps, *meanwhile]
        if not given or not all(any(character.isalnum() for character in text) for text in given):
            raise QueryError('the sentence is empty; describe a movement in words, such as "a person waves"')
        if len(given) > MOST_SENTENCES:
            raise QueryError(f"{len(given)} sentences are more than {MOST_SENTENCES}; ask in several questions")
        if meanwhile and steps:
            raise QueryError("steps in order and things at the same time exclude each other; give one of the two")
        if meanwhile:
            return cls(tuple(given), "while" if len(given) > 1 else "alone")
        whole = ""
        if not steps and split_steps:
            whole, given = given[0], split(given[0])
        return cls(tuple(given), "then", whole) if len(given) > 1 else cls(tuple(given))

    def encode(self, encoder: Encoder) -> EncodedQuestion:
        """The question with its query vectors."""
        return EncodedQuestion(encode_queries(encoder, self.sentences), self.sentences, self.how)

    def __str__(self) -> str:
        return f", {self.how} ".join(self.sentences)


@dataclass(frozen=True, eq=False)
class EncodedQuestion:
    """Query vectors and what they stand for.

    Attributes
    ----------
    vectors : float32 array (S, D)
        Unit vectors, one for each sentence.
    sentences : tuple of str
        Empty where the query is a vector or a motion.
    how : str
        See `Question`.
    kind : str
        "sentence", "motion" or "mixed": what the vectors were encoded from. Of mixed ones no strength is known.
    """

    vectors: NDArray[np.float32]
    sentences: tuple[str, ...] = ()
    how: str = "alone"
    kind: str = "sentence"
    _unrelated: list[tuple[Encoder, NDArray[np.float32] | None]] = field(default_factory=list, init=False, repr=False)

    @property
    def wanted(self) -> tuple[str, ...]:
        """The sentences without what they take away."""
        return tuple(parts_of(sentence).wanted for sentence in self.sentences)

    def unrelated(self, encoder: Encoder) -> NDArray[np.float32] | None:
        """Similarity (S, M) to the model's unrelated motions; None where it carries none. Computed once."""
        if not self._unrelated or self._unrelated[-1][0] is not encoder:
            motions = unrelated_motions(encoder)
            found = None if motions is None else np.asarray(self.vectors @ motions.T, np.float32)
            self._unrelated.append((encoder, found))
        return self._unrelated[-1][1]
