"""Coverage of human sentences by the corpus' language: actions, parses, missing verbs, vocabulary and caption lengths.

    python -m benchmarks.language FILE ... [--captions 5000] [--sentences 5000]

FILE: human sentences, one per line. Printed for each: the share of sentences whose verbs are known, the share parsed
completely, and the commonest unknown verbs; the length and vocabulary of generated captions against the human ones; and
the number of phrases per action.
"""

from __future__ import annotations

import argparse
import random
import statistics
from pathlib import Path

import numpy as np

from encoders.corpus.actions.programs import programs
from encoders.corpus.language.caption_generation import captions
from encoders.corpus.language.coverage import (
    coverage,
    phrase_counts,
    vocabulary_shared,
    words_of,
    words_per_sentence,
)
from encoders.corpus.language.random_scenes import random_scene


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path, help="human sentences, one per line")
    parser.add_argument("--captions", type=int, default=5000, help="captions to generate")
    parser.add_argument("--sentences", type=int, default=5000, help="human sentences to parse of each file; 0: all")
    return parser.parse_args()


def _generated_captions(count: int) -> list[str]:
    rng = np.random.default_rng(0)
    return [text for _ in range(count // 4) for text in captions(random_scene(rng), rng, 4)]


def main() -> None:
    """Measure and print."""
    arguments = _arguments()
    ours = _generated_captions(arguments.captions)
    our_words = words_of(ours)
    for path in arguments.files:
        theirs = [line.strip() for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
        their_words = words_of(theirs)
        shown = (
            random.Random(0).sample(theirs, arguments.sentences) if 0 < arguments.sentences < len(theirs) else theirs
        )
        found = coverage(shown)
        print(f"{path.name}: {len(theirs)} sentences, {found.sentences} parsed")
        print(f"  all main verbs are known         {found.verbs_known:6.1%}")
        print(f"  parsed completely                {found.parsed:6.1%}")
        print(f"  words per sentence  human  {words_per_sentence(theirs):5.1f}   ours {words_per_sentence(ours):5.1f}")
        print(f"  vocabulary          human  {len(their_words):5d}   ours {len(our_words):5d} in {len(ours)} captions")
        print(f"  human running words in ours        {vocabulary_shared(our_words, their_words):6.1%}")
        print("  unknown verbs:", ", ".join(f"{verb} {count}" for verb, count in found.missing.most_common(40)))
    counts = phrase_counts()
    values = sorted(counts.values())
    many, most = (sum(value >= least for value in values) for least in (30, 60))
    print(f"phrases: {len(counts)} actions for {len(programs())} programs, median {statistics.median(values):.0f}")
    print(f"  fewest {min(values)}, 30 and more for {many}, 60 and more for {most}")


if __name__ == "__main__":
    main()
