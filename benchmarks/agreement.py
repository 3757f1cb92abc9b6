"""One truth: whether a hit of `search` says the same as the moments of its clip, which the page shows on its time line.

    python -m benchmarks.agreement FOLDER

FOLDER is indexed. For every twentieth sentence of the shipped vocabulary, the first hits of a search are compared with
the first moment of their clip: how often the spans differ by more than half (intersection over union below 0.5), and
the strength. Then, how many moments of these clips are listed, and what part of the clip they cover together.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import motionseek
from search.query.vocabulary import vocabulary
from search.spans import temporal_iou


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--hits", type=int, default=5, help="first hits of each sentence")
    arguments = parser.parse_args()
    library = motionseek.open(arguments.folder)
    apart, words, weak, contained, covered, times = [], [], [], [], [], []
    for sentence in vocabulary()[::20]:
        library.search(sentence, 1)  # encodes the sentence
        began = time.perf_counter()
        hits = library.search(sentence, arguments.hits)
        times.append(1000 * (time.perf_counter() - began))
        for hit in hits:
            moments = library.moments(sentence, f"#{hit.clip_id}", 10, split_steps=False)
            first = moments[0]
            apart.append(temporal_iou([hit.start], [hit.end], first.start, first.end)[0] < 0.5)
            words.append(hit.strength != first.strength)
            weak += [m.strength == "weak" for m in moments]
            contained += [
                any(a is not b and a.start >= b.start - 1e-6 and a.end <= b.end + 1e-6 for b in moments)
                for a in moments
            ]
            covered.append(sum(m.end - m.start for m in moments) / hit.duration)
    print(f"{len(apart)} hits; spans that differ by more than half: {100 * np.mean(apart):.0f} %")
    print(f"strength that differs: {100 * np.mean(words):.0f} %")
    print(f"{len(weak)} moments of their clips listed, {100 * np.mean(weak):.0f} % weak, ", end="")
    print(f"{100 * np.mean(contained):.0f} % inside another, {100 * np.mean(covered):.0f} % of the clip together")
    print(f"search: median {np.median(times):.1f} ms once the sentence is encoded")


if __name__ == "__main__":
    main()
