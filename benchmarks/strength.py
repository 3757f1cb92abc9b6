"""How far strength can be trusted on real takes: the expected calibration error of its probabilities.

    python -m benchmarks.strength data/hdm05 data/mocap captions.jsonl

Each query of the labelled archive, and each caption of the validation takes, is asked twice: of all clips, and of those
that are not right, as of an archive that has no such motion. The first five hits count, each judged by its moment.
Expected calibration error: the mean difference, over ten bins of probability, between the mean probability and the
share that is right, weighted by the hits of a bin (Naeini, Cooper and Hauskrecht, AAAI 2015).

*shipped* is the curve of the bundle, which is fitted to these archives; *held out* fits as that is fitted, and judges
each hit by a fit without the takes of its person.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.known_models import load_model
from indexer.datasets.archive_tables import read_columns
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.labelled_clips import labelled_clips
from indexer.datasets.questioned_archives import questioned_labels, questioned_takes
from search.evaluate.judged_hits import JudgedHits, judged_hits
from search.ranking.strength import STRONG_FROM, probability
from search.ranking.strength_calibration import fit_together

_FOLDS = 5


def calibration_error(chance: NDArray[np.float64], right: NDArray[np.bool_], bins: int = 10) -> float:
    """The expected calibration error of probabilities (H,)."""
    bin_of = np.minimum((chance * bins).astype(int), bins - 1)
    return sum((bin_of == b).mean() * abs((chance - right)[bin_of == b].mean()) for b in np.unique(bin_of))


def held_out(archives: list[JudgedHits], persons: list[NDArray[np.str_]]) -> list[NDArray[np.float64]]:
    """The probability of each hit of each archive by curves that were fitted without the takes of its person."""
    folds = [
        np.unique(names, return_inverse=True)[1][hits.clip] % _FOLDS
        for hits, names in zip(archives, persons, strict=True)
    ]
    chance = [np.empty(len(hits.peaks)) for hits in archives]
    for fold in range(_FOLDS):
        others = [
            (hits.statistics[of != fold], hits.right[of != fold]) for hits, of in zip(archives, folds, strict=True)
        ]
        curve = fit_together(others)
        for hits, of, mine in zip(archives, folds, chance, strict=True):
            mine[of == fold] = probability(hits.statistics[of == fold], curve)
    return chance


def persons_of_labelled(folder: Path) -> NDArray[np.str_]:
    """Who acts in each readable clip: their folder."""
    unreadable = {path for path, _ in labelled_clips(folder).unreadable}
    rows = read_columns(folder / "labels.tsv", ("path", "label"))
    return np.array([str(Path(row["path"]).parent) for row in rows if row["path"] not in unreadable])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("labelled", "captioned", "captions"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--model", default="default")
    arguments = parser.parse_args()
    bundle = load_model(arguments.model)
    takes = list(captioned_takes(arguments.captioned, arguments.captions, "val"))
    archives = [judged_hits(bundle, of) for of in (questioned_labels(arguments.labelled), questioned_takes(takes))]
    persons = [persons_of_labelled(arguments.labelled), np.array([take.trial.split("_")[0] for take in takes])]
    curve = (bundle.calibration or {})["sentence_coefficients"]
    ways = {
        "shipped": [probability(hits.statistics, curve) for hits in archives],
        "held out": held_out(archives, persons),
    }
    right = [hits.right & ~hits.left_out for hits in archives]
    absent = np.concatenate([hits.left_out for hits in archives])
    print("way | all hits | labelled archive | validation takes | strong, of right hits | of an archive without any")
    for name, chances in ways.items():
        pooled, true = np.concatenate(chances), np.concatenate(right)
        errors = [calibration_error(pooled, true), *map(calibration_error, chances, right)]
        strong = pooled >= STRONG_FROM
        shares = [f"{100 * strong[some].mean():.0f} %" for some in (true, absent)]
        print(name, *[f"{error:.3f}" for error in errors], *shares, sep=" | ")


if __name__ == "__main__":
    main()
