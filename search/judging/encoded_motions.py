"""Motions with the vectors that an evaluator gives them, whole and in pieces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.judging.metrics.scopes import Span
from search.judging.motion_table import JudgedMotion

Array = NDArray[np.float32]


class Pieces(NamedTuple):
    """Unit vectors (P, D) of stretches of motions, and the place of each one's motion (P,)."""

    vectors: Array
    owners: NDArray[np.int64]


@dataclass(frozen=True)
class EncodedMotions:
    """Motions and their evaluator.

    Attributes
    ----------
    motions : sequence of N JudgedMotion
    encoder : Encoder
    """

    motions: Sequence[JudgedMotion]
    encoder: Encoder

    @cached_property
    def features(self) -> list[Array]:
        """Of the whole motions."""
        return [self.encoder.features(one.motion) for one in self.motions]

    @cached_property
    def vectors(self) -> Array:
        """Unit vectors (N, D) of the whole motions."""
        return self.encoder.encode_features(self.features)

    @property
    def whole(self) -> Pieces:
        """Each motion as one piece."""
        return Pieces(self.vectors, np.arange(len(self.motions)))

    @cached_property
    def texts(self) -> list[str]:
        """The distinct sentences; none where a motion has none."""
        texts = [one.text for one in self.motions]
        return list(dict.fromkeys(texts)) if all(texts) else []

    @cached_property
    def text_vectors(self) -> Array:
        """Unit vectors (S, D) of `texts`, each as it is."""
        return self.encoder.encode_texts(self.texts)

    @cached_property
    def own_text(self) -> NDArray[np.int64]:
        """Row of each motion's sentence in `texts`."""
        places = {text: i for i, text in enumerate(self.texts)}
        return np.array([places[one.text] for one in self.motions], np.int64)

    def pieces(
        self,
        spans: Callable[[JudgedMotion], Sequence[Span]],
        name: str = "",
        least: int = 1,
        otherwise: str = "no stretch of any motion",
    ) -> Pieces:
        """The vectors of stretches of motions, one after the other.

        Parameters
        ----------
        spans : callable
            A motion's stretches, in frames.
        name : str
            Under which the vectors are kept for the next time; empty for stretches that are drawn.
        least : int
            Frames of the shortest motion that has any.
        otherwise : str
            What is raised where none has.

        Raises
        ------
        ValueError
            If there is none.
        """
        if name in self._kept:
            return self._kept[name]
        cut, owners = [], []
        for owner, (one, rows) in enumerate(zip(self.motions, self.features, strict=True)):
            scale = self.encoder.fps / one.motion.fps
            for start, end in spans(one) if len(one.motion) >= least else ():
                first = min(round(start * scale), len(rows) - 1)
                cut.append(rows[first : max(round(end * scale), first + 1)])
                owners.append(owner)
        if not cut:
            longest = max(len(one.motion) for one in self.motions)
            raise ValueError(f"all motions are shorter than {least} frames" if longest < least else otherwise)
        pieces = Pieces(self.encoder.encode_features(cut), np.array(owners, np.int64))
        if name:
            self._kept[name] = pieces
        return pieces

    @cached_property
    def _kept(self) -> dict[str, Pieces]:
        return {}
