"""How far strength can be trusted on real takes: the expected calibration error of its probabilities.

    python -m benchmarks.strength data/hdm05 data/mocap captions.jsonl

Each query of the labelled archive, and each caption of the validation takes, is asked twice: of all clips, and of those
that are not right, as of an archive that has no such motion. The first five hits count. Expected calibration error:
the mean difference, over ten bins of probability, between the mean probability and the share that is right, weighted
by the hits of a bin (Naeini, Cooper and Hauskrecht, AAAI 2015).

*one best window* judges hits by the best window of a clip, as search did before it refined its spans; *shipped* by the
moment, as now. *refitted* fits the curve anew to both archives, each hit judged by a fit without the takes of its
person. The shipped curve was fitted to synthetic clips and to the validation takes, not to the labelled archive.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.motion import Motion
from indexer.datasets.archive_tables import read_columns
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.labelled_clips import labelled_clips
from search.evaluate.gallery import Gallery
from search.moments.localisation import best_moment
from search.moments.queried_motion import QueriedMotion
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.ranking.strength import background_level, probability, score_statistics
from search.ranking.strength_calibration import fit_logistic
from search.source import MotionSource

_HITS, _FOLDS, _MARGIN = 5, 5, 0.02
_STRONG = 0.6


def judged(bundle: Bundle, motions: list[Motion], texts: list[str], right: NDArray[np.bool_]) -> NDArray[np.float64]:
    """The first hits of texts (Q,) of which `right` (Q, N) are right.

    Returns
    -------
    array (H, 7)
        The two statistics of the moment, the two of the best window; whether it is right, whether the right ones were
        left out, and the clip.
    """
    sources = [MotionSource.of_motion(motion) for motion in motions]
    gallery, queries, rows = Gallery(bundle, motions), encode_queries(bundle, texts), []
    for query, those, scores in zip(queries, right, gallery.scores(queries), strict=True):
        question = EncodedQuestion(query[None])
        level = background_level(question.unrelated(bundle)[0])
        for left_out in (False, True):
            among = np.where(those & left_out, -np.inf, scores)
            for clip in [i for i in np.argsort(-among)[:_HITS] if np.isfinite(among[i])]:
                motion = QueriedMotion(bundle, sources[clip], question)
                whole, window = float(query @ gallery.whole[clip]), max(float(w.scores.max()) for w in motion.windows)
                heights = best_moment(motion).peak_score, window if window > whole + _MARGIN else whole
                rows.append([*np.ravel([score_statistics(h, level) for h in heights]), those[clip], left_out, clip])
    return np.array(rows)


def calibration_error(chance: NDArray[np.float64], right: NDArray[np.float64], bins: int = 10) -> float:
    """The expected calibration error of probabilities (H,)."""
    bin_of = np.minimum((chance * bins).astype(int), bins - 1)
    return sum((bin_of == b).mean() * abs((chance - right)[bin_of == b].mean()) for b in np.unique(bin_of))


def refitted(hits: NDArray[np.float64], person: NDArray[np.str_]) -> NDArray[np.float64]:
    """The probability (H,) of each hit by curves that were fitted without the takes of its person."""
    folds = {name: i % _FOLDS for i, name in enumerate(sorted(set(person)))}
    fold, chance = np.array([folds[name] for name in person]), np.empty(len(hits))
    for held_out in range(_FOLDS):
        others = hits[fold != held_out]
        curve = fit_logistic(others[:, :2], others[:, 4] > 0)
        chance[fold == held_out] = probability(hits[fold == held_out, :2], curve)
    return chance


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("labelled", "captioned", "captions"):
        parser.add_argument(name, type=Path)
    arguments = parser.parse_args()
    bundle = Bundle.load()
    archive = labelled_clips(arguments.labelled)
    takes = list(captioned_takes(arguments.captioned, arguments.captions, "val"))
    asked = [(label, text) for label, texts in archive.queries.items() if label in archive.labels for text in texts]
    described = {(t.description, text) for t in takes for s in t.spans for text in (t.description, *s.captions)}
    told = sorted((about, text) for about, text in described if about and about.lower() != "unknown")
    unreadable = {path for path, _ in archive.unreadable}
    rows = read_columns(arguments.labelled / "labels.tsv", ("path", "label"))
    persons = [str(Path(row["path"]).parent) for row in rows if row["path"] not in unreadable]
    sets = []
    for named, motions, known, acted in (
        (asked, list(archive.motions), list(archive.labels), persons),
        (told, [t.motion for t in takes], [t.description for t in takes], [t.trial.split("_")[0] for t in takes]),
    ):
        right = np.array([[other == about for other in known] for about, _ in named])
        hits = judged(bundle, motions, [text for _, text in named], right)
        sets.append((hits, np.array(acted)[hits[:, -1].astype(int)]))
    both, people = np.concatenate([hits for hits, _ in sets]), np.concatenate([person for _, person in sets])
    curve, count = bundle.calibration["sentence_coefficients"], len(sets[0][0])
    ways = {
        "one best window": probability(both[:, 2:4], curve),
        "shipped": probability(both[:, :2], curve),
        "refitted": refitted(both, people),
    }
    print("way | all hits | labelled archive | validation takes | strong where nothing is right")
    true, absent = both[:, 4] * (both[:, 5] == 0), both[:, 5] > 0
    for name, chance in ways.items():
        parts = slice(None), slice(count), slice(count, None)
        errors = [f"{calibration_error(chance[some], true[some]):.3f}" for some in parts]
        print(name, *errors, f"{100 * (chance[absent] >= _STRONG).mean():.0f} %", sep=" | ")


if __name__ == "__main__":
    main()
