"""Sentences that fit a motion: the nearest of a library's captions and the shipped vocabulary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.motion import Motion
from encoders.protocol import Encoder
from search.query.question import EncodedQuestion
from search.query.vocabulary import vocabulary
from search.ranking.hubness import hubness_penalty
from search.ranking.strength import Judge

#: Number of sentences nearest to a motion that are reranked with the hubness penalty.
_RERANKED = 1000


class Description(tuple[str, float]):
    """A sentence that fits a motion: a pair (text, score) that also knows its strength.

    Attributes
    ----------
    text : str
    score : float
        The cosine less the `hubness_penalty` of the sentence; sentences are ranked by it.
    strength : str
        How strong a hit the motion would be for the sentence: "strong", "plausible" or "weak"; empty where the model
        carries no calibration.
    """

    strength: str

    def __new__(cls, text: str, score: float, strength: str = "") -> Description:
        pair = super().__new__(cls, (text, score))
        pair.strength = strength
        return pair

    @property
    def text(self) -> str:
        return self[0]

    @property
    def score(self) -> float:
        return self[1]

    def __getnewargs__(self) -> tuple[str, float, str]:
        return self.text, self.score, self.strength


def describe_motion(
    encoder: Encoder,
    motion: Motion,
    k: int,
    captions: Sequence[str] = (),
    vectors: NDArray[np.float32] | None = None,
) -> list[Description]:
    """The sentences that fit a motion best, best first, no sentence twice.

    Parameters
    ----------
    captions : sequence of str
        Captions to choose from beside the shipped vocabulary.
    vectors : float32 array (N, D)
        Their unit vectors.
    """
    return Sentences(encoder, captions, vectors).nearest(encoder.encode_motions([motion])[0], k)


class Sentences:
    """The sentences to choose from: captions with their unit vectors (N, D), and the shipped vocabulary."""

    def __init__(
        self, encoder: Encoder, captions: Sequence[str] = (), vectors: NDArray[np.float32] | None = None
    ) -> None:
        self._encoder, self._texts, self._judges = encoder, vocabulary(), dict[int, Judge]()
        self._vectors = encoder.encode_texts(list(self._texts))
        if vectors is not None and len(captions):
            self._texts, self._vectors = (*captions, *self._texts), np.concatenate([vectors, self._vectors])

    def nearest(self, motion_vector: NDArray[np.float32], k: int) -> list[Description]:
        """The k sentences that fit the unit vector (D,) of a motion best; see `describe_motion`."""
        cosines = self._vectors @ motion_vector
        near = np.argsort(-cosines, kind="stable")[: max(_RERANKED, 10 * k)]
        scores = cosines[near] - hubness_penalty(self._encoder, self._vectors[near])
        best: dict[str, Description] = {}
        for i in np.argsort(-scores, kind="stable"):
            if (text := self._texts[near[i]]) not in best:
                strength = self._judge(int(near[i]))([cosines[near[i]]])
                best[text] = Description(text, float(scores[i]), strength)
            if len(best) == k:
                break
        return list(best.values())

    def _judge(self, number: int) -> Judge:
        if number not in self._judges:
            question = EncodedQuestion(self._vectors[[number]], (self._texts[number],))
            self._judges[number] = Judge(self._encoder, question)
        return self._judges[number]
