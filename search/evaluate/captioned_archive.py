"""Retrieval in a captioned archive: how well captions find files with the same description. Real validation data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.captioned_motion import CaptionedTake
from encoders.errors import QueryError
from encoders.metrics import ranks
from encoders.protocol import Encoder
from search.evaluate.gallery import Gallery
from search.query.encoding import encode_queries
from search.ranking.hubness import hubness_penalty


@dataclass(frozen=True)
class CaptionReport:
    """Rank of the best right file for every caption, by description.

    Attributes
    ----------
    files : number of files in the gallery
    ranks : {description: 0-based ranks of its captions, the description itself first}
    motion_to_sentence, motion_to_sentence_by_cosine : percent of described files whose first caption, of all captions,
        is one of their description, averaged over descriptions; ranked as `describe` does, and by cosine alone
    """

    files: int
    ranks: dict[str, list[float]]
    motion_to_sentence: float
    motion_to_sentence_by_cosine: float

    def recall(self, k: int) -> float:
        """R@k: percent of captions whose best right file is among the first k, averaged over descriptions."""
        return 100 * float(np.mean([np.mean(np.array(row) < k) for row in self.ranks.values()]))

    def as_dict(self) -> dict[str, object]:
        return {
            "files": self.files,
            "descriptions": len(self.ranks),
            **{f"R@{k}": self.recall(k) for k in (1, 5, 10)},
            "motion to sentence": self.motion_to_sentence,
            "motion to sentence by cosine alone": self.motion_to_sentence_by_cosine,
            "ranks": {description: [r + 1 for r in row] for description, row in self.ranks.items()},
        }


def evaluate_captions(takes: Iterable[CaptionedTake], encoder: Encoder) -> CaptionReport:
    """Query with each description and each caption of its files; the gallery is all files, scored as search does.

    A file is right for a description if its owner described it so, in whatever rig. Files described as "unknown" stay
    in the gallery and give no queries.

    Raises
    ------
    QueryError
        If no take has a description.
    """
    takes = list(takes)
    descriptions = np.array([take.description for take in takes])
    captions: dict[str, list[str]] = {}
    for take in takes:
        if take.description and take.description.lower() != "unknown":
            known = captions.setdefault(take.description, [take.description])
            known += [caption for span in take.spans for caption in span.captions if caption not in known]
    if not captions:
        raise QueryError("no take of that split can be read and has a description; see docs/evaluation.md")
    gallery = Gallery(encoder, [take.motion for take in takes])
    found = {}
    for description, texts in captions.items():
        similarity = gallery.scores(encode_queries(encoder, texts))
        right = np.broadcast_to(descriptions == description, similarity.shape)
        found[description] = ranks(similarity, right).tolist()
    plain = encoder.encode_texts([text for texts in captions.values() for text in texts])
    about = np.repeat(list(captions), [len(texts) for texts in captions.values()])
    files = np.flatnonzero(np.isin(descriptions, about))
    cosines = gallery.whole[files] @ plain.T
    ranked, by_cosine = (
        _mean_over_groups(about[scores.argmax(axis=1)] == descriptions[files], descriptions[files])
        for scores in (cosines - hubness_penalty(encoder, plain), cosines)
    )
    return CaptionReport(len(takes), found, ranked, by_cosine)


def _mean_over_groups(right: NDArray[np.bool_], group: NDArray[np.str_]) -> float:
    """Percent that is right in each group, averaged over groups."""
    return 100 * float(np.mean([right[group == name].mean() for name in np.unique(group)]))
