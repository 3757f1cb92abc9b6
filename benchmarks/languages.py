"""How well other languages are understood: mean average precision of questions in them, and of the English ones.

    python -m benchmarks.languages data/hdm05 benchmarks/translations/hdm05.tsv
    python -m benchmarks.languages data/mocap benchmarks/translations/mocap_val.tsv --captions captions.jsonl

A table has a column for each language and, in its first, `about`, the label of the clips that a sentence is about, or
with `--captions` the description of the takes of the split `val`; rows about nothing only meet their English twin. All
was translated by hand. Printed for each language: mean average precision, its share of that in English, the cosine to
the English vector, how often a sentence's nearest English one among those of the table is its twin, and how many
sentences the language is recognised of. Needs the extra `languages`.
"""

from __future__ import annotations

import argparse
import csv
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.metrics import average_precision
from encoders.motion import Motion
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.labelled_clips import labelled_clips
from search.evaluate.gallery import Gallery
from search.query.encoding import encode_queries
from search.query.languages import language_of
from search.translation.concepts import ENGLISH

_ABOUT = "about"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("table", type=Path, nargs="+")
    parser.add_argument("--captions", type=Path)
    arguments = parser.parse_args()
    bundle = Bundle.load()
    labels, motions = _clips(arguments.folder, arguments.captions)
    gallery = Gallery(bundle, motions)
    for path in arguments.table:
        with path.open(encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines, delimiter="\t"))
        print(f"{path.name}: {len(rows)} sentences, {len(motions)} clips, {bundle.name}\n")
        _report(bundle, gallery, labels, rows)


def _clips(folder: Path, captions: Path | None) -> tuple[NDArray[np.str_], list[Motion]]:
    """What each clip is about, and its motion."""
    warnings.simplefilter("ignore")
    if captions is None:
        archive = labelled_clips(folder)
        return np.array(archive.labels), list(archive.motions)
    takes = list(captioned_takes(folder, captions, "val"))
    return np.array([take.description for take in takes]), [take.motion for take in takes]


def _report(bundle: Bundle, gallery: Gallery, labels: NDArray[np.str_], rows: list[dict[str, str]]) -> None:
    about = np.array([row[_ABOUT] for row in rows])
    judged = np.isin(about, labels)
    print("| language | mean AP | of English | cosine | twin first | recognised |\n|---|---|---|---|---|---|")
    english, best, shares = encode_queries(bundle, [row[ENGLISH] for row in rows]), 0.0, []
    for language in (name for name in rows[0] if name != _ABOUT):
        sentences = [row[language] for row in rows]
        vectors = encode_queries(bundle, sentences)
        scores = gallery.scores(vectors[judged])
        pairs = zip(scores, about[judged], strict=True)
        precision = float(np.mean([average_precision(row, labels == label) for row, label in pairs]))
        best = best or precision
        twins = np.mean((vectors @ english.T).argmax(axis=1) == np.arange(len(rows)))
        known = np.mean([(language_of(text) or ENGLISH) == language for text in sentences])
        cosine = np.mean((vectors * english).sum(axis=1))
        print(
            f"| {language} | {precision:.3f} | {precision / best:.3f} | {cosine:.3f} | {100 * twins:.0f} % | "
            f"{100 * known:.0f} % |"
        )
        shares += [precision / best] if language != ENGLISH else []
    print(f"| **mean of others** | | **{np.mean(shares):.3f}** | | | |\n")


if __name__ == "__main__":
    main()
