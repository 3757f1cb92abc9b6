"""Archives with questions whose right answers are known: labelled clips with queries, captioned takes with captions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.captioned_motion import CaptionedTake
from encoders.motion import Motion
from indexer.datasets.labelled_clips import labelled_clips


@dataclass(frozen=True, eq=False)
class QuestionedArchive:
    """Motions, and questions of which it is known what answers them.

    Attributes
    ----------
    motions : list of Motion
        (N,)
    about : list of str
        What each motion shows (N,), in its owner's words.
    questions : list of (about, sentence)
        (Q,), in a fixed order.
    """

    motions: list[Motion]
    about: list[str]
    questions: list[tuple[str, str]]

    @property
    def sentences(self) -> list[str]:
        """The sentences (Q,)."""
        return [sentence for _, sentence in self.questions]

    @property
    def right(self) -> NDArray[np.bool_]:
        """Which motions answer each question (Q, N)."""
        asked = np.array([about for about, _ in self.questions])
        return np.asarray(asked[:, None] == np.array(self.about))


def questioned_labels(folder: Path) -> QuestionedArchive:
    """The labelled clips of a folder, and the queries of their labels.

    Raises
    ------
    QueryError
        If a table is unusable.
    """
    clips = labelled_clips(folder)
    queries = [(label, text) for label, texts in clips.queries.items() if label in clips.labels for text in texts]
    return QuestionedArchive(clips.motions, clips.labels, queries)


def questioned_takes(takes: Sequence[CaptionedTake]) -> QuestionedArchive:
    """Captioned takes; their descriptions and captions are asked, and takes of the same description answer."""
    asked = {(t.description, text) for t in takes for s in t.spans for text in (t.description, *s.captions)}
    known = sorted((about, text) for about, text in asked if about and about.lower() != "unknown")
    return QuestionedArchive([take.motion for take in takes], [take.description for take in takes], known)
