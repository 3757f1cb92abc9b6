"""Percent of motions whose nearest motion is the same performance in another rig, by rig.

    python -m benchmarks.similar data/mocap

Queries are all files whose trial lies in the archive in several rigs; the gallery is all other files. As `similar`
does it, the nearest by vector are reranked by their alignment in time.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from pathlib import Path

import numpy as np

from benchmarks.stacks import takes
from encoders.bundle.bundle import Bundle
from search.ranking.alignment import LONGEST, RERANKED, alignment_bonus


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", type=Path, help="folder of takes in several rigs, with a manifest.tsv")
    rows, motions = takes(parser.parse_args().archive)
    bundle = Bundle.load()
    vectors = bundle.encode_motions(motions)
    similarity = vectors @ vectors.T
    np.fill_diagonal(similarity, -1)
    rigs: dict[str, set[str]] = defaultdict(set)
    for row in rows:
        rigs[row["trial"]].add(row["rig"])
    found: dict[str, list[bool]] = defaultdict(list)
    for row, motion, scores in zip(rows, motions, similarity, strict=True):
        if len(rigs[row["trial"]]) > 1:
            near = np.argsort(-scores)[:RERANKED]
            others = [motions[j] for j in near]
            bonus = alignment_bonus(bundle, motion, others) if motion.duration <= LONGEST else 0.0
            first = near[np.argmax(scores[near] + bonus)]
            found[row["rig"]].append(rows[first]["trial"] == row["trial"])
    for rig, right in sorted(found.items()):
        print(f"{rig:16} {100 * np.mean(right):5.1f} % of {len(right)}")
    everything = [right for row in found.values() for right in row]
    print(f"{'all':16} {100 * np.mean(everything):5.1f} % of {len(everything)}, gallery of {len(rows)} files")


if __name__ == "__main__":
    main()
