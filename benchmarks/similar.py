"""Does `similar` find the same performance in another rig first?

    python benchmarks/similar.py data/mocap

Every file whose trial lies in the archive in several rigs is asked; gallery: all other files of the CMU rigs. As
`similar` does it, the nearest by vector are compared once more in time. Prints
the share whose first answer is the same trial, for each pair of rigs.
"""

from __future__ import annotations

import csv
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.errors import MotionSeekError
from indexer.ingest.load import load_motion
from search.ranking.alignment import LONGEST, RERANKED, alignment_bonus


def main(archive: Path) -> None:
    """Read, encode, compare, print."""
    with (archive / "manifest.tsv").open(encoding="utf-8", newline="") as table:
        rows = [
            r for r in csv.DictReader(table, delimiter="\t") if r["kind"] == "take" and r["use"] != "evaluation only"
        ]
    kept, motions = [], []
    for row in rows:
        try:
            rate = row["fps_true"] or row["fps_in_file"]
            motions.append(load_motion(archive / row["path"], fps=float(rate) if rate else None))
            kept.append(row)
        except MotionSeekError as error:
            print(error, file=sys.stderr)
    bundle = Bundle.load()
    vectors = bundle.encode_motions(motions)
    similarity = vectors @ vectors.T
    np.fill_diagonal(similarity, -1)
    trials = np.array([row["trial"] for row in kept])
    first = []
    for i, scores in enumerate(similarity):
        near = np.argsort(-scores)[:RERANKED]
        is_short = motions[i].duration <= LONGEST
        gains = alignment_bonus(bundle, motions[i], [motions[j] for j in near]) if is_short else 0.0
        first.append(trials[near[np.argmax(scores[near] + gains)]])
    found: dict[str, list[bool]] = defaultdict(list)
    for i, row in enumerate(kept):
        others = {r["rig"] for r in kept if r["trial"] == row["trial"]} - {row["rig"]}
        if others:
            found[row["rig"]].append(bool(first[i] == trials[i]))
    for rig, right in sorted(found.items()):
        print(f"{rig:16} {100 * np.mean(right):5.1f} % of {len(right)}")
    everything = [r for right in found.values() for r in right]
    print(f"{'all':16} {100 * np.mean(everything):5.1f} % of {len(everything)}, gallery of {len(kept)} files")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
