"""How well sentences find the files of an archive that has descriptions: the project's real validation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.captioned_motion import CaptionedTake
from encoders.errors import QueryError
from encoders.metrics import ranks
from encoders.protocol import Encoder
from search.query.encoding import encode_queries
from search.ranking.hubness import hubness_penalty


@dataclass(frozen=True)
class DescribedReport:
    """Rank of the best right file for every sentence, by description.

    Attributes
    ----------
    files : number of files in the gallery
    ranks : {description: 0-based ranks of its sentences, the description itself first}
    told, told_by_cosine : percent of described files for which, of all the sentences, one about them comes first,
        averaged over descriptions; as `describe` ranks sentences, and by their cosines alone
    """

    files: int
    ranks: dict[str, list[float]]
    told: float
    told_by_cosine: float

    def found(self, k: int) -> float:
        """Percent of sentences whose best right file is among the first k, averaged over descriptions."""
        return 100 * float(np.mean([np.mean(np.array(row) < k) for row in self.ranks.values()]))

    def as_dict(self) -> dict[str, object]:
        return {
            "files": self.files,
            "descriptions": len(self.ranks),
            **{f"R@{k}": self.found(k) for k in (1, 5, 10)},
            "motion to sentence": self.told,
            "motion to sentence by cosine alone": self.told_by_cosine,
            "ranks": {description: [r + 1 for r in row] for description, row in self.ranks.items()},
        }


def evaluate_described(takes: Iterable[CaptionedTake], bundle: Encoder) -> DescribedReport:
    """Ask for each description, and for each sentence people wrote about its files; gallery: all the files whole.

    A file is right for a description if its owner described it so, in whatever rig. Files described as "unknown" stay
    in the gallery and are never asked for.

    Raises
    ------
    QueryError
        If no take has a description.
    """
    takes = list(takes)
    descriptions = np.array([take.description for take in takes])
    asked: dict[str, list[str]] = {}
    for take in takes:
        if take.description and take.description.lower() != "unknown":
            sentences = asked.setdefault(take.description, [take.description])
            sentences += [c for span in take.spans for c in span.captions if c not in sentences]
    if not asked:
        raise QueryError("no take of that split can be read and has a description; see docs/evaluation.md")
    gallery = bundle.encode_motions([take.motion for take in takes])
    found = {}
    for description, sentences in asked.items():
        similarity = encode_queries(bundle, sentences) @ gallery.T
        right = np.broadcast_to(descriptions == description, similarity.shape)
        found[description] = ranks(similarity, right).tolist()
    every = bundle.encode_texts([sentence for sentences in asked.values() for sentence in sentences])
    about = np.repeat(list(asked), [len(sentences) for sentences in asked.values()])
    files = np.flatnonzero(np.isin(descriptions, about))
    cosines = gallery[files] @ every.T
    told, by_cosine = (
        _averaged(about[scores.argmax(axis=1)] == descriptions[files], descriptions[files])
        for scores in (cosines - hubness_penalty(bundle, every), cosines)
    )
    return DescribedReport(len(takes), found, told, by_cosine)


def _averaged(right: NDArray[np.bool_], group: NDArray[np.str_]) -> float:
    """Percent that is right, the mean over groups."""
    return 100 * float(np.mean([right[group == name].mean() for name in np.unique(group)]))
