"""How clips are scored: the shipped way beside others, on a labelled archive and on captioned takes.

    python -m benchmarks.scoring data/hdm05 data/mocap captions.jsonl [--bundle FOLDER]

Prints mean average precision of the labelled archive's queries, and the percent of captions whose best right file is
the first, and among the first five, averaged over descriptions. *one best window* is the score of the whole or, where
it is higher by 0.02, of the best window. *less hubness* subtracts 0.3 of the mean of the ten highest scores that the
sentences of the shipped vocabulary have for a clip (CSLS on motions; Conneau et al., ICLR 2018).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.bundle.windows import encode_grids
from encoders.metrics import average_precision, ranks
from encoders.motion import Motion
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.questioned_archives import QuestionedArchive, questioned_labels, questioned_takes
from search.query.encoding import encode_queries
from search.query.vocabulary import vocabulary

Scores = NDArray[np.float64]

_PENALTY, _NEAREST = 0.3, 10


def similarities(bundle: Bundle, motions: list[Motion], queries: NDArray[np.float32]) -> Scores:
    """Similarity (4, Q, N) of queries (Q, D) to the best window of each length, shortest first, and to the whole."""
    found = np.empty((4, len(queries), len(motions)))
    for i, motion in enumerate(motions):
        features = bundle.features(motion)
        found[:, :, i] = queries @ bundle.encode_features([features])[0]
        for length, windows in enumerate(encode_grids(bundle, [features], [motion.duration])[0]):
            found[length, :, i] = (queries @ windows.vectors.astype(np.float32).T).max(axis=1)
    return found


def one_best_window(parts: Scores) -> Scores:
    best, whole = parts[:3].max(axis=0), parts[3]
    return np.asarray(np.where(best > whole + 0.02, best, whole))


WAYS: dict[str, Callable[[Scores], Scores]] = {
    "one best window": one_best_window,
    "the whole": lambda parts: parts[3],
    "mean of all four": lambda parts: np.asarray(parts.mean(axis=0)),
    "half the whole, half the mean of windows": lambda parts: np.asarray((parts[3] + parts[:3].mean(axis=0)) / 2),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("labelled", "captioned", "captions"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--bundle", type=Path)
    arguments = parser.parse_args()
    bundle = Bundle.load(arguments.bundle)
    archive = questioned_labels(arguments.labelled)
    takes = questioned_takes(list(captioned_takes(arguments.captioned, arguments.captions, "val")))
    known = encode_queries(bundle, vocabulary())

    def parts(of: QuestionedArchive) -> Scores:
        return similarities(bundle, of.motions, np.concatenate([encode_queries(bundle, of.sentences), known]))

    of_archive, of_takes = parts(archive), parts(takes)
    about = np.array([description for description, _ in takes.questions])
    print("way | labelled mean AP | captioned first | first five")
    for name, score in WAYS.items():
        for penalty in (0.0, _PENALTY):
            by_label, by_take = (
                scores - penalty * np.sort(scores[-len(known) :], axis=0)[-_NEAREST:].mean(axis=0)
                for scores in (score(of_archive), score(of_takes))
            )
            precision = [average_precision(row, those) for row, those in zip(by_label, archive.right, strict=False)]
            rank = ranks(by_take[: len(about)], takes.right)
            one, five = (100 * np.mean([(rank[about == d] < k).mean() for d in set(about)]) for k in (1, 5))
            less = ", less hubness" if penalty else ""
            print(f"{name}{less} | {np.mean(precision):.3f} | {one:.1f} | {five:.1f}")


if __name__ == "__main__":
    main()
